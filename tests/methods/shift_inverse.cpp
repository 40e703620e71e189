// The scene's primitives on the host, whichever a scene has.
#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#define TRAIT_TWO_FACED 1
#include "tests/methods/shift_inverse.h"

#include "kernels/lib/reconnectable.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/tables.h"
#include "runtime/stages/host_table.h"
#include "runtime/stages/invariant_division.h"

#include <cmath>
#include <cstring>

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
    std::uint32_t *whole(int column) { return reinterpret_cast<std::uint32_t *>(&at(column, 0)); }
    Buffer on(Device &device) const {
        return Buffer(device, "made", values_.data(), values_.size() * sizeof(values_[0]));
    }
    /// What the tracer takes, of columns that begin with a segment's origin and direction.
    SegmentColumns segments() { return {{&at(0, 0), &at(1, 0), &at(2, 0)}, {&at(3, 0), &at(4, 0), &at(5, 0)}}; }

  private:
    std::size_t rows_;
    std::vector<float> values_;
};

vec3 vector_at(const HostTable &table, int column, std::size_t row) {
    return v3(float(table.real(column, row)), float(table.real(column + 1, row)), float(table.real(column + 2, row)));
}

/// Rows of a table on the device, copied so that the tracer may answer in them.
MadeTable copy_of(const HostTable &table, int columns, std::size_t rows) {
    MadeTable copy(columns, rows);
    for (int column = 0; column < columns; ++column)
        for (std::size_t row = 0; row < rows; ++row)
            copy.set(column, row, table.uint(column, row));
    return copy;
}

} // namespace

/// A vertex of a path, with all that the tables keep of it.
struct Vertex {
    std::uint32_t kind = 0, material = 0;
    vec3 position{}, wi{}, geometric{}, shading{}, along{};
    float offset = 0;
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
};

namespace {

/// Where `primary` and `offset_vertex` have the first of the columns that they share (GRADUS_LONE_VERTEX_COLUMNS).
constexpr int in_primary = primary_kind, in_offset_vertex = offset_vertex_kind;
static_assert(in_offset_vertex == 0);

Vertex read_lone(const HostTable &table, int first, std::size_t row, bool has_shading, bool has_along) {
    Vertex v;
    v.kind = table.uint(first + offset_vertex_kind, row);
    v.material = table.uint(first + offset_vertex_material, row);
    v.position = vector_at(table, first + offset_vertex_position_x, row);
    v.wi = vector_at(table, first + offset_vertex_wi_x, row);
    v.geometric = vector_at(table, first + offset_vertex_geometric_x, row);
    v.shading = has_shading ? vector_at(table, first + offset_vertex_shading_x, row) : v.geometric;
    v.along = has_along ? vector_at(table, first + offset_vertex_along_x, row) : v3(0, 0, 0);
    v.offset = float(table.real(first + offset_vertex_offset, row));
    return v;
}

void write_lone(MadeTable &table, int first, std::size_t row, const Vertex &v) {
    table.set(first + offset_vertex_kind, row, v.kind);
    table.set(first + offset_vertex_material, row, v.material);
    table.set(first + offset_vertex_position_x, row, v.position);
    table.set(first + offset_vertex_wi_x, row, v.wi);
    table.set(first + offset_vertex_geometric_x, row, v.geometric);
    table.set(first + offset_vertex_shading_x, row, v.shading);
    table.set(first + offset_vertex_along_x, row, v.along);
    table.at(first + offset_vertex_offset, row) = v.offset;
}

/// The row of offset j of base row n: j = 0 goes back, j = 1 stays, so that its ratio is the density at home.
constexpr std::uint32_t back = 0, home = 1;

/// Of the way to a vertex: further off is another one.
constexpr float allowed_miss = 1e-3f;

} // namespace

ShiftInverter::ShiftInverter(Device &device, const Scene &scene)
    : device_(device), tables_(make_scene_tables(scene, with_all_traits(scene_traits(scene)))), tracer_(scene, 0) {
    observe_launches(device, [this](const Launch &launch) { on_launch(launch); });
}

ShiftInverter::~ShiftInverter() { observe_launches(device_, {}); }

std::uint32_t ShiftInverter::number(const Launch &launch, const char *name) const {
    const auto found = launch.arguments.find(name);
    return found == launch.arguments.end() ? 0 : std::get<std::uint32_t>(found->second.value);
}

Kernel &ShiftInverter::kernel_for(const Launch &launch, bool as_apart) {
    KernelRequest request = launch.request;
    if (as_apart) {
        request.definitions.erase("APART");
        request.definitions.emplace("APART", "1");
    }
    Kernel &kernel = kernels_[{request.definitions["APART"], request.definitions["ESCAPED"]}];
    if (!kernel.valid())
        kernel = KernelLibrary(device_, launch.traits).build({request}).front();
    return kernel;
}

/// All arguments as the render has them.
void ShiftInverter::bind_rest(Kernel &kernel, const Launch &launch) const {
    const auto bind = [&](const std::string &name, const Launch::Argument &argument) {
        if (const auto *value = std::get_if<std::uint32_t>(&argument.value))
            kernel.set(name, *value);
        else if (const auto *real = std::get_if<double>(&argument.value))
            kernel.set_real(name, *real);
        else
            kernel.bind(name, std::get<Buffer>(argument.value));
    };
    for (const auto &[name, argument] : arguments_)
        bind(name, argument);
    for (const auto &[name, argument] : launch.arguments)
        bind(name, argument);
}

void ShiftInverter::on_launch(const Launch &launch) {
    for (const auto &[name, argument] : launch.arguments)
        arguments_.insert_or_assign(name, argument);
    // Launches on nothing, by which a method warms its kernels, have tables without content.
    if (launch.request.entry != "shift" || number(launch, "count") == 0)
        return;
    const std::vector<Base> bases = arrivals(launch);
    if (!bases.empty())
        take_back(launch, bases);
}

std::vector<ShiftInverter::Base> ShiftInverter::arrivals(const Launch &launch) {
    const std::size_t count = launch.items, capacity = number(launch, "capacity"), slots = number(launch, "slots");
    const bool may_be_apart = launch.traits.at("TRAIT_APART") != 0;
    const bool is_apart_kernel = launch.request.definitions.at("APART") == "1";
    const bool is_escaped = launch.request.definitions.at("ESCAPED") == "1";
    const bool has_along = launch.traits.at("TRAIT_ANISOTROPIC") != 0;
    const bool has_shading = launch.traits.at("TRAIT_SHADING_NORMALS") != 0;

    // The launch ahead of time: what it leaves, the render's own will leave again.
    Kernel &forward = kernel_for(launch, false);
    bind_rest(forward, launch);
    forward.launch(count);
    finish(device_);
    // Tables that the scene does not need may not be there.
    const auto table = [&](const char *name, std::size_t rows) {
        const auto argument = arguments_.find(name);
        return HostTable(argument == arguments_.end() ? Buffer(device_, name, 0)
                                                      : std::get<Buffer>(argument->second.value),
                         rows, Precision::single);
    };
    const HostTable vertex = table("vertex", capacity), ray = table("ray", capacity), index = table("index", capacity),
                    shifted = table("shifted", 4 * capacity), shifted_before = table("shifted_old", 4 * capacity),
                    link_table = table("link", 8 * capacity),
                    lone = may_be_apart ? table("offset_vertex", 4 * capacity) : table("primary", slots),
                    tangent = table("tangent", has_along ? capacity : 1);
    const Buffer kinds = std::get<Buffer>(arguments_.at("material_kind").value);
    std::vector<std::uint32_t> material_kind(kinds.bytes() / sizeof(std::uint32_t));
    kinds.read(material_kind.data(), kinds.bytes());
    const std::uint32_t link_first = number(launch, "link_first"), link_stride = number(launch, "link_stride");
    MadeTable links = copy_of(link_table, link_columns, link_first + 4 * link_stride);
    std::size_t sent_end = 0;
    const std::uint32_t offset_first = number(launch, "offset_first"), offset_stride = number(launch, "offset_stride");
    if (is_apart_kernel)
        sent_end = offset_first + 4 * offset_stride;
    MadeTable sent = is_apart_kernel ? copy_of(table("offset_ray", 4 * capacity), offset_ray_columns, sent_end)
                                     : MadeTable(offset_ray_columns, 1);
    tracer_.trace({sent.segments(), sent.whole(offset_ray_primitive)}, sent_end,
                  {links.segments(), links.whole(link_open)}, link_first + 4 * link_stride);

    const auto base_vertex = [&](std::size_t row) {
        Vertex v;
        v.material = vertex.uint(vertex_material, row);
        v.kind = material_kind[v.material];
        v.position = vector_at(vertex, vertex_position_x, row);
        v.wi = vector_at(vertex, vertex_wi_x, row);
        v.geometric = vector_at(vertex, vertex_geometric_x, row);
        v.shading = has_shading ? vector_at(vertex, vertex_shading_x, row) : v.geometric;
        v.along = has_along ? vector_at(tangent, tangent_along_x, row) : v3(0, 0, 0);
        v.offset = float(vertex.real(vertex_offset, row));
        return v;
    };
    std::vector<Base> bases;
    const std::uint32_t first = number(launch, "first"), to = number(launch, "to");
    const std::uint32_t width = number(launch, "crop_width"), height = number(launch, "crop_height");
    for (std::size_t i = 0; i < count; ++i)
        for (std::uint32_t j = 0; j < 4; ++j) {
            const std::size_t row = index.uint(0, first + i), at = j * capacity + to + i;
            const std::size_t segment = link_first + j * link_stride + i;
            const double ratio = shifted.real(shifted_ratio, at);
            Base b;
            std::size_t from_row = j * capacity + row;
            double ratio_before = 1;
            b.reconnects = true;
            if (may_be_apart) {
                const std::uint32_t state = shifted.uint(shifted_state, at);
                if (state == shift_merged)
                    continue;
                ratio_before = shifted_before.real(shifted_ratio, from_row);
                b.reconnects = state == shift_reconnected;
            } else {
                const std::uint32_t slot = vertex.uint(vertex_slot, row), pixel = slot % (width * height);
                const std::uint32_t x = pixel % width, y = pixel / width;
                const bool is_there = j == 0 ? x + 1 < width : j == 1 ? x > 0 : j == 2 ? y + 1 < height : y > 0;
                if (!is_there)
                    continue;
                from_row = j == 0 ? slot + 1 : j == 1 ? slot - 1 : j == 2 ? slot + width : slot - width;
            }
            // Paths of density 0 are never base paths.
            if (!(ratio > 0) || !(ratio_before > 0))
                continue;
            b.ratio = float(ratio / ratio_before);
            b.base_origin = vector_at(ray, ray_origin_x, row);
            b.base_direction = vector_at(ray, ray_direction_x, row);
            b.base_primitive = ray.uint(ray_primitive, row);
            b.offset_origin = v3(links.at(link_origin_x, segment), links.at(link_origin_y, segment),
                                 links.at(link_origin_z, segment));
            b.offset_direction = v3_neg(vector_at(shifted, shifted_wi_x, at));
            b.offset_primitive = b.base_primitive;
            if (b.reconnects) {
                if (links.whole(link_open)[segment] == 0)
                    continue;
            } else {
                b.pdf = float(shifted.real(shifted_pdf, at));
                const std::size_t sent_row = offset_first + j * offset_stride + i;
                b.offset_origin = v3(sent.at(offset_ray_origin_x, sent_row), sent.at(offset_ray_origin_y, sent_row),
                                     sent.at(offset_ray_origin_z, sent_row));
                b.offset_primitive = sent.whole(offset_ray_primitive)[sent_row];
                if ((b.offset_primitive == ray_escaped) != is_escaped)
                    continue;
            }
            b.offset = read_lone(lone, may_be_apart ? in_offset_vertex : in_primary, from_row, has_shading, has_along);
            b.base = base_vertex(row);
            if (may_be_apart && shifted.uint(shifted_state, at) == shift_apart_rough && !is_escaped) {
                // What `offset_surface` sees to: there the way back would reconnect.
                const int is_behind =
                    primitive_is_behind(tables_.triangles.data(), tables_.spheres.data(), unit, tables_.triangle_count,
                                        b.offset_primitive, b.offset_origin, b.offset_direction);
                const std::uint32_t kind =
                    kind_of_primitive(tables_.primitive_material.data(), tables_.material_back.data(),
                                      material_kind.data(), b.offset_primitive, is_behind);
                const std::uint32_t light = tables_.primitive_light[b.offset_primitive];
                const bool is_long = launch.traits.at("TRAIT_SHIFT_DISTANCE") == 0 ||
                                     is_far(b.base.position, b.offset.position,
                                            hit(b.offset_primitive, b.offset_origin, b.offset_direction), light,
                                            real(std::get<double>(launch.arguments.at("shift_distance").value)));
                if (is_long && is_reconnectable(kind, light))
                    continue;
            }
            bases.push_back(b);
        }
    return bases;
}

vec3 ShiftInverter::hit(std::uint32_t primitive, vec3 origin, vec3 direction) const {
    return primitive_hit_of(tables_.triangles.data(), tables_.spheres.data(), unit, tables_.triangle_count, primitive,
                            origin, direction)
        .position;
}

void ShiftInverter::take_back(const Launch &launch, const std::vector<Base> &bases) {
    const std::uint32_t rows = std::uint32_t(bases.size());
    const bool may_be_apart = launch.traits.at("TRAIT_APART") != 0;
    const bool is_escaped = launch.request.definitions.at("ESCAPED") == "1";
    // Where none are apart, offset vertices are those of neighbours on the film: of three pixels for each row.
    const std::uint32_t pixels = may_be_apart ? rows : 3 * rows;
    MadeTable vertex(vertex_columns, rows), ray(ray_columns, rows), tangent(tangent_columns, rows),
        before(shifted_columns, 4 * rows);
    MadeTable lone = may_be_apart ? MadeTable(offset_vertex_columns, 4 * rows) : MadeTable(primary_columns, pixels);
    MadeTable index(1, rows);
    for (std::uint32_t n = 0; n < rows; ++n) {
        const Base &b = bases[n];
        index.set(0, n, n);
        vertex.set(vertex_slot, n, may_be_apart ? n : 3 * n + 1);
        vertex.at(vertex_pdf, n) = (b.offset.kind & kind_is_dirac) != 0 ? 0.0f : 1.0f;
        vertex.set(vertex_material, n, b.offset.material);
        vertex.set(vertex_position_x, n, b.offset.position);
        vertex.set(vertex_wi_x, n, b.offset.wi);
        vertex.set(vertex_geometric_x, n, b.offset.geometric);
        vertex.set(vertex_shading_x, n, b.offset.shading);
        vertex.at(vertex_offset, n) = b.offset.offset;
        tangent.set(tangent_along_x, n, b.offset.along);
        ray.set(ray_origin_x, n, b.offset_origin);
        // From where rays start, which is off the surface, to the very point.
        vec3 direction = b.offset_direction;
        if (b.reconnects && !is_escaped)
            direction = v3_normalize(v3_sub(hit(b.base_primitive, b.base_origin, b.base_direction), b.offset_origin));
        ray.set(ray_direction_x, n, direction);
        ray.set(ray_primitive, n, b.offset_primitive);
        for (std::uint32_t j = 0; j < 4; ++j) {
            before.at(shifted_ratio, j * rows + n) = j <= home ? 1.0f : shift_absent;
            before.set(shifted_state, j * rows + n, shift_apart);
            if (may_be_apart)
                write_lone(lone, in_offset_vertex, j * rows + n, j == back ? b.base : b.offset);
        }
        if (!may_be_apart) {
            write_lone(lone, in_primary, 3 * n + 2, b.base); // to the right, j = 0
            write_lone(lone, in_primary, 3 * n, b.offset);   // to the left, j = 1
        }
    }

    Kernel &kernel = kernel_for(launch, may_be_apart);
    bind_rest(kernel, launch);
    const Buffer buffers[] = {vertex.on(device_), ray.on(device_),  tangent.on(device_),
                              before.on(device_), lone.on(device_), index.on(device_)};
    const char *const names[] = {"vertex", "ray", "tangent", "shifted_old", may_be_apart ? "offset_vertex" : "primary",
                                 "index"};
    for (std::size_t i = 0; i < std::size(buffers); ++i)
        kernel.bind(names[i], buffers[i]);
    const Buffer shifted = MadeTable(shifted_columns, 4 * rows).on(device_);
    const Buffer link = MadeTable(link_columns, 8 * rows).on(device_);
    const Buffer offset_ray = MadeTable(offset_ray_columns, 4 * rows).on(device_);
    kernel.bind("shifted", shifted);
    kernel.bind("link", link);
    kernel.bind("offset_ray", offset_ray);
    for (const char *zero : {"first", "to", "link_first", "offset_first"})
        kernel.set(zero, 0);
    for (const char *stride : {"count", "link_stride", "offset_stride", "capacity"})
        kernel.set(stride, rows);
    const InvariantDivision by_pixels = invariant_division(pixels);
    kernel.set("slots", pixels);
    kernel.set("pixels", pixels);
    kernel.set("crop_width", pixels);
    kernel.set("crop_height", 1);
    for (const char *name : {"pixels_multiplier", "width_multiplier"})
        kernel.set(name, by_pixels.multiplier);
    for (const char *name : {"pixels_shift", "width_shift"})
        kernel.set(name, by_pixels.shift);
    kernel.launch(rows);
    finish(device_);

    const HostTable after(shifted, 4 * rows, Precision::single);
    MadeTable links = copy_of(HostTable(link, 8 * rows, Precision::single), link_columns, rows);
    MadeTable sent = copy_of(HostTable(offset_ray, 4 * rows, Precision::single), offset_ray_columns, rows);
    tracer_.trace({sent.segments(), sent.whole(offset_ray_primitive)}, may_be_apart ? rows : 0,
                  {links.segments(), links.whole(link_open)}, rows);
    for (std::uint32_t n = 0; n < rows; ++n) {
        const Base &b = bases[n];
        InverseShifts &found = found_[b.reconnects ? 0 : 1];
        ++found.shifts;
        const std::size_t back_row = back * rows + n, home_row = home * rows + n;
        const double there = after.real(shifted_ratio, back_row),
                     density = b.pdf > 0 ? b.pdf : after.real(shifted_ratio, home_row);
        if (!(there > 0) || !(density > 0)) {
            ++found.one_way;
            continue;
        }
        if (may_be_apart && (after.uint(shifted_state, back_row) == shift_reconnected) != b.reconnects) {
            ++found.other_kind;
            continue;
        }
        const vec3 direction = v3_neg(vector_at(after, shifted_wi_x, back_row));
        vec3 origin{};
        std::uint32_t primitive = b.base_primitive;
        if (b.reconnects) {
            if (links.whole(link_open)[n] == 0) {
                ++found.one_way;
                continue;
            }
        } else {
            primitive = sent.whole(offset_ray_primitive)[n];
            origin =
                v3(sent.at(offset_ray_origin_x, n), sent.at(offset_ray_origin_y, n), sent.at(offset_ray_origin_z, n));
            if ((primitive == ray_escaped) != is_escaped) {
                ++found.one_way;
                continue;
            }
        }
        double away = std::sqrt(v3_length_squared(v3_sub(direction, b.base_direction)));
        if (!is_escaped) {
            const vec3 end = hit(b.base_primitive, b.base_origin, b.base_direction);
            const vec3 way = v3_sub(end, b.base.position);
            // A miss of no more than rays start off the surface is rounding of positions, however short the way.
            const vec3 miss = b.reconnects
                                  ? v3_sub(direction, v3_normalize(way))
                                  : v3_scale(v3_sub(hit(primitive, origin, direction), end),
                                             1 / (std::sqrt(v3_length_squared(way)) + b.base.offset / allowed_miss));
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
