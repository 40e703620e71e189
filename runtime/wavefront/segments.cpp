#include "runtime/wavefront/segments.h"

#include <chrono>
#include <optional>
#include <vector>

namespace gradus {

namespace {

/// Rows of a table as the tracer takes them, in float. The columns of a float table are used where they lie. Those of a
/// double table are copied, for Embree traces in float, and the answers go back when this ends.
class Segments {
  public:
    /// With Wait::later, others made after this one are what is waited for.
    Segments(const SegmentTable &places, Precision precision, Wait wait)
        : view_(places.table->map(Access::read_write, precision == Precision::double_ ? Wait::now : wait)),
          rows_(places.count) {
        const std::size_t capacity = places.rows, rows = places.count;
        columns.line = places.line;
        columns.alike_from = places.alike_from;
        if (precision != Precision::double_) {
            float *reals = view_.as<float>();
            for (int axis = 0; axis < 3; ++axis) {
                columns.origin[axis] = reals + (places.origin + axis) * capacity;
                columns.direction[axis] = reals + (places.direction + axis) * capacity;
            }
            answer = reinterpret_cast<std::uint32_t *>(reals + places.answer * capacity);
            if (places.instance >= 0)
                instance = reinterpret_cast<std::uint32_t *>(reals + places.instance * capacity);
            if (places.opacity >= 0)
                opacity = reinterpret_cast<std::uint32_t *>(reals + places.opacity * capacity);
            return;
        }
        const double *reals = view_.as<double>();
        for (int axis = 0; axis < 3; ++axis) {
            columns.origin[axis] = copy(origin_[axis], reals + (places.origin + axis) * capacity);
            columns.direction[axis] = copy(direction_[axis], reals + (places.direction + axis) * capacity);
        }
        answer = answer_.take(view_.as<std::uint32_t>() + 2 * places.answer * capacity, rows);
        if (places.instance >= 0)
            instance = instance_.take(view_.as<std::uint32_t>() + 2 * places.instance * capacity, rows);
        if (places.opacity >= 0)
            opacity = opacity_.take(view_.as<std::uint32_t>() + 2 * places.opacity * capacity, rows);
    }
    Segments(const Segments &) = delete;
    Segments &operator=(const Segments &) = delete;

    SegmentColumns columns{};
    std::uint32_t *answer, *instance = nullptr, *opacity = nullptr;

  private:
    /// A column of answers of a double table, where every other number is one: copied, and put back at the end.
    struct Answers {
        std::uint32_t *take(std::uint32_t *from, std::size_t rows) {
            wide = from;
            values.resize(rows);
            for (std::size_t row = 0; row < rows; ++row)
                values[row] = wide[2 * row];
            return values.data();
        }
        ~Answers() {
            for (std::size_t row = 0; row < values.size(); ++row)
                wide[2 * row] = values[row];
        }
        std::uint32_t *wide = nullptr;
        std::vector<std::uint32_t> values;
    };
    const float *copy(std::vector<float> &to, const double *from) const {
        to.assign(from, from + rows_);
        return to.data();
    }
    Buffer::Mapping view_;
    std::size_t rows_;
    std::vector<float> origin_[3], direction_[3];
    Answers answer_, instance_, opacity_;
};

} // namespace

TraceCounts trace_segments(Tracer &tracer, Precision precision, const SegmentTable &rays, const SegmentTable &segments,
                           double &seconds) {
    std::optional<Segments> ray_view, segment_view;
    RayColumns ray{};
    ShadowColumns segment{};
    if (rays.count > 0) {
        ray_view.emplace(rays, precision, segments.count > 0 ? Wait::later : Wait::now);
        ray = {ray_view->columns, ray_view->answer, ray_view->instance, ray_view->opacity};
    }
    if (segments.count > 0) {
        segment_view.emplace(segments, precision, Wait::now);
        segment = {segment_view->columns, segment_view->answer};
    }
    if (rays.count == 0 && segments.count == 0)
        return {};
    const auto start = std::chrono::steady_clock::now();
    const TraceCounts counts = tracer.trace(ray, rays.count, segment, segments.count);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return counts;
}

} // namespace gradus
