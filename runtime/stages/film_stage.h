// The film: sums over the samples of each pixel, on the device.
#pragma once

#include "runtime/film/image.h"
#include "runtime/stages/batch_tables.h"

#include <vector>

namespace gradus {

class FilmStage {
  public:
    static KernelRequest request();

    /// A film of width * height pixels (the crop), all zero.
    FilmStage(Device &device, Kernel kernel, const BatchTables &tables, std::uint32_t width, std::uint32_t height,
              const TraitMap &traits, Precision precision);

    /// Adds the samples of slots [0, count), which belong to the pixels from `first_pixel` on, cyclically.
    void accumulate(std::uint32_t count, std::uint32_t first_pixel);

    /// The means after `samples` samples: the first `samples` modulo pixels have one more than the rest. Adds the
    /// samples that were left out to `non_finite`.
    Image image(std::uint64_t samples, std::uint64_t &non_finite) const;

    /// Lets go of the memory; nothing may be asked of it afterwards.
    void release() { film_ = feature_film_ = Buffer(); }

    /// All zero again.
    void clear();

    std::uint32_t pixels() const { return width_ * height_; }

  private:
    Kernel kernel_;
    Buffer film_, feature_film_;
    std::uint32_t width_, height_;
    bool aov_;
    Precision precision_;
};

} // namespace gradus
