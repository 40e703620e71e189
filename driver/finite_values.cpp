#include "driver/finite_values.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gradus {

NonFinite settle_values(Image &image) {
    NonFinite found;
    std::vector<bool> is_bad(std::size_t(image.width) * image.height);
    for (Channel &channel : image.channels)
        for (std::size_t i = 0; i < channel.values.size(); ++i)
            if (!std::isfinite(channel.values[i])) {
                channel.values[i] = 0;
                is_bad[i] = true;
                ++found.values;
            }
    found.pixels = std::uint64_t(std::count(is_bad.begin(), is_bad.end(), true));
    return found;
}

} // namespace gradus
