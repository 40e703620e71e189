// <texture type="blackbody"> or <spectrum type="blackbody">: what a black body radiates.
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_texture_blackbody() {
    return {"what a black body radiates, in W/(m² sr nm); mostly as `<spectrum>`. In 0.x "
            "`<blackbody temperature=\"5000K\" scale=\"1\"/>`",
            joined({{Parameter{"temperature", Takes::number, nullptr, "its temperature"}
                         .in("kelvins")
                         .at_least(least_temperature)
                         .at_most(most_temperature)
                         .required(),
                     Parameter{"scale", Takes::number, "1", "a factor"}.at_least(0)},
                    meaningless({"lambda_min", "lambda_max", "wavelength_min", "wavelength_max"})})};
}

Texture texture_blackbody(Properties &properties, SceneBuilder &) {
    return one_color(spectrum_to_rgb(black_body_spectrum(properties.number("temperature")), ColorUse::emission),
                     float(properties.number("scale")));
}

} // namespace gradus
