#include "runtime/trace/tracer.h"

#include "runtime/seconds_since.h"
#include "runtime/trace/embree_scene.h"
#include "runtime/trace/flush_denormals.h"
#include "runtime/trace/ray_packets.h"
#include "runtime/trace/recorded_rays.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <limits>
#include <thread>

// After all others: its short macro names are not for library headers.
#include "kernels/shared/tables.h"

namespace gradus {

namespace {

constexpr std::size_t chunk = 4096; // rows a task: small enough to balance, large enough to sort
// Embree's coherent traversal tests a packet as one beam. On sorted rays it is twice as fast as the other in a scene of
// some dozens of primitives, where a cell of origins sees few of them, and half as fast in one of thousands.
// Nor is it for instances: Embree 3.13 then loops for ever on some packets of shadow rays (tests/methods/
// instances_test.cpp, by gpt).
constexpr std::size_t beam_limit = 256;

/// Of a triangle's barycentrics. On an edge, both triangles are as near, and which one is found depends on the order in
/// which a packet visits them, and so on its other rays. Rays so near to an edge are traced again, each by itself.
constexpr float edge = 1e-4f;

/// A bit for each of the first `lanes`.
std::uint32_t lanes_near_edges(const RTCRayHit16 &packet, int lanes) {
    std::uint32_t near = 0;
    for (int lane = 0; lane < packet_width; ++lane) {
        const float u = packet.hit.u[lane], v = packet.hit.v[lane];
        const bool is_near = std::min(std::min(u, v), 1 - u - v) < edge;
        near |= std::uint32_t(is_near && EmbreeScene::is_triangle(packet.hit.instID[0][lane], packet.hit.geomID[lane]))
                << lane;
    }
    return near & ((1u << lanes) - 1);
}

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

struct Tracer::Implementation {
    /// More threads than the machine runs at once gain nothing, and TBB would complain of them.
    Implementation(const Scene &s, int wanted_threads, const SceneTables *tables)
        : threads(std::min(wanted_threads, processors())), arena(threads > 0 ? threads : processors()),
          scene(s, threads, arena, tables), coherent(scene.primitives() <= beam_limit && !scene.has_instances()) {}

    static int processors() { return int(std::max(1u, std::thread::hardware_concurrency())); }

    int threads; ///< 0: all
    tbb::task_arena arena;
    EmbreeScene scene;
    RayOrder extension_order = RayOrder::cell, shadow_order = RayOrder::cell;
    bool coherent; ///< packets are traced as beams
    tbb::enumerable_thread_specific<RayOrdering> orderings{[this] { return RayOrdering(scene.low(), scene.high()); }};

    std::size_t record_interval = 0, calls = 0;
    std::vector<std::vector<RecordedRays>> recorded; // by call, then by task, in the order of the rows

    std::uint64_t trace_extension(const RayColumns &ray, const RowLines &chunk_rows, bool of_camera,
                                  RecordedRays *record) {
        return trace_asked(ray, ray_pending, chunk_rows, of_camera, record) +
               (scene.hides_emitters() ? trace_asked(ray, ray_unhindered, chunk_rows, of_camera, record) : 0);
    }
    /// Those of the rows that ask for it so.
    std::uint64_t trace_asked(const RayColumns &ray, std::uint32_t asked, const RowLines &chunk_rows, bool of_camera,
                              RecordedRays *record);
    /// Finds again what these lanes of the packet have met, as if each were alone.
    void trace_alone(RTCRayHit16 &packet, std::uint32_t lanes, TraceContext &context) const;
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
    bool camera_beams() const { return !coherent && !scene.some_are_passable() && !scene.has_instances(); }
};

Tracer::Tracer(const Scene &s, int threads, const SceneTables *tables)
    : implementation_(std::make_unique<Implementation>(s, threads, tables)) {
    // Where packets are no beams, cells gain nothing; octants 1 to 5 % of a render in scenes of a thousand triangles,
    // nothing in larger ones.
    if (!implementation_->coherent)
        set_order(RayOrder::octant, RayOrder::octant);
}

Tracer::~Tracer() = default;

void Tracer::set_order(RayOrder extension, RayOrder shadow) {
    implementation_->extension_order = extension;
    implementation_->shadow_order = shadow;
}

std::size_t Tracer::memory_bytes() const { return implementation_->scene.memory_bytes(); }

void Tracer::Implementation::trace_alone(RTCRayHit16 &packet, std::uint32_t lanes, TraceContext &context) const {
    for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        ValidLanes alone{};
        alone.lane[lane] = -1;
        packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
        packet.hit.geomID[lane] = packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        intersect(alone.lane, scene.handle(), context.embree, packet);
    }
}

std::uint64_t Tracer::Implementation::trace_asked(const RayColumns &ray, std::uint32_t asked,
                                                  const RowLines &chunk_rows, bool of_camera, RecordedRays *record) {
    RayOrdering &ordering = orderings.local();
    const std::vector<std::uint32_t> &rows =
        ordering.sort(ray, ray.primitive, asked, chunk_rows, of_camera ? RayOrder::octant : extension_order);
    const bool as_beams = of_camera || beams(extension_order);
    TraceContext context(as_beams, ray);
    context.passes_emitters = asked == ray_unhindered;
    context.without_chance = ray.without_chance;
    if (record)
        record->of_camera = of_camera;
    alignas(64) RTCRayHit16 packet;
    prepare_packet(packet.ray);
    const auto opacity_of = [&](int lane, std::uint32_t number) {
        return scene.opacity_of(packet.hit.instID[0][lane], packet.hit.geomID[lane], packet.hit.primID[lane],
                                axis_values(ray.origin, number), axis_values(ray.direction, number));
    };
    for_each_packet(rows, ordering.groups(), as_beams, [&](const std::uint32_t *row, int lanes) {
        fill_packet(packet.ray, ray, row, std::numeric_limits<float>::infinity());
        for (int lane = 0; lane < packet_width; ++lane)
            packet.hit.geomID[lane] = packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        context.rows = row;
        if (record) {
            record->extension.push_back(packet);
            record->extension_lanes.push_back(lanes);
        }
        const ValidLanes valid = sane_lanes(packet.ray, lanes);
        intersect(valid.lane, scene.handle(), context.embree, packet);
        if (const std::uint32_t near_edges = lanes_near_edges(packet, lanes))
            trace_alone(packet, near_edges, context);
        for (int lane = 0; lane < lanes; ++lane) {
            const unsigned geometry = packet.hit.geomID[lane], instance = packet.hit.instID[0][lane];
            ray.primitive[row[lane]] = geometry == RTC_INVALID_GEOMETRY_ID
                                           ? ray_escaped
                                           : scene.primitive_of(instance, geometry, packet.hit.primID[lane]);
            if (geometry == RTC_INVALID_GEOMETRY_ID)
                continue;
            if (ray.instance)
                ray.instance[row[lane]] = scene.instance_record(instance);
            if (ray.opacity)
                ray.opacity[row[lane]] = std::uint32_t(double(ray_opacity_one) * opacity_of(lane, row[lane]));
            if (ray.without_chance && opacity_of(lane, row[lane]) < 1)
                ray.primitive[row[lane]] = ray_none;
        }
    });
    return rows.size();
}

std::uint64_t Tracer::Implementation::trace_shadow(const ShadowColumns &shadow, const RowLines &chunk_rows,
                                                   RecordedRays *record) {
    RayOrdering &ordering = orderings.local();
    const std::vector<std::uint32_t> &rows = ordering.sort(shadow, shadow.open, 1, chunk_rows, shadow_order);
    TraceContext context(beams(shadow_order), shadow);
    alignas(64) RTCRay16 packet;
    prepare_packet(packet);
    for_each_packet(rows, ordering.groups(), beams(shadow_order), [&](const std::uint32_t *row, int lanes) {
        fill_packet(packet, shadow, row, 1.0f);
        if (record) {
            record->shadow.push_back(packet);
            record->shadow_lanes.push_back(lanes);
        }
        const ValidLanes valid = sane_lanes(packet, lanes);
        context.rows = row;
        occlude(valid.lane, scene.handle(), context.embree, packet);
        for (int lane = 0; lane < lanes; ++lane) // Embree writes -infinity
            shadow.open[row[lane]] = packet.tfar[lane] >= 0 && valid.lane[lane] != 0 ? 1u : 0u;
    });
    return rows.size();
}

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

Replayed Tracer::replay(ReplayedAs as) {
    Implementation &im = *implementation_;
    const bool as_traced = as == ReplayedAs::traced;
    const bool extension_beams = as_traced && im.beams(im.extension_order);
    const bool shadow_beams = as_traced && im.beams(im.shadow_order);
    Replayed result;
    for (const auto &call : im.recorded) {
        for (const RecordedRays &rays : call)
            result.rays += rays.count();
        const auto start = std::chrono::steady_clock::now();
        im.run(call.size(), [&](std::size_t task) {
            trace_again(im.scene.handle(), call[task], extension_beams || (as_traced && call[task].of_camera),
                        shadow_beams, as == ReplayedAs::single);
        });
        result.seconds += seconds_since(start);
    }
    return result;
}

} // namespace gradus
