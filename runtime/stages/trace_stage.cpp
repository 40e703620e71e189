#include "runtime/stages/trace_stage.h"

#include "kernels/shared/tables.h"

#include <chrono>
#include <optional>
#include <vector>

namespace gradus {

using namespace lib_float;

namespace {

/// Where a table has what the tracer reads and answers: the first column of the origin and of the direction.
struct SegmentPlaces {
    int origin, direction, answer;
};

/// Rows of a table as the tracer takes them, in float. The columns of a float table are used where they lie. Those of a
/// double table are copied, for Embree traces in float, and the answers go back when this ends.
class Segments {
  public:
    /// With Wait::later, others made after this one are what is waited for.
    Segments(const Buffer &table, std::size_t capacity, std::size_t rows, const SegmentPlaces &places,
             Precision precision, Wait wait)
        : view_(table.map(Access::read_write, precision == Precision::double_ ? Wait::now : wait)), rows_(rows) {
        if (precision != Precision::double_) {
            float *reals = view_.as<float>();
            for (int axis = 0; axis < 3; ++axis) {
                columns.origin[axis] = reals + (places.origin + axis) * capacity;
                columns.direction[axis] = reals + (places.direction + axis) * capacity;
            }
            answer = reinterpret_cast<std::uint32_t *>(reals + places.answer * capacity);
            return;
        }
        const double *reals = view_.as<double>();
        for (int axis = 0; axis < 3; ++axis) {
            columns.origin[axis] = copy(origin_[axis], reals + (places.origin + axis) * capacity);
            columns.direction[axis] = copy(direction_[axis], reals + (places.direction + axis) * capacity);
        }
        wide_answer_ = view_.as<std::uint32_t>() + 2 * places.answer * capacity;
        answer_.resize(rows);
        for (std::size_t row = 0; row < rows; ++row)
            answer_[row] = wide_answer_[2 * row];
        answer = answer_.data();
    }
    ~Segments() {
        for (std::size_t row = 0; row < answer_.size(); ++row)
            wide_answer_[2 * row] = answer_[row];
    }
    Segments(const Segments &) = delete;
    Segments &operator=(const Segments &) = delete;

    SegmentColumns columns;
    std::uint32_t *answer;

  private:
    const float *copy(std::vector<float> &to, const double *from) const {
        to.assign(from, from + rows_);
        return to.data();
    }
    Buffer::Mapping view_;
    std::size_t rows_;
    std::vector<float> origin_[3], direction_[3];
    std::vector<std::uint32_t> answer_;
    std::uint32_t *wide_answer_ = nullptr; ///< of a double table: every other one
};

TraceCounts trace(Tracer &tracer, const RayColumns &rays, std::size_t ray_count, const ShadowColumns &shadows,
                  std::size_t shadow_count, double &trace_seconds) {
    const auto start = std::chrono::steady_clock::now();
    const TraceCounts counts = tracer.trace(rays, ray_count, shadows, shadow_count);
    trace_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return counts;
}

} // namespace

TraceCounts run_trace_stage(Tracer &tracer, const BatchTables &tables, std::uint32_t rays, std::uint32_t shadows,
                            double &trace_seconds) {
    const Segments ray(tables.ray, tables.capacity, rays, {ray_origin_x, ray_direction_x, ray_primitive},
                       tables.precision, shadows > 0 ? Wait::later : Wait::now);
    if (shadows == 0)
        return trace(tracer, {ray.columns, ray.answer}, rays, ShadowColumns{}, 0, trace_seconds);
    const Segments shadow(tables.shadow, tables.capacity, shadows, {shadow_origin_x, shadow_direction_x, shadow_open},
                          tables.precision, Wait::now);
    return trace(tracer, {ray.columns, ray.answer}, rays, {shadow.columns, shadow.answer}, shadows, trace_seconds);
}

std::uint64_t run_offset_stage(Tracer &tracer, const Buffer &link, std::uint32_t links, const Buffer *offset_ray,
                               std::uint32_t rays, std::uint32_t capacity, Precision precision, double &trace_seconds) {
    if (links == 0 && rays == 0)
        return 0;
    std::optional<Segments> ray_view;
    RayColumns ray{};
    if (rays > 0) {
        ray_view.emplace(*offset_ray, 4 * std::size_t(capacity), rays,
                         SegmentPlaces{offset_ray_origin_x, offset_ray_direction_x, offset_ray_primitive}, precision,
                         Wait::later);
        ray = {ray_view->columns, ray_view->answer};
    }
    const Segments link_view(link, 8 * std::size_t(capacity), links, {link_origin_x, link_direction_x, link_open},
                             precision, Wait::now);
    const TraceCounts counts = trace(tracer, ray, rays, {link_view.columns, link_view.answer}, links, trace_seconds);
    return counts.extension + counts.shadow;
}

} // namespace gradus
