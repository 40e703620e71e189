#include "solver/guide/guided_errors.h"

namespace gradus {

SquaredErrors errors_of_guided(const std::array<const Buffer *, 2> &halves, double share,
                               const std::array<const Buffer *, 2> &guides, const std::vector<float> &followed) {
    const auto first = halves[0]->map(Access::read), second = halves[1]->map(Access::read);
    const auto first_guide = guides[0]->map(Access::read), second_guide = guides[1]->map(Access::read);
    const float *a = first.as<float>(), *b = second.as<float>();
    const float *guide_a = first_guide.as<float>(), *guide_b = second_guide.as<float>();
    const double rest = 1 - share;
    SquaredErrors errors;
    errors.variance.resize(3 * followed.size());
    errors.bias.resize(3 * followed.size());
    for (std::size_t i = 0; i < errors.bias.size(); ++i) {
        const double s = followed[i % followed.size()];
        const double noise = double(a[i]) - b[i], of_guide = double(guide_a[i]) - guide_b[i];
        const double of_image = (1 - s) * noise + s * of_guide;
        const double apart = share * (double(guide_a[i]) - a[i]) + rest * (double(guide_b[i]) - b[i]);
        const double of_apart = of_guide - noise;
        errors.variance[i] = float(share * rest * of_image * of_image);
        errors.bias[i] = float(s * s * (apart * apart - share * rest * of_apart * of_apart));
    }
    return errors;
}

} // namespace gradus
