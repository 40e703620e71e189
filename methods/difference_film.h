// What gradient-domain methods do once samples and differences are known: the sums of both, what the camera sees of
// lights, and the reconstruction, whose kernels are compiled while the first samples render.
#pragma once

#include "methods/gradient_films.h"
#include "methods/method.h"
#include "runtime/direct_light/direct_light.h"
#include "runtime/wavefront/film.h"
#include "solver/poisson_solver.h"

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

class DifferenceFilm {
  public:
    /// Declares the stages `gradient_combine`, `accumulate`, `gradient_accumulate` and `gradient_carry`. `options` must
    /// live as long. `counts`: the table that the method's statistics read after the last image. `may_tell_error`: not
    /// for methods whose error is more than halves know.
    DifferenceFilm(Session &session, Stages &stages, const RenderOptions &options, const char *counts,
                   bool may_tell_error = true);
    /// What is still being compiled ends with the kernel that is ready next: there will be no image.
    ~DifferenceFilm();

    /// By slot `direct`, `prefix` and `difference`, which the method fills; and the sums.
    TableList tables() const;
    /// For strips that are whole frames: no differences are carried from one to the next. Before stages are built.
    void carry_nothing() { carry_.leave_out(); }
    /// To be called once the tables are allocated; all is zero.
    void attach(Tables &tables);

    /// To be called before samples render: begins what the first image will need.
    void begin();
    /// Zero in all slots, for images without paths.
    void clear_slots();
    /// Adds the samples of `frames` frames of the image's rows [first, first + rows), slot by slot. `number`: of the
    /// first of these frames, which says of which part of the samples they are.
    void add(std::uint32_t first, std::uint32_t rows, std::uint32_t frames, std::uint64_t number);
    /// After `samples` samples; those left out are added to `non_finite`. `last`: lets go of batches and films as soon
    /// as they have been read. Pixels whose mean is no finite number are filled by the reconstruction, and counted
    /// (add_to()).
    Image image(std::uint64_t samples, bool layers, bool last, std::uint64_t &non_finite);

    /// What an image of so many samples is made from, which is read where it lies; and the mean of the samples, which
    /// is there after a last image that failed, too.
    GradientFilms films(std::uint64_t samples) const;
    Image mean(std::uint64_t samples) const;

    /// All sums and counts zero again, of samples from this number on. Edges of lights that have been sampled stay.
    void clear(std::uint64_t first_sample = 0);
    /// Film::count_for_own().
    void count_for_own(bool own) { film_.count_for_own(own); }
    /// Adds what sampling the edges of lights took, and how the last image was reconstructed.
    void add_to(Statistics &statistics) const;

  private:
    void add_slots(std::uint32_t first, std::uint32_t rows, std::uint32_t frames, std::uint64_t number);
    void add_filtered(std::uint32_t first, std::uint32_t rows, std::uint32_t first_slot, std::uint64_t number);
    /// What the camera sees of lights at their edges, for an image of so many samples. Images under way take that of a
    /// power of two, whichever were asked for before.
    const std::vector<DirectPixel> &edges(std::uint64_t samples, bool last);
    /// The squared error of what the camera sees of lights, by pixel and channel: of edges as their rays tell, else as
    /// both halves of the samples do.
    std::vector<float> direct_variance(std::uint64_t samples, const std::vector<DirectPixel> &edges) const;

    Session &session_;
    const RenderOptions &options_;
    const std::string counts_;
    const bool tells_error_;                    ///< whether an image says its error
    const std::vector<std::string> film_names_; ///< the tables of the sums: one, or one for each part of the samples
    Stage &combine_;
    Film film_;
    Stage &frame_, &accumulate_, &carry_;
    Tables *tables_ = nullptr;
    std::uint64_t first_sample_ = 0; ///< the number of the first one
    std::vector<DirectPixel> edges_;
    std::uint32_t edge_samples_ = 0; ///< a pixel of the image that `edges_` were sampled for; 0: not yet
    std::uint64_t edge_rays_ = 0, lost_pixels_ = 0;
    double edge_seconds_ = 0;
    ReconstructionUsed used_;
    std::optional<Image> mean_;            ///< while the last image is made, whose films go
    std::optional<double> relative_error_; ///< estimated, of the last image
    std::unique_ptr<PoissonSolver> solver_;
    std::shared_ptr<void> compilers_;   ///< from before the stages' kernels are compiled until the solver's are
    std::atomic<bool> is_going_{false}; ///< asked after each of the solver's kernels
    std::future<void> solver_compiled_; ///< while the first samples render; waits for that at the end
};

} // namespace gradus
