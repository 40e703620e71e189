// <sampler>: of any type its count is taken; the methods bring their own random numbers.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_sampler_any() {
    return {"a sampler of any type; its other parameters pass in silence",
            {Parameter{"sample_count", Takes::integer, "4", "samples a pixel"}.at_least(1).at_most(
                double(std::int64_t(1) << 40))}};
}

SampleCount sampler_any(Properties &properties, SceneBuilder &) {
    return {std::uint64_t(properties.integer("sample_count"))};
}

} // namespace gradus
