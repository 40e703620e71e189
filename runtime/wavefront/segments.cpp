#include "runtime/wavefront/segments.h"

#include "runtime/seconds_since.h"
#include "runtime/wavefront/table.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <vector>

namespace gradus {

namespace {

/// The host's own memory takes all rows at once; elsewhere the rows of one part are traced while others are copied.
constexpr std::uint32_t most_parts = 4, least_part = 1u << 15;

std::vector<Range> parts_of(const SegmentTable &places) {
    // Lines that lie side by side stay together: four (SegmentColumns::line).
    const std::uint32_t unit = places.line > 0 ? 4 * places.line : 1;
    const std::uint32_t least = std::max((places.count + most_parts - 1) / most_parts, least_part);
    const std::uint32_t part = (least + unit - 1) / unit * unit;
    std::vector<Range> parts;
    for (std::uint32_t first = 0; first < places.count; first += part)
        parts.push_back({first, std::min(part, places.count - first)});
    return parts;
}

/// What is traced together.
struct Round {
    Range rays, segments;
};

std::vector<Round> rounds_of(const SegmentTable &rays, const SegmentTable &segments, bool at_once) {
    if (at_once)
        return {{{0, rays.count}, {0, segments.count}}};
    std::vector<Round> rounds;
    for (const Range &part : parts_of(rays))
        rounds.push_back({part, {}});
    for (const Range &part : parts_of(segments))
        rounds.push_back({{}, part});
    return rounds;
}

/// The columns of a table that the tracer reads or writes, on the host: where they lie, or, where mapping would copy
/// the whole table to and fro, copies of the rows that are asked for.
class HostColumns {
  public:
    /// `copy`: where the copies are to be; made large enough. With Wait::later, mappings made after this one are what
    /// is waited for.
    HostColumns(Device &device, const SegmentTable &places, Precision precision, Wait wait,
                std::unique_ptr<HostMemory> &copy)
        : table_(*places.table), element_(real_bytes(precision)), pitch_(places.rows * element_),
          host_pitch_(places.count * element_) {
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
        const std::size_t bytes = copied_.size() * host_pitch_;
        if (!copy || copy->bytes() < bytes) {
            const std::size_t room = std::max(bytes, copy ? 2 * copy->bytes() : 0);
            copy.reset();
            copy = std::make_unique<HostMemory>(device, room);
        }
        copy_ = copy->data();
    }
    HostColumns(const HostColumns &) = delete;
    HostColumns &operator=(const HostColumns &) = delete;

    /// Starts to copy a part; columns that are neighbours go together.
    void fetch(const Range &part) {
        if (copied_.empty())
            return;
        std::vector<Buffer::Reading> &readings = readings_.emplace_back();
        for (std::size_t begin = 0, end; begin < copied_.size(); begin = end) {
            for (end = begin + 1; end < copied_.size() && copied_[end] == copied_[end - 1] + 1;)
                ++end;
            readings.push_back(
                table_.start_read(at(copied_[begin], part.first), stripes(copied_[begin], end - begin, part)));
        }
    }
    /// Waits for the next of the parts that were fetched.
    void arrive() {
        if (copied_.empty())
            return;
        for (Buffer::Reading &reading : readings_.front())
            reading.wait();
        readings_.pop_front();
    }
    /// Sends the answers of copies back.
    void send(const Range &part) const {
        for (const int answer : answers_)
            table_.start_write(at(answer, part.first), stripes(answer, 1, part));
    }
    char *at(int column, std::size_t row) const {
        char *const first =
            mapping_ ? mapping_->as<char>() + std::size_t(column) * pitch_
                     : copy_ + std::size_t(std::ranges::find(copied_, column) - copied_.begin()) * host_pitch_;
        return first + row * element_;
    }

  private:
    Stripes stripes(int first, std::size_t count, const Range &rows) const {
        return {pitch_, host_pitch_, std::size_t(first), count, rows.first * element_, rows.count * element_};
    }
    const Buffer &table_;
    std::size_t element_, pitch_, host_pitch_; ///< bytes; from column to column
    std::optional<Buffer::Mapping> mapping_;
    std::vector<int> copied_, answers_;
    std::deque<std::vector<Buffer::Reading>> readings_; ///< by part
    char *copy_ = nullptr;
};

/// Rows of a table as the tracer takes them, in float. Those of a double table are copied, for Embree traces in float,
/// and the answers go back when this ends.
class Segments {
  public:
    Segments(const HostColumns &host, const SegmentTable &places, const Range &part, Precision precision)
        : is_double_(precision == Precision::double_), rows_(part.count) {
        columns.line = places.line;
        columns.alike_from = places.alike_from - std::min<std::size_t>(places.alike_from, part.first);
        for (int axis = 0; axis < 3; ++axis) {
            columns.origin[axis] = reals(origin_[axis], host.at(places.origin + axis, part.first));
            columns.direction[axis] = reals(direction_[axis], host.at(places.direction + axis, part.first));
        }
        answer = numbers(answer_, host.at(places.answer, part.first));
        if (places.instance >= 0)
            instance = numbers(instance_, host.at(places.instance, part.first));
        if (places.opacity >= 0)
            opacity = numbers(opacity_, host.at(places.opacity, part.first));
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
    std::optional<HostColumns> rays_on_host, segments_on_host;
    if (rays.count > 0)
        rays_on_host.emplace(device_, rays, precision_, segments.count > 0 ? Wait::later : Wait::now, ray_copy_);
    if (segments.count > 0)
        segments_on_host.emplace(device_, segments, precision_, Wait::now, segment_copy_);
    const std::vector<Round> rounds = rounds_of(rays, segments, device_.description().shares_memory);
    for (const Round &round : rounds) {
        if (round.rays.count > 0)
            rays_on_host->fetch(round.rays);
        if (round.segments.count > 0)
            segments_on_host->fetch(round.segments);
    }
    TraceCounts counts;
    for (const Round &round : rounds) {
        {
            std::optional<Segments> ray_view, segment_view;
            RayColumns ray{};
            ShadowColumns segment{};
            if (round.rays.count > 0) {
                rays_on_host->arrive();
                ray_view.emplace(*rays_on_host, rays, round.rays, precision_);
                ray = {ray_view->columns, ray_view->answer, ray_view->instance, ray_view->opacity, rays.without_chance};
            }
            if (round.segments.count > 0) {
                segments_on_host->arrive();
                segment_view.emplace(*segments_on_host, segments, round.segments, precision_);
                segment = {segment_view->columns, segment_view->answer};
            }
            const AddedSeconds tracing(seconds);
            const TraceCounts found = tracer_.trace(ray, round.rays.count, segment, round.segments.count);
            counts.extension += found.extension;
            counts.shadow += found.shadow;
        }
        if (round.rays.count > 0)
            rays_on_host->send(round.rays);
        if (round.segments.count > 0)
            segments_on_host->send(round.segments);
    }
    return counts;
}

} // namespace gradus
