#include "solver/guide/guide_judge.h"

#include "kernels/shared/guide_shared.h"
#include "kernels/shared/solver_shared.h"
#include "solver/guide/mean_brightness.h"

#include <algorithm>
#include <cstddef>

namespace gradus {

namespace {

/// Darker pixels count as this share of the squared mean brightness of the image.
constexpr double least_brightness = 0.01;

} // namespace

GuideJudge::GuideJudge(Device &device, std::uint32_t width, std::uint32_t height, Precision precision)
    : make_(device, precision), grid_(solver::guide_grid(width, height)),
      moments_(solver::guide_kernel(device, precision, "guide_judge", "guide_moments")),
      share_(solver::guide_kernel(device, precision, "guide_judge", "guide_share")),
      blend_(solver::guide_kernel(device, precision, "guide_judge", "guide_blend")), wide_(make_, grid_, 9, 3.0),
      narrow_(make_, grid_, 3, 1.0) {}

void GuideJudge::run(const std::array<const Buffer *, 2> &halves, double share,
                     const std::array<const Buffer *, 2> &guides, Buffer &result, const Buffer *followed,
                     std::vector<float> *kept) {
    const Buffer moments = make_.planes("moments", grid_, GUIDE_MOMENTS);
    const Buffer smoothed = make_.planes("smoothed", grid_, GUIDE_MOMENTS);
    const Buffer shares = make_.planes("shares", grid_, GUIDE_SHARES);
    for (Kernel *kernel : {&moments_, &blend_}) {
        kernel->set_real("share", share);
        kernel->bind("first_half", *halves[0]);
        kernel->bind("second_half", *halves[1]);
        kernel->bind("first_guide", *guides[0]);
        kernel->bind("second_guide", *guides[1]);
    }
    const double mean = mean_brightness(*guides[0], 3 * std::size_t(grid_.width) * grid_.height);
    // At least what squares to a number of full precision.
    moments_.set_real("least_brightness", std::max(least_brightness * mean * mean, 1e-30));
    moments_.bind(moments);
    moments_.bind(shares);
    grid_.launch(moments_, {0, 1});
    wide_.run(moments, smoothed, GUIDE_MOMENTS);
    share_.bind("moments", smoothed);
    share_.bind(shares);
    grid_.launch(share_, {0, 1});
    narrow_.run(shares, moments, GUIDE_SHARES);
    if (followed) {
        blend_.bind("first_guide", *followed);
        blend_.bind("second_guide", *followed);
    }
    blend_.bind("smoothed", moments);
    blend_.bind("result", result);
    grid_.launch(blend_, {0, 1});
    finish(make_.device());
    wide_.release();
    narrow_.release();

    if (kept)
        *kept = make_.precision() == Precision::double_ ? quotients_inside<double>(moments)
                                                        : quotients_inside<float>(moments);
}

/// The smoothed shares as guide_blend follows them.
template <class Real>
std::vector<float> GuideJudge::quotients_inside(const Buffer &planes) const {
    const Buffer::Mapping mapping(planes, Access::read, Wait::now);
    std::vector<float> quotients;
    quotients.reserve(std::size_t(grid_.width) * grid_.height);
    for (std::size_t y = 0; y < grid_.height; ++y) {
        const Real *share = mapping.as<Real>() + (y + 1) * grid_.row + SOLVER_MARGIN;
        const Real *area = share + (GUIDE_COUNTS - GUIDE_SHARE) * grid_.plane;
        for (std::size_t x = 0; x < grid_.width; ++x)
            quotients.push_back(area[x] > 0 ? std::min(float(share[x] / area[x]), 1.0f) : 0.0f);
    }
    return quotients;
}

} // namespace gradus
