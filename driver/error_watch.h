// When a render that goes on until its error is small enough looks at it.
//
// It looks after 16 samples of each pixel, and each time their number has doubled. So there are few looks, which are
// at places of their own, whatever batches and threads are, and an image that ends there is the one that so many
// samples make.
//
// Its own samples decide when it ends, and error is estimated low in those renders that missed what is rare and bright:
// so the mean of many such renders is a little too dark. How little: let X be the error of the image's mean at a look,
// s its standard deviation, S that the render ends there. If it goes on, half of the next image's samples are new, so X
// / 2 is left of X. The mean of the final error is then E[X; S] + E[X; not S] / 2 = E[X; S] / 2, since E[X] = 0. That
// is at most s / 4 whatever the noise (Cauchy and Schwarz), and s r / 5 where X and the estimate are normal and have
// the correlation r: no render shows it. A pixel has far less of its s, for it is one of all that the estimate is the
// mean of. Who needs none at all renders another seed with the --spp that one render ended at.
#pragma once

#include "methods/method.h"

#include <cstdint>
#include <optional>

namespace gradus {

class ErrorWatch {
  public:
    /// `aim`: the estimated relMSE to end by, above 0.
    ErrorWatch(Method &method, double aim);

    /// To be called after each batch: whether the image is good enough. It is made anew at each look.
    bool is_reached();

    double aim() const { return aim_; }
    /// Of the last look, and the samples of each pixel that it was at; before the first no estimate, and
    /// samples() says nothing.
    std::optional<double> estimate() const { return estimate_; }
    std::uint64_t samples() const { return next_ / 2; }
    /// The samples of all pixels together at which it looks again.
    std::uint64_t next_look() const { return next_ * method_.frame_samples(); }

    static constexpr std::uint64_t first_look = 16;
    /// A render that nothing else ends has no more samples of each pixel than this.
    static constexpr std::uint64_t most_samples = std::uint64_t(1) << 20;

  private:
    Method &method_;
    const double aim_;
    std::uint64_t next_ = first_look; ///< samples of each pixel
    std::optional<double> estimate_;
};

} // namespace gradus
