// Unidirectional path tracing with next-event estimation, multiple importance sampling and Russian roulette (Kajiya
// 1986, Veach 1997), as a wavefront.
#pragma once

#include "methods/method.h"
#include "runtime/wavefront/film.h"
#include "runtime/wavefront/wavefront.h"
#include "solver/squared_errors.h"

#include <memory>
#include <optional>

namespace gradus {

class PathTracer final : public Method {
  public:
    PathTracer(Device &device, const Scene &scene, const RenderOptions &options);

    std::uint64_t total_samples() const override { return total_; }
    std::uint64_t done_samples() const override { return done_; }
    std::uint64_t frame_samples() const override { return session_.pixels(); }
    bool render_batch() override;
    Image image() override;
    Image mean_image() override;
    Statistics statistics() const override;

    Tracer *tracer() override { return &session_.tracer; }

  private:
    bool is_guided() const { return options_.reconstruction == Reconstruction::guided; }
    /// Whether samples are kept as two halves: of gradient-domain methods other reconstructions ask for them, too.
    bool is_halved() const { return is_guided() || options_.error; }
    /// Whether both halves have a sample of each pixel.
    bool has_halves() const { return done_ >= 2 * session_.pixels(); }
    /// Makes of the mean of all samples one that follows a guide, and leaves its features out if they are not wanted.
    void guide(Image &image, SquaredErrors *errors);
    /// The mean of a half's samples: planes of R, G and B.
    std::vector<float> half_image(int half) const;

    const RenderOptions options_;
    Session session_;
    Stages stages_;
    Stage &camera_, &far_clip_, &connect_;
    Wavefront paths_;
    Stage &escape_, &emission_, &shade_;
    Film film_;
    std::optional<Tables> tables_;
    std::uint64_t total_ = 0, done_ = 0;
    std::uint32_t pass_ = 0; ///< paths of a pass, but for the last
    bool is_mean_ = false;   ///< the last image, whatever was asked for
    Statistics statistics_;
};

std::unique_ptr<Method> make_path_tracer(Device &device, const Scene &scene, const RenderOptions &options);

} // namespace gradus
