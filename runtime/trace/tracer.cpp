#include "runtime/trace/tracer.h"

#include "runtime/error.h"
#include "runtime/trace/clones.h"
#include "runtime/trace/opacity.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <pmmintrin.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>

// After all others: its short macro names are not for library headers.
#include "kernels/shared/tables.h"

namespace gradus {

namespace {

constexpr int width = 16;           // rays a packet
constexpr std::size_t chunk = 4096; // rows a task: small enough to balance, large enough to sort
// Embree's coherent traversal tests a packet as one beam. On sorted rays it is twice as fast as the other in a scene of
// some dozens of primitives, where a cell of origins sees few of them, and half as fast in one of thousands.
constexpr std::size_t beam_limit = 256;

struct alignas(64) Valid {
    int lane[width];
};

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Denormals cost a hundred times a normal number, and Embree asks for this on every thread that traces.
void flush_denormals() {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

/// Embree's filter of hits with what rays may pass.
void drop_passed(const RTCFilterFunctionNArguments *hits) {
    const auto &opacity = *static_cast<const Opacity *>(hits->geometryUserPtr);
    RTCRayN *rays = hits->ray;
    for (unsigned lane = 0; lane < hits->N; ++lane) {
        if (hits->valid[lane] == 0)
            continue;
        const Vector3 origin{RTCRayN_org_x(rays, hits->N, lane), RTCRayN_org_y(rays, hits->N, lane),
                             RTCRayN_org_z(rays, hits->N, lane)};
        const Vector3 direction{RTCRayN_dir_x(rays, hits->N, lane), RTCRayN_dir_y(rays, hits->N, lane),
                                RTCRayN_dir_z(rays, hits->N, lane)};
        if (!opacity.is_met(RTCHitN_primID(hits->hit, hits->N, lane), origin, direction))
            hits->valid[lane] = 0;
    }
}

} // namespace

struct RecordedRays {
    std::vector<RTCRayHit16> extension;
    std::vector<RTCRay16> shadow;
    std::vector<int> extension_lanes, shadow_lanes; // how many lanes of each packet are rays
    bool of_camera = false;
};

struct Tracer::Implementation {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::uint32_t triangles = 0;
    /// Primitives by the geometry and the number that Embree knows them by. Those that rays may pass have geometries of
    /// their own, so that hits with all others are not asked about.
    enum Geometry : unsigned { opaque_triangles, opaque_spheres, passable_triangles, passable_spheres, geometries };
    std::array<std::vector<std::uint32_t>, 2> numbers; ///< of the opaque ones; empty: in the scene's order
    std::array<Opacity, 2> passable;
    bool some_are_passable = false;
    std::atomic<long long> bytes{0};
    tbb::task_arena arena;
    RayOrder extension_order = RayOrder::cell, shadow_order = RayOrder::cell;
    bool coherent = false; ///< packets are traced as beams
    std::array<float, 3> low{}, high{};

    tbb::enumerable_thread_specific<RayOrdering> orderings{[this] { return RayOrdering(low, high); }};

    std::size_t record_interval = 0, calls = 0;
    std::vector<std::vector<RecordedRays>> recorded; // by call, then by task, in the order of the rows

    ~Implementation() {
        if (scene)
            rtcReleaseScene(scene);
        if (device)
            rtcReleaseDevice(device);
    }

    void check(const char *doing) {
        const RTCError error = rtcGetDeviceError(device);
        if (error == RTC_ERROR_OUT_OF_MEMORY)
            throw Error(ExitCode::device, fmt::format("{}: out of memory", doing));
        if (error != RTC_ERROR_NONE)
            throw Error(ExitCode::failure, fmt::format("{}: Embree error {}", doing, static_cast<int>(error)));
    }

    template <class Element>
    Element *new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t count) {
        // Embree reads 16 bytes at each vertex, so it wants padding after the last.
        void *data = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(Element), count);
        check("allocating geometry");
        return static_cast<Element *>(data);
    }

    void add_geometry(const Scene &s);
    void add_triangles(const Scene &s, Geometry place);
    void add_spheres(const Scene &s, Geometry place);
    /// Says which primitive of the scene comes next in a geometry.
    void name(const Scene &s, const Shape &shape, std::size_t triangle, std::uint32_t number, Geometry place);
    void attach(RTCGeometry geometry, Geometry place);
    std::uint64_t trace_extension(const RayColumns &ray, const RowLines &chunk_rows, bool of_camera,
                                  RecordedRays *record);
    std::uint64_t trace_shadow(const ShadowColumns &shadow, const RowLines &chunk_rows, RecordedRays *record);
    /// Runs task(0) to task(count - 1) on the threads that trace.
    template <class Task>
    void run(std::size_t count, const Task &task) {
        arena.execute([&] {
            tbb::parallel_for(
                std::size_t(0), count,
                [&](std::size_t number) {
                    flush_denormals();
                    task(number);
                },
                tbb::simple_partitioner());
        });
    }
    bool beams(RayOrder order) const { return coherent && order != RayOrder::none; }
    /// Rays of a camera are alike in whatever scene, and in order as they come but for their octants.
    bool camera_beams() const { return !coherent && !some_are_passable; }
    std::uint32_t primitive_of(unsigned geometry, unsigned primitive) const {
        if (geometry >= passable_triangles)
            return geometry < geometries ? passable[geometry - passable_triangles].primitive(primitive) : ray_escaped;
        const std::vector<std::uint32_t> &named = numbers[geometry];
        return !named.empty() ? named[primitive] : geometry == opaque_triangles ? primitive : triangles + primitive;
    }
};

/// Calls visit(shape, number of its first primitive) for the shapes of that kind that are passable, or those that
/// aren't.
template <class Visit>
void for_each_shape(const Scene &s, Shape::Kind kind, std::uint32_t first, bool are_passable, Visit visit) {
    for (const Shape &shape : s.shapes) {
        if (shape.kind != kind)
            continue;
        if (is_passable(s, shape) == are_passable)
            visit(shape, first);
        first += kind == Shape::Kind::sphere ? 1u : std::uint32_t(s.meshes[shape.geometry].triangles.size());
    }
}

void Tracer::Implementation::attach(RTCGeometry geometry, Geometry place) {
    rtcSetGeometryMask(geometry, 0xFFFFFFFFu);
    if (place >= passable_triangles) {
        rtcSetGeometryUserData(geometry, &passable[place - passable_triangles]);
        rtcSetGeometryIntersectFilterFunction(geometry, drop_passed);
        rtcSetGeometryOccludedFilterFunction(geometry, drop_passed);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, place);
    rtcReleaseGeometry(geometry);
    check("building geometry");
}

void Tracer::Implementation::name(const Scene &s, const Shape &shape, std::size_t triangle, std::uint32_t number,
                                  Geometry place) {
    if (place >= passable_triangles)
        passable[place - passable_triangles].add(s, shape, triangle, number);
    else if (some_are_passable)
        numbers[place].push_back(number);
}

void Tracer::Implementation::add_triangles(const Scene &s, Geometry place) {
    const auto for_each_mesh = [&](auto visit) {
        for_each_shape(s, Shape::Kind::mesh, 0, place == passable_triangles,
                       [&](const Shape &shape, std::uint32_t first) { visit(shape, s.meshes[shape.geometry], first); });
    };
    std::size_t vertex_count = 0, triangle_count = 0;
    for_each_mesh([&](const Shape &, const Mesh &mesh, std::uint32_t) {
        vertex_count += mesh.positions.size();
        triangle_count += mesh.triangles.size();
    });
    if (triangle_count == 0)
        return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *vertices = new_buffer<Vector3>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, vertex_count);
    auto *indices =
        new_buffer<std::array<std::uint32_t, 3>>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangle_count);
    std::uint32_t first_vertex = 0;
    for_each_mesh([&](const Shape &shape, const Mesh &mesh, std::uint32_t number) {
        vertices = std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto &t = mesh.triangles[i];
            *indices++ = {first_vertex + t[0], first_vertex + t[1], first_vertex + t[2]};
            name(s, shape, i, number + std::uint32_t(i), place);
        }
        first_vertex += static_cast<std::uint32_t>(mesh.positions.size());
    });
    attach(geometry, place);
}

void Tracer::Implementation::add_spheres(const Scene &s, Geometry place) {
    const auto for_each_sphere = [&](auto visit) {
        for_each_shape(s, Shape::Kind::sphere, triangles, place == passable_spheres, visit);
    };
    std::size_t count = 0;
    for_each_sphere([&](const Shape &, std::uint32_t) { ++count; });
    if (count == 0)
        return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto *vertices = new_buffer<std::array<float, 4>>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, count);
    for_each_sphere([&](const Shape &shape, std::uint32_t number) {
        const Sphere &sphere = s.spheres[shape.geometry];
        *vertices++ = {sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius};
        name(s, shape, 0, number, place);
    });
    attach(geometry, place);
}

void Tracer::Implementation::add_geometry(const Scene &s) {
    std::size_t vertex_count = 0, triangle_count = 0;
    for (const Shape &shape : s.shapes) {
        some_are_passable |= is_passable(s, shape);
        if (shape.kind == Shape::Kind::mesh) {
            vertex_count += s.meshes[shape.geometry].positions.size();
            triangle_count += s.meshes[shape.geometry].triangles.size();
        }
    }
    if (triangle_count + s.spheres.size() >= ray_first_special || vertex_count >= 0xFFFFFFFFu)
        throw Error(ExitCode::scene, "the scene has more primitives than 32-bit indices can name");
    triangles = static_cast<std::uint32_t>(triangle_count);
    add_triangles(s, opaque_triangles);
    add_spheres(s, opaque_spheres);
    add_triangles(s, passable_triangles);
    add_spheres(s, passable_spheres);
}

Tracer::Tracer(const Scene &s, int threads) : implementation_(std::make_unique<Implementation>()) {
    Implementation &i = *implementation_;
    flush_denormals();
    i.arena.initialize(threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
    i.device = rtcNewDevice(threads > 0 ? fmt::format("threads={},set_affinity=0", threads).c_str() : nullptr);
    if (!i.device)
        throw rtcGetDeviceError(nullptr) == RTC_ERROR_UNSUPPORTED_CPU
            ? Error(ExitCode::failure, "Embree does not start on this processor")
            : Error(ExitCode::device,
                    "Embree does not start: there is not enough memory, or there are too many threads");
    rtcSetDeviceMemoryMonitorFunction(
        i.device,
        [](void *user, ssize_t bytes, bool) {
            static_cast<std::atomic<long long> *>(user)->fetch_add(bytes);
            return true;
        },
        &i.bytes);
    i.scene = rtcNewScene(i.device);
    rtcSetSceneBuildQuality(i.scene, RTC_BUILD_QUALITY_HIGH);
    i.add_geometry(s);
    i.arena.execute([&] { rtcCommitScene(i.scene); });
    i.check("building the acceleration structure");
    RTCBounds bounds;
    rtcGetSceneBounds(i.scene, &bounds);
    i.low = {bounds.lower_x, bounds.lower_y, bounds.lower_z};
    i.high = {bounds.upper_x, bounds.upper_y, bounds.upper_z};
    i.coherent = i.triangles + s.spheres.size() <= beam_limit;
    // Where packets are no beams, sorting gained nothing on the scenes measured, so they stay as they come.
    if (!i.coherent)
        set_order(RayOrder::none, RayOrder::none);
}

Tracer::~Tracer() = default;

void Tracer::set_order(RayOrder extension, RayOrder shadow) {
    implementation_->extension_order = extension;
    implementation_->shadow_order = shadow;
}

std::size_t Tracer::memory_bytes() const { return static_cast<std::size_t>(implementation_->bytes.load()); }

namespace {

/// What never changes from packet to packet.
template <class Ray>
void prepare(Ray &ray) {
    for (int lane = 0; lane < width; ++lane) {
        ray.tnear[lane] = 0;
        ray.time[lane] = 0;
        ray.mask[lane] = 0xFFFFFFFFu;
        ray.id[lane] = 0;
        ray.flags[lane] = 0;
    }
}

/// Where the columns of a packet's origins and directions are.
struct SegmentLanes {
    float *origin[3], *direction[3];
};

/// One column. Nothing overlaps, which the compiler must know to store the lanes as one vector.
__attribute__((always_inline)) inline void gather(const float *__restrict column, const std::uint32_t *__restrict rows,
                                                  float *__restrict lanes) {
    for (int lane = 0; lane < width; ++lane)
        lanes[lane] = column[rows[lane]];
}

GRADUS_CLONES void gather_segments(const SegmentColumns &rays, const std::uint32_t *rows, const SegmentLanes &lanes) {
    for (int axis = 0; axis < 3; ++axis) {
        gather(rays.origin[axis], rows, lanes.origin[axis]);
        gather(rays.direction[axis], rows, lanes.direction[axis]);
    }
}

template <class Ray>
void fill(Ray &ray, const SegmentColumns &rays, const std::uint32_t *rows, float far) {
    gather_segments(rays, rows, {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}});
    for (int lane = 0; lane < width; ++lane)
        ray.tfar[lane] = far;
}

Valid first_lanes(int lanes) {
    Valid valid;
    for (int lane = 0; lane < width; ++lane)
        valid.lane[lane] = lane < lanes ? -1 : 0;
    return valid;
}

RTCIntersectContext new_context(bool beams) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = beams ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

/// Calls visit(rows, lanes) for packet after packet of the sorted rows. `rows` has 16 elements, the last repeated past
/// `lanes`. Where packets are traced as beams none spans two octants.
template <class Visit>
void for_each_packet(const std::vector<std::uint32_t> &rows, const std::vector<std::uint32_t> &groups, bool beams,
                     Visit visit) {
    const std::size_t parts = beams ? groups.size() - 1 : 1;
    for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t begin = beams ? groups[part] : 0, end = beams ? groups[part + 1] : rows.size();
        std::size_t i = begin;
        for (; i + width <= end; i += width)
            visit(&rows[i], width);
        if (i < end) {
            std::uint32_t last[width];
            for (std::size_t lane = 0; lane < width; ++lane)
                last[lane] = rows[std::min(i + lane, end - 1)];
            visit(last, static_cast<int>(end - i));
        }
    }
}

} // namespace

std::uint64_t Tracer::Implementation::trace_extension(const RayColumns &ray, const RowLines &chunk_rows, bool of_camera,
                                                      RecordedRays *record) {
    RayOrdering &ordering = orderings.local();
    const std::vector<std::uint32_t> &rows =
        ordering.sort(ray, ray.primitive, ray_pending, chunk_rows, of_camera ? RayOrder::octant : extension_order);
    const bool as_beams = of_camera || beams(extension_order);
    RTCIntersectContext context = new_context(as_beams);
    if (record)
        record->of_camera = of_camera;
    alignas(64) RTCRayHit16 packet;
    prepare(packet.ray);
    for (int lane = 0; lane < width; ++lane)
        packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    for_each_packet(rows, ordering.groups(), as_beams, [&](const std::uint32_t *row, int lanes) {
        fill(packet.ray, ray, row, std::numeric_limits<float>::infinity());
        for (int lane = 0; lane < width; ++lane)
            packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        if (record) {
            record->extension.push_back(packet);
            record->extension_lanes.push_back(lanes);
        }
        const Valid valid = first_lanes(lanes);
        rtcIntersect16(valid.lane, scene, &context, &packet);
        for (int lane = 0; lane < lanes; ++lane)
            ray.primitive[row[lane]] = primitive_of(packet.hit.geomID[lane], packet.hit.primID[lane]);
    });
    return rows.size();
}

std::uint64_t Tracer::Implementation::trace_shadow(const ShadowColumns &shadow, const RowLines &chunk_rows,
                                                   RecordedRays *record) {
    RayOrdering &ordering = orderings.local();
    const std::vector<std::uint32_t> &rows = ordering.sort(shadow, shadow.open, 1, chunk_rows, shadow_order);
    RTCIntersectContext context = new_context(beams(shadow_order));
    alignas(64) RTCRay16 packet;
    prepare(packet);
    for_each_packet(rows, ordering.groups(), beams(shadow_order), [&](const std::uint32_t *row, int lanes) {
        fill(packet, shadow, row, 1.0f);
        if (record) {
            record->shadow.push_back(packet);
            record->shadow_lanes.push_back(lanes);
        }
        const Valid valid = first_lanes(lanes);
        rtcOccluded16(valid.lane, scene, &context, &packet);
        for (int lane = 0; lane < lanes; ++lane)
            shadow.open[row[lane]] = packet.tfar[lane] >= 0 ? 1u : 0u; // Embree writes -infinity
    });
    return rows.size();
}

namespace {

/// Cuts `count` rows into chunks, from row `first` on.
class Chunks {
  public:
    Chunks(const SegmentColumns &columns, std::size_t count, std::size_t first = 0)
        : count_(count), first_(first), line_(columns.line > 0 ? columns.line : count),
          lines_(columns.line > 0 ? 4 : 1), chunk_(chunk / lines_), of_line_((line_ + chunk_ - 1) / chunk_) {}
    std::size_t size() const { return count_ == 0 ? 0 : count_ / (lines_ * line_) * of_line_; }
    RowLines operator[](std::size_t number) const {
        const std::size_t first = first_ + number / of_line_ * lines_ * line_, begin = number % of_line_ * chunk_;
        return {first + begin, first + std::min(begin + chunk_, line_), lines_, line_};
    }

  private:
    std::size_t count_, first_, line_;
    std::uint32_t lines_;
    std::size_t chunk_, of_line_;
};

} // namespace

TraceCounts Tracer::trace(const RayColumns &ray, std::size_t rays, const ShadowColumns &shadow, std::size_t shadows) {
    Implementation &im = *implementation_;
    const bool keep = im.record_interval > 0 && im.calls++ % im.record_interval == 0;
    const std::size_t scattered = im.camera_beams() && ray.line == 0 ? std::min(rays, ray.alike_from) : rays;
    const Chunks ray_chunks(ray, scattered), camera_chunks(ray, rays - scattered, scattered);
    const Chunks shadow_chunks(shadow, shadows);
    const std::size_t scattered_tasks = ray_chunks.size(), extension_tasks = scattered_tasks + camera_chunks.size();
    const std::size_t tasks = extension_tasks + shadow_chunks.size();
    std::vector<RecordedRays> kept(keep ? tasks : 0);
    std::atomic<std::uint64_t> extension_count{0}, shadow_count{0};
    im.run(tasks, [&](std::size_t task) {
        RecordedRays *record = keep ? &kept[task] : nullptr;
        if (task < scattered_tasks)
            extension_count += im.trace_extension(ray, ray_chunks[task], false, record);
        else if (task < extension_tasks)
            extension_count += im.trace_extension(ray, camera_chunks[task - scattered_tasks], true, record);
        else
            shadow_count += im.trace_shadow(shadow, shadow_chunks[task - extension_tasks], record);
    });
    if (keep)
        im.recorded.push_back(std::move(kept));
    return {extension_count, shadow_count};
}

void Tracer::in_parallel(std::size_t count, const std::function<void(std::size_t, std::size_t)> &work) {
    implementation_->run((count + chunk - 1) / chunk,
                         [&](std::size_t task) { work(task * chunk, std::min(count, (task + 1) * chunk)); });
}

void Tracer::record(std::size_t interval) {
    Implementation &im = *implementation_;
    im.record_interval = interval;
    im.calls = 0;
    im.recorded.clear();
}

namespace {

/// Ray `lane` of a packet.
RTCRay ray_of(const RTCRay16 &packet, int lane) {
    RTCRay ray;
    ray.org_x = packet.org_x[lane], ray.org_y = packet.org_y[lane], ray.org_z = packet.org_z[lane];
    ray.dir_x = packet.dir_x[lane], ray.dir_y = packet.dir_y[lane], ray.dir_z = packet.dir_z[lane];
    ray.tnear = packet.tnear[lane], ray.tfar = packet.tfar[lane], ray.time = packet.time[lane];
    ray.mask = packet.mask[lane], ray.id = packet.id[lane], ray.flags = packet.flags[lane];
    return ray;
}

/// Traces the packets, or (`single`) their rays one by one.
void trace_again(RTCScene scene, const RecordedRays &rays, bool extension_beams, bool shadow_beams, bool single) {
    RTCIntersectContext context = new_context(extension_beams);
    for (std::size_t i = 0; i < rays.extension.size(); ++i) {
        const int lanes = rays.extension_lanes[i];
        if (single) {
            for (int lane = 0; lane < lanes; ++lane) {
                RTCRayHit ray;
                ray.ray = ray_of(rays.extension[i].ray, lane);
                ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
                rtcIntersect1(scene, &context, &ray);
            }
        } else {
            alignas(64) RTCRayHit16 packet = rays.extension[i];
            rtcIntersect16(first_lanes(lanes).lane, scene, &context, &packet);
        }
    }
    context = new_context(shadow_beams);
    for (std::size_t i = 0; i < rays.shadow.size(); ++i) {
        const int lanes = rays.shadow_lanes[i];
        if (single) {
            for (int lane = 0; lane < lanes; ++lane) {
                RTCRay ray = ray_of(rays.shadow[i], lane);
                rtcOccluded1(scene, &context, &ray);
            }
        } else {
            alignas(64) RTCRay16 packet = rays.shadow[i];
            rtcOccluded16(first_lanes(lanes).lane, scene, &context, &packet);
        }
    }
}

} // namespace

Replayed Tracer::replay(ReplayedAs as) {
    Implementation &im = *implementation_;
    const bool as_traced = as == ReplayedAs::traced;
    const bool extension_beams = as_traced && im.beams(im.extension_order);
    const bool shadow_beams = as_traced && im.beams(im.shadow_order);
    Replayed result;
    for (const auto &call : im.recorded) {
        for (const RecordedRays &rays : call)
            for (const std::vector<int> *lanes : {&rays.extension_lanes, &rays.shadow_lanes})
                result.rays += std::accumulate(lanes->begin(), lanes->end(), std::uint64_t(0));
        const double start = now();
        im.run(call.size(), [&](std::size_t task) {
            trace_again(im.scene, call[task], extension_beams || (as_traced && call[task].of_camera), shadow_beams,
                        as == ReplayedAs::single);
        });
        result.seconds += now() - start;
    }
    return result;
}

} // namespace gradus
