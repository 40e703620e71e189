// The images that a reconstruction starts from, as renderers write them: a file each, or layers of one file.
#pragma once

#include "runtime/film/image.h"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

enum class GradientLayer {
    primal,
    dx,
    dy,
    direct,
    primal_variance,
    dx_variance,
    dy_variance,
    // of the even samples, and of the odd ones
    primal_even,
    dx_even,
    dy_even,
    primal_even_variance,
    dx_even_variance,
    dy_even_variance,
    primal_odd,
    dx_odd,
    dy_odd,
    primal_odd_variance,
    dx_odd_variance,
    dy_odd_variance,
    // what the camera sees, for a guide
    albedo,
    normal,
    depth
};

inline constexpr std::array gradient_layers = {GradientLayer::primal,
                                               GradientLayer::dx,
                                               GradientLayer::dy,
                                               GradientLayer::direct,
                                               GradientLayer::primal_variance,
                                               GradientLayer::dx_variance,
                                               GradientLayer::dy_variance,
                                               GradientLayer::primal_even,
                                               GradientLayer::dx_even,
                                               GradientLayer::dy_even,
                                               GradientLayer::primal_even_variance,
                                               GradientLayer::dx_even_variance,
                                               GradientLayer::dy_even_variance,
                                               GradientLayer::primal_odd,
                                               GradientLayer::dx_odd,
                                               GradientLayer::dy_odd,
                                               GradientLayer::primal_odd_variance,
                                               GradientLayer::dx_odd_variance,
                                               GradientLayer::dy_odd_variance,
                                               GradientLayer::albedo,
                                               GradientLayer::normal,
                                               GradientLayer::depth};

/// The layers of a half, 0 or 1: primal, dx, dy and their variances.
inline constexpr std::array<std::array<GradientLayer, 6>, 2> half_layers = {
    {{GradientLayer::primal_even, GradientLayer::dx_even, GradientLayer::dy_even, GradientLayer::primal_even_variance,
      GradientLayer::dx_even_variance, GradientLayer::dy_even_variance},
     {GradientLayer::primal_odd, GradientLayer::dx_odd, GradientLayer::dy_odd, GradientLayer::primal_odd_variance,
      GradientLayer::dx_odd_variance, GradientLayer::dy_odd_variance}}};

/// The name of a layer as Gradus writes it: "primal", "dx_variance".
const char *layer_name(GradientLayer layer);

bool is_variance(GradientLayer layer);
/// Whether the layer is one of a half.
bool is_of_half(GradientLayer layer);
/// Whether it is albedo, normal or depth.
bool is_feature(GradientLayer layer);

/// Where the images are.
struct GradientSources {
    std::string layered;                        ///< a file that holds them as layers; empty: none
    std::map<GradientLayer, std::string> files; ///< files of their own, which go before the layers
    /// Names of layers, in whichever file; without one, those of docs/command-line.md. An empty name means the channels
    /// outside of any layer.
    std::map<GradientLayer, std::string> names;
    bool variances = false;   ///< whether they are asked for; if not they are not read
    bool halves = false;      ///< both halves are, instead of primal, dx, dy and their variances
    bool features = false;    ///< and albedo, normal and depth; halves may then have a primal alone, as path tracing's
    std::uint64_t limits = 1; ///< of read_image()
};

/// Whether read_gradient_images() looks for the layer.
bool is_asked_for(GradientLayer layer, const GradientSources &sources);

struct GradientImages {
    std::uint32_t width = 0, height = 0;
    std::vector<std::string> channels; ///< "R", "G", "B", or "Y" alone
    /// Planes: channel c at row y and column x is element (c * height + y) * width + x. What is not there is left out.
    std::map<GradientLayer, std::vector<float>> planes;
    std::map<std::string, std::string> metadata; ///< of the primal's file
    std::optional<PixelPlace> origin;            ///< of the first pixel, as Image has it

    /// The planes of a layer, or nullptr.
    const float *find(GradientLayer layer) const;
};

/// Reads primal, dx and dy, direct where there is one, and the variances where they are asked for; or both halves, and
/// direct where there is one, and features where they are asked for: albedo has colours, normal X, Y and Z, depth Z.
///
/// In a file an image is the layer that the sources name, or else the first layer of one of its usual names in any
/// case, or else, in a file of its own, the channels outside of any layer, where there are no layers beside them or it
/// is primal or direct. Colours are the channels R, G and B, or Y where it stands alone; alpha is ignored.
///
/// Throws Error(ExitCode::usage) where an image has neither file nor layer, Error(ExitCode::image) for files that
/// cannot be read, layers that are missing, and sizes, channels or places in the frame that differ.
GradientImages read_gradient_images(const GradientSources &sources);

} // namespace gradus
