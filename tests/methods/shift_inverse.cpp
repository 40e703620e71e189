// The scene's primitives on the host, whichever a scene has.
#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#include "tests/methods/shift_inverse.h"

#include "kernels/lib/scene_hit.h"
#include "kernels/shared/tables.h"
#include "runtime/wavefront/host_table.h"
#include "runtime/wavefront/invariant_division.h"
#include "runtime/wavefront/segments.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace gradus::testing {

using namespace lib_float;

namespace {

constexpr std::uint32_t unit = 1; // of FIELD_OF

/// A table made on the host.
class MadeTable {
  public:
    MadeTable(int columns, std::size_t rows) : rows_(rows), values_(std::size_t(columns) * rows, 0.0f) {}
    float &at(int column, std::size_t row) { return values_[std::size_t(column) * rows_ + row]; }
    void set(int column, std::size_t row, std::uint32_t value) { std::memcpy(&at(column, row), &value, sizeof value); }
    void set(int column, std::size_t row, vec3 value) {
        at(column, row) = value.x;
        at(column + 1, row) = value.y;
        at(column + 2, row) = value.z;
    }
    Buffer on(Device &device) const {
        return Buffer(device, "made", values_.data(), values_.size() * sizeof(values_[0]));
    }

  private:
    std::size_t rows_;
    std::vector<float> values_;
};

vec3 vector_at(const HostTable &table, int column, std::size_t row) {
    return v3(float(table.real(column, row)), float(table.real(column + 1, row)), float(table.real(column + 2, row)));
}

template <class Arguments>
std::uint32_t number(const Arguments &arguments, const char *name) {
    const auto found = arguments.find(name);
    return found == arguments.end() ? 0 : std::get<std::uint32_t>(found->second.value);
}

} // namespace

/// A vertex of a path: its row of a table of vertices, with all columns that the scene has, textures' among them.
struct Vertex {
    /// Bits: as numbers, small integers would be denormal and might be flushed to zero.
    std::vector<std::uint32_t> row;
    float real(int column) const { return std::bit_cast<float>(row[std::size_t(column)]); }
    vec3 position() const { return v3(real(vertex_position_x), real(vertex_position_y), real(vertex_position_z)); }
};

/// A base path's vertex, the offset path's, and the segments by which both go on.
struct ShiftInverter::Base {
    Vertex base, offset;
    vec3 base_origin{}, base_direction{}, offset_origin{}, offset_direction{};
    std::uint32_t base_primitive = 0, offset_primitive = 0; ///< what they meet
    bool reconnects = false;
    float ratio = 0; ///< of the offset path's density times the Jacobian to the base path's, for this segment
    /// The offset path's density where it copied at a rough vertex; else 0: then it is that of its copy to itself.
    float pdf = 0;
    bool takes_dirac = false; ///< the base path's lobe
    /// Of blends, the record that each has come to where its segment ends.
    std::uint32_t base_record = 0, offset_record = 0;
    bool is_escaped() const { return base_primitive == ray_escaped; }
};

namespace {

// All tables of vertices have the same columns.
static_assert(int(vertex_kind) == int(own_vertex_kind) && int(vertex_along_z) == int(own_vertex_along_z));

int columns_of(const Buffer &table, std::size_t rows) { return int(table.bytes() / (rows * sizeof(float))); }

Vertex read_vertex(const HostTable &table, int columns, std::size_t row) {
    Vertex v;
    for (int column = 0; column < columns; ++column)
        v.row.push_back(table.uint(column, row));
    return v;
}

void write_vertex(MadeTable &table, std::size_t row, const Vertex &v) {
    for (std::size_t column = 0; column < v.row.size(); ++column)
        table.set(int(column), row, v.row[column]);
}

/// The row of offset j of base row n: j = 0 goes back, j = 1 stays, so that its ratio is the density at home.
constexpr std::uint32_t back = 0, home = 1;

/// Of the way to a vertex: further off is another one.
constexpr float allowed_miss = 1e-3f;

/// The first of the lines of `link` and `evaluation` that are steps.
constexpr std::size_t step_lines = 4;

} // namespace

ShiftInverter::ShiftInverter(Device &device, const Scene &scene)
    : device_(device), tables_(make_scene_tables(scene, with_all_traits(scene_traits(scene)))), tracer_(scene, 0) {
    observe_launches(device, [this](const Launch &launch) { on_launch(launch); });
}

ShiftInverter::~ShiftInverter() { observe_launches(device_, {}); }

Kernel ShiftInverter::kernel_of(const std::string &stage) {
    const Kept &kept = stages_.at(stage);
    Kernel &kernel = kernels_[stage];
    if (!kernel.valid())
        kernel = KernelLibrary(device_, kept.traits).build({kept.request}).front();
    for (const auto &[name, argument] : kept.arguments)
        if (const auto *value = std::get_if<std::uint32_t>(&argument.value))
            kernel.set(name, *value);
        else if (const auto *real = std::get_if<double>(&argument.value))
            kernel.set_real(name, *real);
        else
            kernel.bind(name, std::get<Buffer>(argument.value));
    return kernel;
}

void ShiftInverter::on_launch(const Launch &launch) {
    if (!launch.request.file.starts_with("kernels/stages/"))
        return;
    // What `weigh` left is there until the stage after it, and so is what it was given.
    if (launch.request.entry != "weigh") {
        for (const Kept &weigh : std::exchange(weighed_, {}))
            if (const std::vector<Base> bases = arrivals(weigh); !bases.empty())
                take_back(weigh, bases);
    }
    const Kept kept = {launch.request, launch.traits, launch.arguments};
    stages_.insert_or_assign(launch.request.name, kept);
    if (launch.request.entry == "shift")
        shift_ = kept.arguments;
    // Launches on nothing, by which a method warms its kernels, have tables without content.
    if (launch.request.entry == "weigh" && number(launch.arguments, "count") > 0)
        weighed_.push_back(kept);
}

/// Of the tables `surface`, the column of the record that a blend has come to: the last one. 0 without such tables.
int ShiftInverter::record_column(const Kept &weigh) {
    const auto found = weigh.arguments.find("surface");
    return found == weigh.arguments.end()
               ? 0
               : columns_of(std::get<Buffer>(found->second.value), number(weigh.arguments, "capacity")) - 1;
}

std::vector<ShiftInverter::Base> ShiftInverter::arrivals(const Kept &weigh) const {
    const auto argument = [&](const char *name) { return number(weigh.arguments, name); };
    const std::size_t capacity = argument("capacity"), stride = argument("stride");
    const bool may_be_apart = weigh.traits.at("TRAIT_APART") != 0;
    const bool at_first = !may_be_apart || argument("at_first") != 0;
    const bool has_blends = weigh.traits.at("TRAIT_BLENDS") != 0;
    const Buffer none(device_, "none", sizeof(float));
    const auto buffer = [&](const char *name) -> const Buffer & {
        // `weigh` itself does not read the rays where none are apart; the last `shift` before it read them.
        const Arguments &arguments = weigh.arguments.contains(name) ? weigh.arguments : shift_;
        const auto found = arguments.find(name);
        return found == arguments.end() ? none : std::get<Buffer>(found->second.value);
    };
    const auto table = [&](const char *name, std::size_t rows) {
        return HostTable(buffer(name), rows, Precision::single);
    };
    const HostTable path = table("path", capacity), ray = table("ray", capacity), vertex = table("vertex", capacity),
                    own_vertex = table("own_vertex", argument("own_rows")), offset = table("offset", 4 * capacity),
                    shift = table("shift", 4 * capacity), link = table("link", 8 * capacity),
                    offset_ray = table("offset_ray", 4 * capacity), surface = table("surface", capacity),
                    offset_surface = table("offset_surface", 4 * capacity);
    const int columns = columns_of(buffer("vertex"), capacity), record = record_column(weigh);
    std::vector<Base> bases;
    const std::uint32_t width = argument("crop_width"), height = argument("crop_height");
    for (std::size_t row = argument("first"); row < argument("first") + argument("count"); ++row)
        for (std::uint32_t j = 0; j < 4; ++j) {
            const std::size_t at = j * capacity + row, segment = (step_lines + j) * stride + row;
            Base b;
            b.reconnects = true;
            double ratio_before = 1;
            if (may_be_apart) {
                const std::uint32_t state = offset.uint(offset_state, at);
                if (state == connection_full)
                    continue;
                ratio_before = shift.real(shift_light_density, at); // where `weigh` leaves it
                b.reconnects = state == connection_recent;
            }
            const double ratio = offset.real(offset_ratio, at);
            // Paths of density 0 are never base paths.
            if (!(ratio > 0) || !(ratio_before > 0))
                continue;
            std::size_t own_row = at;
            if (at_first) {
                const std::uint32_t slot = path.uint(path_slot, row), place = slot % argument("strip_pixels");
                const std::uint32_t x = place % width, y = place / width + argument("strip_first");
                const bool is_there = j == 0 ? x + 1 < width : j == 1 ? x > 0 : j == 2 ? y + 1 < height : y > 0;
                EXPECT_TRUE(is_there) << "offset " << j << " of pixel " << x << ", " << y;
                own_row = (j == 0   ? slot + 1
                           : j == 1 ? slot - 1
                           : j == 2 ? slot + width
                                    : slot - width) +
                          argument("primary_shift");
            }
            b.ratio = float(ratio / ratio_before);
            b.takes_dirac = path.real(path_pdf, row) == 0;
            b.base_origin = vector_at(ray, ray_origin_x, row);
            b.base_direction = vector_at(ray, ray_direction_x, row);
            b.base_primitive = ray.uint(ray_primitive, row);
            b.offset_origin = vector_at(link, link_origin_x, segment);
            b.offset_direction = v3_neg(vector_at(offset, offset_wi_x, at));
            b.offset_primitive = b.base_primitive;
            if (has_blends && !b.is_escaped())
                b.base_record = b.offset_record = surface.uint(record, row);
            if (b.reconnects) {
                if (link.uint(link_open, segment) == 0)
                    continue;
            } else {
                const std::size_t sent = j * stride + row;
                b.pdf = float(offset.real(offset_pdf, at));
                b.offset_origin = vector_at(offset_ray, offset_ray_origin_x, sent);
                b.offset_primitive = offset_ray.uint(offset_ray_primitive, sent);
                // `gradient_emission` sees to that.
                if ((b.offset_primitive == ray_escaped) != b.is_escaped())
                    continue;
                if (has_blends && !b.is_escaped())
                    b.offset_record = offset_surface.uint(record, sent);
            }
            b.offset = read_vertex(own_vertex, columns, own_row);
            b.base = read_vertex(vertex, columns, row);
            bases.push_back(b);
        }
    return bases;
}

vec3 ShiftInverter::hit(std::uint32_t primitive, vec3 origin, vec3 direction) const {
    return primitive_hit_of(tables_.triangles.data(), tables_.spheres.data(), unit, tables_.triangle_count, primitive,
                            origin, direction)
        .position;
}

void ShiftInverter::take_back(const Kept &weigh, const std::vector<Base> &bases) {
    const std::uint32_t rows = std::uint32_t(bases.size());
    const bool may_be_apart = weigh.traits.at("TRAIT_APART") != 0;
    // Where none are apart, offset vertices are those of neighbours on the film: of three pixels for each row.
    const std::uint32_t pixels = may_be_apart ? rows : 3 * rows, own_rows = may_be_apart ? 4 * rows : pixels;
    const int columns = int(bases.front().base.row.size()), record = record_column(weigh);
    MadeTable path(path_columns, rows), vertex(columns, rows), ray(ray_columns, rows), event(event_columns, rows),
        before(offset_columns, 4 * rows), own_vertex(columns, own_rows), surface(record + 1, rows),
        offset_surface(record + 1, 4 * rows);
    for (std::uint32_t n = 0; n < rows; ++n) {
        const Base &b = bases[n];
        path.set(path_slot, n, may_be_apart ? n : 3 * n + 1);
        path.set(path_depth, n, 1u);
        path.at(path_pdf, n) = b.takes_dirac ? 0.0f : 1.0f;
        write_vertex(vertex, n, b.offset);
        event.at(event_pdf, n) = 1;
        ray.set(ray_origin_x, n, b.offset_origin);
        // From where rays start, which is off the surface, to the very point.
        vec3 direction = b.offset_direction;
        if (b.reconnects && !b.is_escaped())
            direction = v3_normalize(v3_sub(hit(b.base_primitive, b.base_origin, b.base_direction), b.offset_origin));
        ray.set(ray_direction_x, n, direction);
        ray.set(ray_primitive, n, b.offset_primitive);
        surface.set(record, n, b.offset_record);
        for (std::uint32_t j = 0; j < 4; ++j) {
            before.at(offset_ratio, j * rows + n) = j <= home ? 1.0f : shift_absent;
            before.set(offset_state, j * rows + n, connection_none);
            offset_surface.set(record, j * rows + n, j == back ? b.base_record : b.offset_record);
            if (may_be_apart)
                write_vertex(own_vertex, j * rows + n, j == back ? b.base : b.offset);
        }
        if (!may_be_apart) {
            write_vertex(own_vertex, 3 * n + 2, b.base); // to the right, j = 0
            write_vertex(own_vertex, 3 * n, b.offset);   // to the left, j = 1
        }
    }

    const Buffer offset = before.on(device_), shift = MadeTable(shift_columns, 4 * rows).on(device_),
                 link = MadeTable(link_columns, 8 * rows).on(device_),
                 offset_ray = MadeTable(offset_ray_columns, 4 * rows).on(device_);
    const std::map<std::string, Buffer> buffers = {
        {"path", path.on(device_)},
        {"vertex", vertex.on(device_)},
        {"ray", ray.on(device_)},
        {"event", event.on(device_)},
        {"own_vertex", own_vertex.on(device_)},
        {"surface", surface.on(device_)},
        {"offset_surface", offset_surface.on(device_)},
        {"offset", offset},
        {"shift", shift},
        {"link", link},
        {"offset_ray", offset_ray},
        {"evaluation", MadeTable(evaluation_columns, 8 * rows).on(device_)},
        {"shadow", MadeTable(shadow_columns, rows).on(device_)},
        {"prefix", MadeTable(prefix_columns, pixels).on(device_)},
        {"difference", MadeTable(difference_columns, 4 * pixels).on(device_)},
        {"offsets_state", MadeTable(1, rows).on(device_)}};
    const InvariantDivision by_pixels = invariant_division(pixels);
    const std::map<std::string, std::uint32_t> numbers = {{"count", rows},
                                                          {"first", 0},
                                                          {"first_line", std::uint32_t(step_lines)},
                                                          {"stride", rows},
                                                          {"capacity", rows},
                                                          {"slots", pixels},
                                                          {"own_rows", own_rows},
                                                          {"at_first", !may_be_apart},
                                                          {"primary_shift", 0},
                                                          {"strip_first", 0},
                                                          {"strip_pixels", pixels},
                                                          {"strip_multiplier", by_pixels.multiplier},
                                                          {"strip_shift", by_pixels.shift},
                                                          {"width_multiplier", by_pixels.multiplier},
                                                          {"width_shift", by_pixels.shift},
                                                          {"crop_width", pixels},
                                                          {"crop_height", 1}};
    const auto run = [&](const std::string &stage, std::size_t planes) {
        Kernel kernel = kernel_of(stage);
        for (const auto &[name, buffer] : buffers)
            kernel.bind(name, buffer);
        for (const auto &[name, value] : numbers)
            kernel.set(name, value);
        kernel.launch_planes(rows, planes);
    };
    run("shift", 1);
    for (const auto &[name, stage] : stages_)
        if (stage.request.entry == "evaluate")
            run(name, 4);
    SegmentTable rays;
    if (may_be_apart)
        rays = {&offset_ray, 4 * rows, 4 * rows, offset_ray_origin_x, offset_ray_direction_x, offset_ray_primitive};
    SegmentTracer(device_, tracer_, Precision::single)
        .trace(rays, {&link, 8 * rows, 8 * rows, link_origin_x, link_direction_x, link_open});
    run(may_be_apart ? "weigh apart" : "weigh", 1);
    finish(device_);

    const HostTable after(offset, 4 * rows, Precision::single), links(link, 8 * rows, Precision::single),
        sent(offset_ray, 4 * rows, Precision::single);
    for (std::uint32_t n = 0; n < rows; ++n) {
        const Base &b = bases[n];
        InverseShifts &found = found_[b.reconnects ? 0 : 1];
        ++found.shifts;
        const std::size_t back_row = back * rows + n, home_row = home * rows + n;
        const double there = after.real(offset_ratio, back_row),
                     density = b.pdf > 0 ? b.pdf : after.real(offset_ratio, home_row);
        if (!(there > 0) || !(density > 0)) {
            ++found.one_way;
            continue;
        }
        if (may_be_apart && (after.uint(offset_state, back_row) == connection_recent) != b.reconnects) {
            ++found.other_kind;
            continue;
        }
        const vec3 direction = v3_neg(vector_at(after, offset_wi_x, back_row));
        vec3 origin{};
        std::uint32_t primitive = b.base_primitive;
        if (b.reconnects) {
            if (links.uint(link_open, (step_lines + back) * rows + n) == 0) {
                ++found.one_way;
                continue;
            }
        } else {
            primitive = sent.uint(offset_ray_primitive, back_row);
            origin = vector_at(sent, offset_ray_origin_x, back_row);
            if ((primitive == ray_escaped) != b.is_escaped()) {
                ++found.one_way;
                continue;
            }
        }
        double away = std::sqrt(v3_length_squared(v3_sub(direction, b.base_direction)));
        if (!b.is_escaped()) {
            const vec3 end = hit(b.base_primitive, b.base_origin, b.base_direction);
            const vec3 way = v3_sub(end, b.base.position());
            // A miss of no more than rays start off the surface is rounding of positions, however short the way.
            const vec3 miss =
                b.reconnects
                    ? v3_sub(direction, v3_normalize(way))
                    : v3_scale(v3_sub(hit(primitive, origin, direction), end),
                               1 / (std::sqrt(v3_length_squared(way)) + b.base.real(vertex_offset) / allowed_miss));
            away = std::sqrt(v3_length_squared(miss));
        }
        if (!(away < allowed_miss)) {
            ++found.elsewhere;
            continue;
        }
        const double product = double(b.ratio) * there / density;
        found.jacobian_errors.push_back(float(std::max(product, 1 / product) - 1));
    }
}

} // namespace gradus::testing
