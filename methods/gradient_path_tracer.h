// Gradient-domain path tracing (Kettunen et al. 2015): beside each pixel's path, four offset paths through its
// neighbours, and an image reconstructed from colours and differences.
//
// All pixels of a sample share their place within the pixel, so an offset path begins where the neighbour's own path
// does. Where it and the base path are at rough vertices it reconnects to the base path's next one (the reconnection
// vertex): there it is recently connected, and from the vertex after that on connected: both are the same, and what
// they differ by is kept by slot. So the base path's later stages are the path tracer's. Until then an offset path is
// not connected: it copies the base path's half vectors and has vertices of its own; scenes in which all surfaces are
// rough do without.
//
// A pass is some samples of the whole image, or a strip of its rows where the image is larger than that.
#pragma once

#include "methods/difference_film.h"
#include "methods/method.h"
#include "runtime/wavefront/wavefront.h"

#include <memory>
#include <optional>
#include <vector>

namespace gradus {

class GradientPathTracer final : public Method {
  public:
    GradientPathTracer(Device &device, const Scene &scene, const RenderOptions &options);

    std::uint64_t total_samples() const override { return total_; }
    std::uint64_t done_samples() const override { return done_; }
    std::uint64_t frame_samples() const override { return session_.pixels(); }
    bool render_batch() override;
    /// R, G, B reconstructed; with `layers` then direct, primal, dx, dy, and with aov also their variances; with aov
    /// the path tracer's layers.
    Image image() override { return make_image(options_.layers, false); }
    Image last_image() override { return make_image(options_.layers, true); }
    Image mean_image() override { return film_.mean(done_); }
    Image image_with_layers() { return make_image(true, false); }
    Statistics statistics() const override;

    /// Forgets all samples; the next ones are of numbers [first_sample, first_sample + samples_per_pixel) of each
    /// pixel. Other numbers are other random paths of the same seed. A new method is at number 0.
    void restart(std::uint64_t first_sample, std::uint64_t samples_per_pixel);

    /// What some rows of an image know.
    struct Rows {
        GradientFilms films;
        Image image;                        ///< the mean of the samples
        std::uint64_t primaries_beside = 0; ///< rays of the camera that are of no path, at the borders of strips
    };
    /// Renders the samples [first_sample, first_sample + samples) of pairs of neighbouring rows, `rows` in all and
    /// even, that lie evenly over the image, as an image of these rows alone. Each second row's differences down lead
    /// to the next pair and mean nothing. All samples are forgotten; restart() is to follow, once Rows has been read.
    Rows render_rows(std::uint32_t rows, std::uint64_t first_sample, std::uint64_t samples);

    bool has(const char *trait) const { return session_.has(trait); }

    Tracer *tracer() override { return &session_.tracer; }

  private:
    /// Where the offset paths of a vertex are: at the first vertices, not connected; at later ones some not connected;
    /// joined: all recently connected, or failed; later: connected. `mixed`: some are at vertices of other BSDF kinds
    /// than the base path's. Phases that a scene does not need have no bins: they are the number of those that it has.
    struct Phases {
        std::uint32_t first, first_mixed, apart, apart_mixed, joined, later, count;
    };
    /// Of paths that left the scene.
    enum Escaped : std::uint32_t { escaped_first, escaped_shifting, escaped_later, escaped_bins };
    /// The rows of a frame that a pass takes, and how many frames.
    struct Strip {
        std::uint32_t first = 0, rows = 0, frames = 1;
    };

    /// Where offset paths that are not connected have their vertices (OWN_VERTEX in kernels/lib/gradient.h), and the
    /// base paths that have such ones: all of those, and in which phases they are.
    struct OwnVertices {
        const char *table;
        std::uint32_t rows; ///< of that table
        std::uint32_t at_first;
        Range paths;
        std::uint32_t alike, mixed;
    };

    static Phases phases_of(const Session &session);
    std::map<std::string, std::string> classify_definitions() const;
    TableList tables() const;
    void allocate();

    Strip next_strip() const;
    void begin_pass(const Strip &strip);
    void trace_primaries(const Strip &strip);
    /// Returns the first slot of the paths begun.
    std::uint32_t begin_primaries(std::uint32_t first_pixel);
    void set_rows(std::uint32_t rows);
    /// The rows with offset paths that are not connected; they come first.
    std::uint32_t shifting() const { return newest_.phases(0, phases_.joined).count; }
    void step_offset_paths();
    std::vector<OwnVertices> own_vertices() const;
    void shift(const OwnVertices &own, std::uint32_t stride);
    void find_emission(const Hits &next);
    void shade(const Hits &next);
    void follow(const Hits &next, std::uint32_t stride);
    Image make_image(bool layers, bool last);

    RenderOptions options_;
    Session session_;
    Phases phases_;
    Stages stages_;
    Stage &camera_, &far_clip_, &primary_, &begin_, &connect_, &gradient_connect_, &shift_, &shift_alike_, &evaluate_,
        &weigh_, &weigh_apart_;
    Wavefront paths_;
    Stage &escape_, &emission_, &gradient_escape_, &gradient_emission_, &shade_with_offsets_, &shade_, &advance_,
        &advance_apart_, &join_, &count_;
    DifferenceFilm film_;
    std::optional<Tables> tables_;
    Hits newest_; ///< of the newest vertices
    std::uint64_t total_ = 0, done_ = 0, first_sample_ = 0;
    std::uint32_t strip_rows_ = 0, strip_frames_ = 1; ///< of a pass, but for the last
    std::uint64_t primaries_beside_ = 0;              ///< rays of the camera through rows beside strips
    std::uint32_t all_rows_ = 0;                      ///< of the image, while `session_` has but some of them; else 0
    Statistics statistics_;
};

std::unique_ptr<Method> make_gradient_path_tracer(Device &device, const Scene &scene, const RenderOptions &options);

} // namespace gradus
