#include "bench/kernels/captured_launch.h"

#include "kernels/shared/solver_shared.h"
#include "runtime/wavefront/table_layout.h"

#include <algorithm>
#include <cstring>
#include <set>

namespace gradus::bench {

namespace {

constexpr std::size_t float_bytes = sizeof(float);
static_assert(float_bytes == sizeof(std::uint32_t));

std::vector<char> content_of(const Buffer &buffer) {
    std::vector<char> content(buffer.bytes());
    buffer.read(content.data(), content.size());
    return content;
}

void write(const Buffer &buffer, const std::vector<char> &content) {
    std::memcpy(buffer.map(Access::write).as<char>(), content.data(), content.size());
}

/// As the double build wants it: reals twice as wide, and whole numbers in the first half of their place.
std::vector<char> widened(const CapturedBuffer &captured) {
    if (!captured.is_real)
        return captured.content;
    const std::size_t count = captured.content.size() / float_bytes;
    std::vector<char> wide(count * sizeof(double));
    for (std::size_t i = 0; i < count; ++i) {
        const char *from = &captured.content[i * float_bytes];
        const std::size_t column = captured.rows ? i / captured.rows : 0;
        if (captured.rows && column < captured.is_uint.size() && captured.is_uint[column]) {
            std::memcpy(&wide[i * sizeof(double)], from, sizeof(std::uint32_t));
            continue;
        }
        float single;
        std::memcpy(&single, from, sizeof single);
        const double value = single;
        std::memcpy(&wide[i * sizeof(double)], &value, sizeof value);
    }
    return wide;
}

std::uint32_t number_at(const char *column, std::size_t row) {
    std::uint32_t number;
    std::memcpy(&number, column + row * float_bytes, sizeof number);
    return number;
}

/// Two ways to give a kernel other values. A whole number may be an index, so each row gets that of a row which the
/// launch takes; where all are equal, and the second time in columns of tables that may hold flags, 0 or 1.
constexpr int disturbances = 2;

/// Of tables of more lines than these (`link`: connections to lights, then steps), each so many are a column of their
/// own.
constexpr std::size_t lines_at_once = 4;

/// Tables of their own of one whole number an item.
const std::set<std::string> lists = {"index",
                                     "bin",
                                     "offsets_state",
                                     "gather_bin",
                                     "gather_index",
                                     "moved_bin",
                                     "moved_index",
                                     "pair_gather",
                                     "pair_photon",
                                     "photon_key",
                                     "photon_line_of",
                                     "photon_line_sorted",
                                     "photon_sort_index",
                                     "photon_sort_key",
                                     "sort_from",
                                     "sort_index",
                                     "sort_index_next",
                                     "sort_key",
                                     "sort_key_next"};

/// What a session makes of the scene (runtime/wavefront/session.cpp), which is not counted.
const std::set<std::string> scene_records = {"triangles",
                                             "triangle_normals",
                                             "triangle_tangents",
                                             "triangle_texcoords",
                                             "spheres",
                                             "sphere_axes",
                                             "primitive_material",
                                             "primitive_light",
                                             "primitive_bin",
                                             "primitive_back_bin",
                                             "materials",
                                             "material_back",
                                             "material_class",
                                             "material_gathers",
                                             "material_keeps",
                                             "material_kind",
                                             "material_lookups",
                                             "material_textures",
                                             "bin_of_material",
                                             "leaving_bin",
                                             "record_kind",
                                             "blends",
                                             "blend_weights",
                                             "normal_maps",
                                             "bump_scales",
                                             "textures",
                                             "texels",
                                             "texture_reals",
                                             "lights",
                                             "light_kinds",
                                             "light_alias",
                                             "light_nodes",
                                             "light_leaves",
                                             "light_slots",
                                             "light_leaf",
                                             "light_textures",
                                             "light_pictures",
                                             "emissions",
                                             "emission_alias",
                                             "environment_texels",
                                             "environment_cells",
                                             "environment_strips",
                                             "camera"};

void disturb(char *column, std::size_t rows, bool is_uint, bool is_table, std::size_t taken_row, int way) {
    if (is_uint) {
        std::uint32_t number = number_at(column, taken_row);
        bool all_equal = true;
        for (std::size_t row = 0; row < rows; ++row)
            all_equal = all_equal && number_at(column, row) == number;
        if (all_equal || (way == 1 && is_table && number <= 1))
            number = number == 0 ? 1 : 0;
        for (std::size_t row = 0; row < rows; ++row)
            std::memcpy(column + row * float_bytes, &number, sizeof number);
        return;
    }
    for (std::size_t row = 0; row < rows; ++row) {
        float value;
        std::memcpy(&value, column + row * float_bytes, sizeof value);
        value = way == 0 ? 0.5f * value + 0.3f : -value;
        std::memcpy(column + row * float_bytes, &value, sizeof value);
    }
}

bool differ(const std::vector<char> &a, const std::vector<char> &b, std::size_t first, std::size_t bytes) {
    return std::memcmp(&a[first], &b[first], bytes) != 0;
}

} // namespace

void Replay::restore() const {
    for (const Memory &memory : memory_)
        if (memory.is_written)
            write(memory.buffer, *memory.content);
}

std::vector<std::vector<char>> Replay::contents() const {
    std::vector<std::vector<char>> result;
    for (const Memory &memory : memory_)
        result.push_back(content_of(memory.buffer));
    return result;
}

void Replay::run() {
    if (lines_ > 0)
        kernel_.launch(items_, lines_);
    else
        kernel_.launch_planes(items_, planes_);
    finish(*device_);
}

double Replay::seconds() {
    restore();
    kernel_.reset_usage();
    run();
    return kernel_.usage().seconds;
}

CapturedLaunch::CapturedLaunch(Device &device, const Launch &launch)
    : device_(device), request_(launch.request), traits_(launch.traits), arguments_(launch.arguments),
      items_(launch.items), lines_(launch.lines), planes_(launch.planes) {
    for (const auto &[name, argument] : arguments_) {
        const Buffer *buffer = std::get_if<Buffer>(&argument.value);
        if (!buffer)
            continue;
        const auto same = std::find_if(buffers_.begin(), buffers_.end(), [&](const CapturedBuffer &other) {
            return *static_cast<void *const *>(other.buffer.argument()) ==
                   *static_cast<void *const *>(buffer->argument());
        });
        if (same != buffers_.end()) {
            same->arguments.push_back(name);
            continue;
        }
        CapturedBuffer captured{{name}, *buffer, content_of(*buffer), !argument.type.starts_with("uint")};
        if (const TableLayout *layout = table_layout(name); layout && captured.is_real)
            lay_out(captured, *layout);
        buffers_.push_back(std::move(captured));
    }
    // One run tells what the launch writes.
    is_written_.assign(buffers_.size(), true);
    replay(Precision::single).run();
    const std::vector<std::vector<char>> after = contents();
    for (std::size_t b = 0; b < buffers_.size(); ++b)
        is_written_[b] = after[b] != buffers_[b].content;
    restore();
}

CapturedLaunch::~CapturedLaunch() { restore(); }

void CapturedLaunch::lay_out(CapturedBuffer &captured, const TableLayout &layout) const {
    captured.rows = layout.rows({.capacity = uint_argument("capacity"),
                                 .slots = uint_argument("slots"),
                                 .pixels = uint_argument("pixels"),
                                 .crop_width = uint_argument("crop_width"),
                                 .own_rows = uint_argument("own_rows"),
                                 .photon_rows = uint_argument("photon_rows"),
                                 .new_photon_rows = uint_argument("new_photon_rows"),
                                 .pair_rows = uint_argument("pair_rows"),
                                 .gather_rows = uint_argument("gather_rows"),
                                 .chain_rows = uint_argument("chain_rows"),
                                 .chain_vertices = uint_argument("chain_vertices"),
                                 .traced_rows = uint_argument("traced_rows")});
    if (captured.rows == 0)
        return;
    for (const TableColumn &column : layout.columns)
        captured.is_uint.push_back(column.is_uint);
    captured.is_uint.resize(std::min(captured.is_uint.size(), captured.content.size() / (captured.rows * float_bytes)));
    const std::string &name = captured.arguments.front();
    // An item has one of the photons that move, and one half of the passes; a chain has any number of vertices.
    captured.lines = name == "moved" || name == "radius_bias"
                         ? 1
                         : layout.rows({.capacity = 1,
                                        .slots = 1,
                                        .pixels = 1,
                                        .crop_width = 1,
                                        .own_rows = uint_argument("at_first") ? 1u : 4u,
                                        .photon_rows = 1,
                                        .new_photon_rows = 1,
                                        .pair_rows = 1,
                                        .gather_rows = 1,
                                        .chain_rows = 1,
                                        .chain_vertices = 0,
                                        .traced_rows = 1});
    if (captured.lines > 0)
        captured.line_rows =
            name == "link" || name == "offset_ray" ? uint_argument("stride") : captured.rows / captured.lines;
}

std::size_t CapturedLaunch::pixels_of_tiles() const {
    const std::size_t columns = uint_argument("tile_columns"), width = uint_argument("width");
    if (columns == 0)
        return 0;
    const std::size_t across = (width + columns - 1) / columns, planes = items_ / SOLVER_TILE / across;
    return planes * width * uint_argument("height");
}

std::size_t CapturedLaunch::uint_argument(const std::string &name) const {
    const auto found = arguments_.find(name);
    return found == arguments_.end() ? 0 : std::get<std::uint32_t>(found->second.value);
}

std::vector<std::vector<char>> CapturedLaunch::contents() const {
    std::vector<std::vector<char>> result;
    for (const CapturedBuffer &captured : buffers_)
        result.push_back(content_of(captured.buffer));
    return result;
}

void CapturedLaunch::restore() const {
    for (std::size_t b = 0; b < buffers_.size(); ++b)
        if (is_written_[b])
            write(buffers_[b].buffer, buffers_[b].content);
}

Replay CapturedLaunch::replay(Precision precision, const std::map<std::string, std::string> &definitions) {
    KernelRequest request = request_;
    request.definitions.insert(definitions.begin(), definitions.end());
    Replay replay;
    replay.device_ = &device_;
    replay.items_ = items_;
    replay.lines_ = lines_;
    replay.planes_ = planes_;
    replay.kernel_ = KernelLibrary(device_, traits_, precision).build({request}).front();
    for (const auto &[name, argument] : arguments_) {
        if (const auto *number = std::get_if<std::uint32_t>(&argument.value))
            replay.kernel_.set(name, *number);
        else if (const auto *value = std::get_if<double>(&argument.value))
            replay.kernel_.set_real(name, *value);
    }
    for (std::size_t b = 0; b < buffers_.size(); ++b) {
        const CapturedBuffer &captured = buffers_[b];
        Replay::Memory memory{captured.buffer, nullptr, is_written_[b]};
        if (precision == Precision::double_) {
            memory.content = std::make_shared<const std::vector<char>>(widened(captured));
            memory.buffer = Buffer(device_, captured.buffer.name(), memory.content->data(), memory.content->size());
        } else {
            // Not owned: the capture outlives its replays.
            memory.content = std::shared_ptr<const std::vector<char>>(std::shared_ptr<void>(), &captured.content);
        }
        for (const std::string &argument : captured.arguments)
            replay.kernel_.bind(argument, memory.buffer);
        replay.memory_.push_back(memory); // a kernel does not keep its buffers
    }
    return replay;
}

bool CapturedLaunch::has_known_rows() const {
    // With this argument an item looks at gather points of several paths.
    if (arguments_.contains("strip_pixels") && arguments_.contains("gather"))
        return false;
    return std::all_of(buffers_.begin(), buffers_.end(), [](const CapturedBuffer &captured) {
        const std::string &name = captured.arguments.front();
        return captured.rows > 0 ? captured.lines > 0 : lists.contains(name) || scene_records.contains(name);
    });
}

std::optional<double> CapturedLaunch::table_bytes_an_item() {
    if (!has_known_rows())
        return std::nullopt;
    restore();
    Replay launch = replay(Precision::single);
    launch.run();
    const std::vector<std::vector<char>> result = contents();
    restore();

    // A row of the tables that the launch takes, and the place of it in the list of rows where there is one.
    const std::size_t place = uint_argument("first");
    std::size_t taken_row = place;
    for (const CapturedBuffer &captured : buffers_)
        if (captured.arguments.front() == "index")
            taken_row = number_at(captured.content.data(), place);

    double bytes = 0;
    for (std::size_t b = 0; b < buffers_.size(); ++b) {
        const CapturedBuffer &captured = buffers_[b];
        const std::string &name = captured.arguments.front();
        const bool is_list = lists.contains(name);
        if (!is_list && captured.rows == 0)
            continue;
        const std::size_t rows = is_list ? captured.content.size() / float_bytes : captured.rows;
        const std::size_t columns = is_list ? 1 : captured.is_uint.size();
        const std::size_t lines = is_list ? 1 : std::min(captured.lines, lines_at_once);
        const std::size_t parts = is_list ? 1 : captured.lines / lines;
        for (std::size_t c = 0; c < columns * parts; ++c) {
            const std::size_t part = c % parts, begin = parts > 1 ? part * lines * captured.line_rows : 0;
            const std::size_t part_rows = parts > 1 ? lines * captured.line_rows : rows;
            const std::size_t first = (c / parts * rows + begin) * float_bytes, size = part_rows * float_bytes;
            bool is_read = false, is_written = differ(result[b], captured.content, first, size);
            for (int way = 0; way < disturbances; ++way) {
                std::vector<char> disturbed = captured.content;
                disturb(&disturbed[first], part_rows, is_list || captured.is_uint[c / parts], !is_list,
                        std::min(is_list ? place : taken_row, part_rows - 1), way);
                write(captured.buffer, disturbed);
                launch.run();
                const std::vector<std::vector<char>> other = contents();
                write(captured.buffer, captured.content);
                restore();

                is_written = is_written || differ(other[b], disturbed, first, size);
                for (std::size_t o = 0; o < buffers_.size(); ++o)
                    if (o != b)
                        is_read = is_read || other[o] != result[o];
                for (std::size_t at = 0; at < result[b].size() && !is_read; at += float_bytes) {
                    const bool is_own = at >= first && at < first + size;
                    // What was disturbed stays so where it is not written: that is no reading.
                    is_read = differ(other[b], result[b], at, float_bytes) &&
                              (!is_own || differ(other[b], disturbed, at, float_bytes));
                }
            }
            bytes += double(float_bytes * lines) / double(planes_) * (int(is_read) + int(is_written));
        }
    }
    return bytes;
}

} // namespace gradus::bench
