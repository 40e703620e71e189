// The film: sums over the samples of each pixel, on the device.
#pragma once

#include "runtime/film/image.h"
#include "runtime/wavefront/frame_place.h"
#include "runtime/wavefront/session.h"
#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

class Film {
  public:
    /// Declares the stage `accumulate`. `halves`: even and odd samples of a pixel are also known apart. Replicates are,
    /// where the session has them.
    Film(Session &session, Stages &stages, bool halves = false);

    TableList tables() const;
    /// To be called once they are allocated; all is zero.
    void attach(Tables &tables);

    /// Adds the samples of slots [0, count), which belong to the pixels from `first_pixel` on, of all that are sampled
    /// (Session::pixels()), cyclically. `first_sample`: which sample of its pixel the first is.
    void add(std::uint32_t count, std::uint32_t first_pixel, std::uint64_t first_sample = 0);

    /// The means after `samples` samples: the first `samples` modulo pixels have one more than the rest. Where there
    /// are splats (splats.h), their sums over `light_paths`, the paths that they are of, are added; 0: they are left
    /// out. Adds the samples and splats that were left out to `non_finite`. Variances are those of the samples alone.
    Image image(std::uint64_t samples, std::uint64_t &non_finite, std::uint64_t light_paths = 0) const;

    /// Writes the mean of a half of `samples` samples, 0: the even ones, for one of R, G and B.
    void half_mean(int half, std::uint64_t samples, int color, float *plane) const;

    /// Where the samples of that frame lie, for the filter.
    FramePlace place_of(std::uint64_t frame) const {
        return counts_for_own_ ? place_of_own() : frame_place(session_, frame);
    }
    /// Whether samples count for their own pixels alone, whatever the filter: where neighbouring rows are none.
    void count_for_own(bool own) { counts_for_own_ = own; }

    /// All zero again, splats too. Samples are those from this number on.
    void clear(std::uint64_t first_sample = 0);

    /// Samples of nothing in all slots, for where no path begins and sets its own.
    void clear_slots();

    /// The tables that image() reads, but for splats.
    std::vector<std::string> table_names() const;

  private:
    bool has_replicates() const { return parts_ > 2; }

    Session &session_;
    Stage &frame_, &accumulate_;
    std::uint32_t parts_; ///< of the samples, each with a table of its own
    std::uint64_t first_sample_ = 0;
    bool counts_for_own_ = false;
    Tables *tables_ = nullptr;
};

/// Of a frame whose samples of these pixels have come, after those of the pixels before: the pixels that have had with
/// them all that count for them, but for the border. Which of its columns are among them does not matter.
inline Range filtered_pixels(const Session &session, Range samples) {
    const std::uint32_t lag = session.filter_lag();
    const auto known = [lag](std::uint32_t count) { return count > lag ? count - lag : 0; };
    const std::uint32_t first = std::max(known(samples.first), lag), end = known(samples.end());
    return {first, end > first ? end - first : 0};
}

} // namespace gradus
