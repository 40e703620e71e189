// What the radius does to an image of photons, told from the same photons.
//
// The mean of a smooth radiance over a disc of radius r is L + c r^2, where c is an eighth of its Laplacian on the
// surface. The estimate from the inner half of the disc's area, of radius r / sqrt(2), is L + c r^2 / 2. So twice the
// difference of both estimates c r^2, the bias, pass by pass. It has twice the noise of the radiance, so a pixel alone
// says little; over an image, the product of two independent halves of the passes says what the square of the bias is.
// Where the radiance is not smooth within the disc (edges of shadows and caustics, corners, borders of
// surfaces) the bias goes by another power of r: what goes by r itself is seen at 0.59 of what it is.
#pragma once

#include "methods/method.h"
#include "methods/photons/photon_pairs.h"
#include "runtime/film/image.h"
#include "runtime/wavefront/session.h"
#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace gradus {

/// By pixel and colour, from the passes of an image.
struct BiasEstimates {
    std::vector<double> mean;      ///< of all passes: what the image has too much, or too little
    std::vector<double> even, odd; ///< of every other pass: independent of each other
    bool has_halves = false;       ///< each pixel has a pass of either

    /// Adds it to the image as its layer `bias`, R, G and B.
    void add_layer(Image &image) const;
    /// Mean over pixels and colours of the squared bias over R^2 + 0.001: what of the image's relMSE more photons do
    /// not take away. It has no bias itself, so noise may make it negative.
    double relative_square(const Image &image) const;
};

/// Adds the layer `bias` to an image of photons, where it was estimated, and to the statistics what its passes say of
/// its errors: of the noise where the image has the layer `variance`, passes being independent samples of each pixel;
/// of the bias where there are two of them.
void add_pass_errors(const std::optional<BiasEstimates> &bias, Image &image, Statistics &statistics);

class RadiusBias {
  public:
    /// Declares the stages `bias_sum`, `bias_add` and `bias_keep`; nothing is done unless options ask for its layer.
    /// `by_slot`: gather points are in the rows of their slots.
    RadiusBias(Session &session, Stages &stages, const PhotonPairs &pairs, const RenderOptions &options, bool by_slot);

    TableList tables() const;
    /// To be called once these are allocated; all is zero.
    void attach(Tables &tables);

    /// Before a batch of slots.
    void begin();
    /// After the pairs of a window have been evaluated.
    void sum(const PairWindow &window);
    /// After all windows of gather points in `rows`.
    void add(Range rows);
    /// After all gather points: only now the batch counts. Slot 0 is that of pixel `first_pixel`.
    void keep(std::uint32_t slots, std::uint32_t first_pixel, std::uint64_t pass);

    /// After `samples` samples; filtered as the image is. Nothing where nobody asked for it.
    std::optional<BiasEstimates> estimates(std::uint64_t samples) const;

  private:
    void add_filtered(const std::vector<double> &sampled, std::vector<double> &image) const;

    Session &session_;
    bool is_wanted_, by_slot_;
    Stage &sum_, &add_, &keep_;
    Tables *tables_ = nullptr;
};

} // namespace gradus
