#include "solver/fill.h"

#include <utility>

namespace gradus::solver {

void Fill::run(Buffer &image, const Buffer &valid) {
    const Grid &grid = workspace_.grid();
    Sums &sums = workspace_.sums;
    if (!valid_.valid()) {
        other_image_ = workspace_.make.planes("filled_image", grid, workspace_.channels);
        valid_ = workspace_.make.planes("filled_valid", grid, 1);
        other_valid_ = workspace_.make.planes("filled_valid", grid, 1);
    }
    Kernels &kernels = workspace_.any_kernels();
    Kernel &ring = kernels.fill_ring;
    const Buffer *from = &valid;
    double left = -1;
    for (;;) {
        sums.bind_parts(ring, 1);
        ring.bind("image", image);
        ring.bind("valid", *from);
        ring.bind("filled_image", other_image_);
        ring.bind("filled_valid", other_valid_);
        grid.launch(ring, {0, 1});
        sums.sum(kernels, slot_sum, {0, 1});
        std::swap(image, other_image_);
        std::swap(valid_, other_valid_);
        from = &valid_;
        const double now = sums.read(slot_sum, 0);
        if (now == 0 || now == left)
            return;
        left = now;
    }
}

} // namespace gradus::solver
