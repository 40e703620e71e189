// <texture type="uniform"> or <spectrum type="uniform">: one number at all wavelengths.
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_texture_uniform() {
    return {"one number at all wavelengths; also as `<spectrum>`",
            joined({{Parameter{"value", Takes::number, "1", "it"}.at_least(0)},
                    meaningless({"wavelength_min", "wavelength_max"})})};
}

Texture texture_uniform(Properties &properties, SceneBuilder &) {
    const auto value = float(properties.number("value"));
    return one_color({value, value, value});
}

} // namespace gradus
