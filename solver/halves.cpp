#include "solver/halves.h"

namespace gradus {

HalvedImages uploaded_halves(Device &device, const HostHalves &halves, std::size_t bytes_of_image) {
    const auto uploaded = [&](const char *name, const float *image) {
        return image ? Buffer(device, name, image, bytes_of_image) : Buffer();
    };
    HalvedImages result;
    for (int i = 0; i < 2; ++i) {
        const HostImages &images = halves.images[i];
        result[i].primal = uploaded("primal", images.primal);
        result[i].dx = uploaded("dx", images.dx);
        result[i].dy = uploaded("dy", images.dy);
        result[i].primal_variance = uploaded("primal_variance", images.primal_variance);
        result[i].dx_variance = uploaded("dx_variance", images.dx_variance);
        result[i].dy_variance = uploaded("dy_variance", images.dy_variance);
        result[i].samples = halves.samples[i];
    }
    return result;
}

} // namespace gradus
