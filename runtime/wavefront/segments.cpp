#include "runtime/wavefront/segments.h"

#include "runtime/error.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

namespace gradus {

namespace {

/// The columns of a table that the tracer reads or writes, on the host: where they lie, or, where mapping would copy
/// the whole table to and fro, copies of the rows that are asked for. The answers of copies go back when this ends.
class HostColumns {
  public:
    /// `copy`: where the copies are to be; made large enough. They may be read after arrive(). With Wait::later,
    /// mappings made after this one are what is waited for.
    HostColumns(Device &device, const SegmentTable &places, Precision precision, Wait wait,
                std::unique_ptr<HostMemory> &copy)
        : table_(*places.table), bytes_(places.count * real_bytes(precision)),
          pitch_(places.rows * real_bytes(precision)) {
        if (device.description().shares_memory) {
            mapping_.emplace(table_, Access::read_write, wait);
            return;
        }
        for (int axis = 0; axis < 3; ++axis) {
            copied_.push_back(places.origin + axis);
            copied_.push_back(places.direction + axis);
        }
        for (const int answer : {places.answer, places.instance, places.opacity})
            if (answer >= 0) {
                answers_.push_back(answer);
                copied_.push_back(answer);
            }
        std::ranges::sort(copied_);
        if (!copy || copy->bytes() < copied_.size() * bytes_) {
            const std::size_t room = std::max(copied_.size() * bytes_, copy ? 2 * copy->bytes() : 0);
            copy.reset();
            copy = std::make_unique<HostMemory>(device, room);
        }
        copy_ = copy->data();
        // Columns that are neighbours go together.
        for (std::size_t begin = 0, end; begin < copied_.size(); begin = end) {
            for (end = begin + 1; end < copied_.size() && copied_[end] == copied_[end - 1] + 1;)
                ++end;
            readings_.push_back(table_.start_read(copy_ + begin * bytes_, stripes(copied_[begin], end - begin)));
        }
    }
    void arrive() {
        for (Buffer::Reading &reading : readings_)
            reading.wait();
    }
    ~HostColumns() {
        try {
            for (const int answer : answers_)
                table_.start_write((*this)[answer], stripes(answer, 1));
        } catch (const Error &) {
            // Nothing can be done here; the next call on the queue reports the error.
        }
    }
    HostColumns(const HostColumns &) = delete;
    HostColumns &operator=(const HostColumns &) = delete;

    char *operator[](int column) const {
        return mapping_ ? mapping_->as<char>() + std::size_t(column) * pitch_
                        : copy_ + std::size_t(std::ranges::find(copied_, column) - copied_.begin()) * bytes_;
    }

  private:
    Stripes stripes(int first, std::size_t count) const { return {pitch_, std::size_t(first), count, bytes_}; }

    const Buffer &table_;
    std::size_t bytes_, pitch_; ///< of the rows that are asked for, in a column; of a column of the table
    std::optional<Buffer::Mapping> mapping_;
    std::vector<int> copied_, answers_;
    std::vector<Buffer::Reading> readings_;
    char *copy_ = nullptr;
};

/// Rows of a table as the tracer takes them, in float. Those of a double table are copied, for Embree traces in float,
/// and the answers go back when this ends.
class Segments {
  public:
    Segments(const HostColumns &host, const SegmentTable &places, Precision precision)
        : is_double_(precision == Precision::double_), rows_(places.count) {
        columns.line = places.line;
        columns.alike_from = places.alike_from;
        for (int axis = 0; axis < 3; ++axis) {
            columns.origin[axis] = reals(origin_[axis], host[places.origin + axis]);
            columns.direction[axis] = reals(direction_[axis], host[places.direction + axis]);
        }
        answer = numbers(answer_, host[places.answer]);
        if (places.instance >= 0)
            instance = numbers(instance_, host[places.instance]);
        if (places.opacity >= 0)
            opacity = numbers(opacity_, host[places.opacity]);
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
    const float *reals(std::vector<float> &copy, const char *column) const {
        if (!is_double_)
            return reinterpret_cast<const float *>(column);
        const auto *from = reinterpret_cast<const double *>(column);
        copy.assign(from, from + rows_);
        return copy.data();
    }
    std::uint32_t *numbers(Answers &copy, char *column) const {
        auto *const from = reinterpret_cast<std::uint32_t *>(column);
        return is_double_ ? copy.take(from, rows_) : from;
    }
    bool is_double_;
    std::size_t rows_;
    std::vector<float> origin_[3], direction_[3];
    Answers answer_, instance_, opacity_;
};

} // namespace

SegmentTracer::SegmentTracer(Device &device, Tracer &tracer, Precision precision)
    : device_(device), tracer_(tracer), precision_(precision) {}

TraceCounts SegmentTracer::trace(const SegmentTable &rays, const SegmentTable &segments) {
    if (rays.count == 0 && segments.count == 0)
        return {};
    std::optional<HostColumns> rays_on_host, segments_on_host;
    if (rays.count > 0)
        rays_on_host.emplace(device_, rays, precision_, segments.count > 0 ? Wait::later : Wait::now, ray_copy_);
    if (segments.count > 0)
        segments_on_host.emplace(device_, segments, precision_, Wait::now, segment_copy_);
    for (std::optional<HostColumns> *columns : {&rays_on_host, &segments_on_host})
        if (*columns)
            (*columns)->arrive();
    std::optional<Segments> ray_view, segment_view;
    RayColumns ray{};
    ShadowColumns segment{};
    if (rays_on_host) {
        ray_view.emplace(*rays_on_host, rays, precision_);
        ray = {ray_view->columns, ray_view->answer, ray_view->instance, ray_view->opacity};
    }
    if (segments_on_host) {
        segment_view.emplace(*segments_on_host, segments, precision_);
        segment = {segment_view->columns, segment_view->answer};
    }
    const auto start = std::chrono::steady_clock::now();
    const TraceCounts counts = tracer_.trace(ray, rays.count, segment, segments.count);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return counts;
}

} // namespace gradus
