#include "solver/guide/light_correction.h"

#include "kernels/shared/guide_shared.h"
#include "solver/guide/guide_smoother.h"
#include "solver/guide/mean_brightness.h"

#include <cstddef>
#include <utility>

namespace gradus {

namespace {

constexpr int passes = 4; // the last reaches 16 pixels, which is SOLVER_MARGIN
/// Darker pixels count as so much of the mean brightness; what is added to tell how alike two pixels are.
constexpr double least_brightness = 1e-3, dim_brightness = 1e-2;

} // namespace

LightCorrection::LightCorrection(Device &device, std::uint32_t width, std::uint32_t height, Precision precision)
    : make_(device, precision), grid_(solver::guide_grid(width, height)),
      lost_(solver::guide_kernel(device, precision, "guide_light", "guide_lost")),
      pass_(solver::guide_kernel(device, precision, "guide_light", "guide_light_pass")),
      give_back_(solver::guide_kernel(device, precision, "guide_light", "guide_give_back")) {}

void LightCorrection::run(const std::array<const Buffer *, 2> &halves, double share, Buffer &image) {
    const double mean = mean_brightness(image, 3 * std::size_t(grid_.width) * grid_.height);
    if (!(mean > 1e-30)) // black
        return;
    Buffer lost = make_.planes("lost", grid_, GUIDE_LOST), smoothed = make_.planes("smoothed", grid_, GUIDE_LOST);
    const Buffer brightness = make_.planes("brightness", grid_, 2);
    lost_.set_real("share", share);
    lost_.set_real("least", least_brightness * mean);
    lost_.set_real("dim", dim_brightness * mean);
    lost_.bind("first_half", *halves[0]);
    lost_.bind("second_half", *halves[1]);
    lost_.bind("image", image);
    lost_.bind(lost);
    lost_.bind(brightness);
    grid_.launch(lost_, {0, 1});
    pass_.bind(brightness);
    pass_.set("unit", 1);
    for (int pass = 0; pass < passes; ++pass)
        for (const auto &[across, down] : {std::pair{1u, 0u}, {0u, 1u}}) {
            pass_.set("across", across << pass);
            pass_.set("down", down << pass);
            pass_.bind("lost", lost);
            pass_.bind("smoothed", smoothed);
            grid_.launch(pass_, {0, 1});
            std::swap(lost, smoothed);
        }
    give_back_.bind(brightness);
    give_back_.bind("smoothed", lost);
    give_back_.bind("image", image);
    grid_.launch(give_back_, {0, 1});
    finish(make_.device());
}

} // namespace gradus
