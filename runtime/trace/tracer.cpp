#include "runtime/trace/tracer.h"

#include "runtime/error.h"
#include "runtime/trace/ray_order.h"

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
#include <thread>

// After all others: its short macro names are not for library headers.
#include "kernels/shared/tables.h"

namespace gradus {

namespace {

constexpr int width = 16;           // rays a packet
constexpr std::size_t chunk = 8192; // rows a task: small enough to balance, large enough to sort

struct alignas(64) Valid {
    int lane[width];
};

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Denormals cost a hundred times a normal number, and Embree asks for this on every thread that traces.
void flush_denormals() {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

} // namespace

struct RecordedRays {
    std::vector<RTCRayHit16> extension;
    std::vector<RTCRay16> shadow;
    std::vector<int> extension_lanes, shadow_lanes; // how many lanes of each packet are rays
};

struct Tracer::Implementation {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::uint32_t triangles = 0;
    std::atomic<long long> bytes{0};
    tbb::task_arena arena;
    RayOrder extension_order = RayOrder::cell, shadow_order = RayOrder::cell;
    std::array<float, 3> low{}, high{};

    /// What a thread needs while it works on a chunk.
    struct Scratch {
        std::vector<std::uint32_t> rows;
        RayOrdering ordering;
    };
    tbb::enumerable_thread_specific<Scratch> scratch;

    std::size_t record_interval = 0, calls = 0;
    double recorded_seconds = 0;
    struct Chunk {
        RecordedRays rays;
    };
    std::vector<std::vector<Chunk>> recorded; // by call, then by task, in the order of the rows

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

    void add_triangles(const Scene &s);
    void add_spheres(const Scene &s);
    void trace_extension(const RayColumns &ray, std::size_t begin, std::size_t end, Scratch &own, std::uint64_t &count,
                         RecordedRays *record);
    void trace_shadow(const ShadowColumns &shadow, std::size_t begin, std::size_t end, Scratch &own,
                      std::uint64_t &count, RecordedRays *record);
    std::uint32_t primitive_of(unsigned geometry, unsigned primitive) const {
        return geometry == RTC_INVALID_GEOMETRY_ID ? ray_escaped : geometry == 0 ? primitive : triangles + primitive;
    }
};

void Tracer::Implementation::add_triangles(const Scene &s) {
    std::size_t vertex_count = 0, triangle_count = 0;
    for (const Shape &shape : s.shapes)
        if (shape.kind == Shape::Kind::mesh) {
            vertex_count += s.meshes[shape.geometry].positions.size();
            triangle_count += s.meshes[shape.geometry].triangles.size();
        }
    if (triangle_count + s.spheres.size() >= ray_first_special || vertex_count >= 0xFFFFFFFFu)
        throw Error(ExitCode::scene, "the scene has more primitives than 32-bit indices can name");
    triangles = static_cast<std::uint32_t>(triangle_count);
    if (triangle_count == 0)
        return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *vertices = new_buffer<Vector3>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, vertex_count);
    auto *indices = new_buffer<std::array<std::uint32_t, 3>>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                                             triangle_count);
    std::uint32_t first = 0;
    for (const Shape &shape : s.shapes) {
        if (shape.kind != Shape::Kind::mesh)
            continue;
        const Mesh &mesh = s.meshes[shape.geometry];
        vertices = std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
        for (const auto &t : mesh.triangles)
            *indices++ = {first + t[0], first + t[1], first + t[2]};
        first += static_cast<std::uint32_t>(mesh.positions.size());
    }
    rtcSetGeometryMask(geometry, 0xFFFFFFFFu);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, 0);
    rtcReleaseGeometry(geometry);
    check("building the triangles");
}

void Tracer::Implementation::add_spheres(const Scene &s) {
    std::size_t count = 0;
    for (const Shape &shape : s.shapes)
        count += shape.kind == Shape::Kind::sphere ? 1 : 0;
    if (count == 0)
        return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto *vertices = new_buffer<std::array<float, 4>>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, count);
    for (const Shape &shape : s.shapes)
        if (shape.kind == Shape::Kind::sphere) {
            const Sphere &sphere = s.spheres[shape.geometry];
            *vertices++ = {sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius};
        }
    rtcSetGeometryMask(geometry, 0xFFFFFFFFu);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, 1);
    rtcReleaseGeometry(geometry);
    check("building the spheres");
}

Tracer::Tracer(const Scene &s, int threads) : implementation_(std::make_unique<Implementation>()) {
    Implementation &i = *implementation_;
    flush_denormals();
    i.arena.initialize(threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
    i.device = rtcNewDevice(threads > 0 ? fmt::format("threads={},set_affinity=0", threads).c_str() : nullptr);
    if (!i.device)
        throw Error(ExitCode::failure, "Embree does not start on this processor");
    rtcSetDeviceMemoryMonitorFunction(
        i.device,
        [](void *user, ssize_t bytes, bool) {
            static_cast<std::atomic<long long> *>(user)->fetch_add(bytes);
            return true;
        },
        &i.bytes);
    i.scene = rtcNewScene(i.device);
    rtcSetSceneBuildQuality(i.scene, getenv("Q")?(RTCBuildQuality)atoi(getenv("Q")):RTC_BUILD_QUALITY_HIGH);
    i.add_triangles(s);
    i.add_spheres(s);
    i.arena.execute([&] { rtcCommitScene(i.scene); });
    i.check("building the acceleration structure");
    RTCBounds bounds;
    rtcGetSceneBounds(i.scene, &bounds);
    i.low = {bounds.lower_x, bounds.lower_y, bounds.lower_z};
    i.high = {bounds.upper_x, bounds.upper_y, bounds.upper_z};
}

Tracer::~Tracer() = default;

void Tracer::set_order(RayOrder extension, RayOrder shadow) {
    implementation_->extension_order = extension;
    implementation_->shadow_order = shadow;
}

std::size_t Tracer::memory_bytes() const { return static_cast<std::size_t>(implementation_->bytes.load()); }

namespace {

/// Fills one lane after the other of the fields that extension and shadow rays share.
template <class Packet, class Columns>
void fill(Packet &packet, const Columns &columns, const std::uint32_t *rows, int lanes, float far) {
    for (int lane = 0; lane < width; ++lane) {
        const std::uint32_t row = rows[lane < lanes ? lane : 0];
        packet.org_x[lane] = columns.origin[0][row];
        packet.org_y[lane] = columns.origin[1][row];
        packet.org_z[lane] = columns.origin[2][row];
        packet.dir_x[lane] = columns.direction[0][row];
        packet.dir_y[lane] = columns.direction[1][row];
        packet.dir_z[lane] = columns.direction[2][row];
        packet.tnear[lane] = 0;
        packet.tfar[lane] = far;
        packet.time[lane] = 0;
        packet.mask[lane] = 0xFFFFFFFFu;
        packet.id[lane] = 0;
        packet.flags[lane] = 0;
    }
}

Valid first_lanes(int lanes) {
    Valid valid;
    for (int lane = 0; lane < width; ++lane)
        valid.lane[lane] = lane < lanes ? -1 : 0;
    return valid;
}

RTCIntersectContext new_context(bool coherent) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = getenv("COH") ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

} // namespace

void Tracer::Implementation::trace_extension(const RayColumns &ray, std::size_t begin, std::size_t end, Scratch &own,
                                             std::uint64_t &count, RecordedRays *record) {
    own.rows.clear();
    for (std::size_t row = begin; row < end; ++row)
        if (ray.primitive[row] == ray_pending)
            own.rows.push_back(static_cast<std::uint32_t>(row));
    if (extension_order != RayOrder::none)
        own.ordering.sort(own.rows, ray.origin, ray.direction, extension_order == RayOrder::cell);
    RTCIntersectContext context = new_context(false);
    for (std::size_t i = 0; i < own.rows.size(); i += width) {
        const int lanes = static_cast<int>(std::min<std::size_t>(width, own.rows.size() - i));
        alignas(64) RTCRayHit16 packet;
        fill(packet.ray, ray, &own.rows[i], lanes, std::numeric_limits<float>::infinity());
        for (int lane = 0; lane < width; ++lane) {
            packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
            packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        if (record) {
            record->extension.push_back(packet);
            record->extension_lanes.push_back(lanes);
        }
        const Valid valid = first_lanes(lanes);
        rtcIntersect16(valid.lane, scene, &context, &packet);
        for (int lane = 0; lane < lanes; ++lane)
            ray.primitive[own.rows[i + lane]] = primitive_of(packet.hit.geomID[lane], packet.hit.primID[lane]);
    }
    count += own.rows.size();
}

void Tracer::Implementation::trace_shadow(const ShadowColumns &shadow, std::size_t begin, std::size_t end, Scratch &own,
                                          std::uint64_t &count, RecordedRays *record) {
    own.rows.clear();
    for (std::size_t row = begin; row < end; ++row)
        if (shadow.open[row])
            own.rows.push_back(static_cast<std::uint32_t>(row));
    if (shadow_order != RayOrder::none)
        own.ordering.sort(own.rows, shadow.origin, shadow.direction, shadow_order == RayOrder::cell);
    RTCIntersectContext context = new_context(false);
    for (std::size_t i = 0; i < own.rows.size(); i += width) {
        const int lanes = static_cast<int>(std::min<std::size_t>(width, own.rows.size() - i));
        alignas(64) RTCRay16 packet;
        fill(packet, shadow, &own.rows[i], lanes, 1.0f);
        if (record) {
            record->shadow.push_back(packet);
            record->shadow_lanes.push_back(lanes);
        }
        const Valid valid = first_lanes(lanes);
        rtcOccluded16(valid.lane, scene, &context, &packet);
        for (int lane = 0; lane < lanes; ++lane)
            shadow.open[own.rows[i + lane]] = packet.tfar[lane] >= 0 ? 1u : 0u; // Embree writes -infinity
    }
    count += own.rows.size();
}

TraceCounts Tracer::trace(const RayColumns &ray, std::size_t rays, const ShadowColumns &shadow, std::size_t shadows) {
    Implementation &im = *implementation_;
    const bool keep = im.record_interval > 0 && im.calls++ % im.record_interval == 0;
    const double start = now();
    const std::size_t extension_tasks = (rays + chunk - 1) / chunk;
    const std::size_t tasks = extension_tasks + (shadows + chunk - 1) / chunk;
    std::vector<Implementation::Chunk> kept(keep ? tasks : 0);
    std::atomic<std::uint64_t> extension_count{0}, shadow_count{0};
    im.arena.execute([&] {
        tbb::parallel_for(
            std::size_t(0), tasks,
            [&](std::size_t task) {
                flush_denormals();
                Implementation::Scratch &own = im.scratch.local();
                own.ordering.set_bounds(im.low, im.high);
                RecordedRays *record = keep ? &kept[task].rays : nullptr;
                std::uint64_t count = 0;
                if (task < extension_tasks) {
                    im.trace_extension(ray, task * chunk, std::min(rays, (task + 1) * chunk), own, count, record);
                    extension_count += count;
                } else {
                    const std::size_t begin = (task - extension_tasks) * chunk;
                    im.trace_shadow(shadow, begin, std::min(shadows, begin + chunk), own, count, record);
                    shadow_count += count;
                }
            },
            tbb::simple_partitioner());
    });
    if (keep) {
        im.recorded_seconds += now() - start;
        im.recorded.push_back(std::move(kept));
    }
    return {extension_count, shadow_count};
}

void Tracer::record(std::size_t interval) {
    Implementation &im = *implementation_;
    im.record_interval = interval;
    im.calls = 0;
    im.recorded.clear();
    im.recorded_seconds = 0;
}

double Tracer::replay(double &recorded_seconds, std::uint64_t &recorded_rays) {
    Implementation &im = *implementation_;
    recorded_seconds = im.recorded_seconds;
    recorded_rays = 0;
    for (const auto &call : im.recorded)
        for (const Implementation::Chunk &part : call) {
            for (int lanes : part.rays.extension_lanes)
                recorded_rays += static_cast<std::uint64_t>(lanes);
            for (int lanes : part.rays.shadow_lanes)
                recorded_rays += static_cast<std::uint64_t>(lanes);
        }
    double seconds = 0;
    for (const auto &call : im.recorded) {
        const double start = now();
        im.arena.execute([&] {
            tbb::parallel_for(
                std::size_t(0), call.size(),
                [&](std::size_t task) {
                    flush_denormals();
                    const RecordedRays &rays = call[task].rays;
                    RTCIntersectContext context = new_context(false);
                    for (std::size_t i = 0; i < rays.extension.size(); ++i) {
                        alignas(64) RTCRayHit16 packet = rays.extension[i];
                        const Valid valid = first_lanes(rays.extension_lanes[i]);
                        rtcIntersect16(valid.lane, im.scene, &context, &packet);
                    }
                    for (std::size_t i = 0; i < rays.shadow.size(); ++i) {
                        alignas(64) RTCRay16 packet = rays.shadow[i];
                        const Valid valid = first_lanes(rays.shadow_lanes[i]);
                        rtcOccluded16(valid.lane, im.scene, &context, &packet);
                    }
                },
                tbb::simple_partitioner());
        });
        seconds += now() - start;
    }
    return seconds;
}

} // namespace gradus
