#include "runtime/scene/light_builder.h"

#include "kernels/shared/texture.h"
#include "runtime/scene/traits.h"

namespace gradus {

using namespace lib_float;

LightBuilder::LightBuilder(const Scene &scene, SceneTables &tables, bool has_textures)
    : scene_(scene), tables_(tables), has_textures_(has_textures) {
    for_each_light_texture(scene, [&](const Emitter &emitter, int) {
        if (emitter.texture != no_texture)
            stand_in_ = std::uint32_t(emitter.texture);
    });
}

Rgb LightBuilder::mean_of(const Emitter &emitter) {
    if (emitter.texture == no_texture)
        return emitter.value;
    auto known = means_.find(emitter.texture);
    if (known == means_.end()) {
        const auto mean = texture_range(scene_.textures[std::size_t(emitter.texture)]).mean;
        known = means_.emplace(emitter.texture, Rgb{float(mean[0]), float(mean[1]), float(mean[2])}).first;
    }
    const Rgb &mean = known->second;
    return {emitter.value.r * mean.r, emitter.value.g * mean.g, emitter.value.b * mean.b};
}

void LightBuilder::add_texture(const Emitter &emitter) {
    const auto width = [](const Vector3 &axis, float size) {
        return Vector3{axis.x / size, axis.y / size, axis.z / size};
    };
    const bool has_picture = emitter.kind == Emitter::Kind::spot || emitter.kind == Emitter::Kind::projector;
    const Vector3 u = has_picture ? width(emitter.axes[0], emitter.picture[0]) : Vector3{};
    const Vector3 v = has_picture ? width(emitter.axes[1], emitter.picture[1]) : Vector3{};
    const Rgb mean = mean_of(emitter);
    const std::uint32_t texture =
        emitter.texture == no_texture ? texture_absent | stand_in_ : std::uint32_t(emitter.texture);
    tables_.light_textures.insert(tables_.light_textures.end(), {texture, 0, 0});
    tables_.light_pictures.insert(tables_.light_pictures.end(), {u.x, u.y, u.z, v.x, v.y, v.z});
    tables_.light_means.insert(tables_.light_means.end(), {mean.r, mean.g, mean.b});
}

std::uint32_t LightBuilder::add(light_kind kind, Rgb value, LightPower power, float *&record) {
    const std::size_t number = powers_.size();
    powers_.push_back(power);
    emitted_.push_back({power.power, power.emitter, false});
    tables_.light_kinds.push_back(kind);
    tables_.lights.resize((number + 1) * light_stride, 0.0f);
    record = &tables_.lights[number * light_stride];
    record[light_value_r] = value.r;
    record[light_value_g] = value.g;
    record[light_value_b] = value.b;
    if (has_textures_)
        add_texture(scene_.emitters[power.emitter]);
    return static_cast<std::uint32_t>(number);
}

void LightBuilder::set_triangle(std::uint32_t light, std::uint32_t triangle) {
    if (has_textures_)
        tables_.light_textures[std::size_t(light) * light_texture_stride + light_texture_triangle] = triangle;
}

void LightBuilder::set_sphere(std::uint32_t light, std::uint32_t sphere) {
    if (has_textures_)
        tables_.light_textures[std::size_t(light) * light_texture_stride + light_texture_sphere] = sphere;
}

void LightBuilder::set_mean(std::uint32_t light, const Rgb &mean) {
    float *to = &tables_.light_means[std::size_t(light) * 3];
    to[0] = mean.r;
    to[1] = mean.g;
    to[2] = mean.b;
}

void LightBuilder::set_environment(double emitted) {
    tables_.environment_light = static_cast<std::uint32_t>(powers_.size() - 1);
    emitted_.back().power = emitted;
    has_environment_ = true;
}

void LightBuilder::finish() {
    tables_.light_count = static_cast<std::uint32_t>(powers_.size());
    // A black light follows the last: what the environment is where there is none.
    tables_.lights.resize((powers_.size() + 1) * light_stride, 0.0f);
    if (has_textures_)
        add_texture(Emitter());
    if (!has_environment_)
        tables_.environment_light = tables_.light_count;
    if (powers_.empty())
        return;
    const AliasTable alias = make_alias_table(light_weights(powers_));
    for (std::size_t i = 0; i < powers_.size(); ++i) {
        tables_.lights[i * light_stride + light_probability] = alias.probability[i];
        tables_.lights[i * light_stride + light_alias_threshold] = alias.threshold[i];
    }
    tables_.light_alias = alias.alias;
    const AliasTable emission = make_alias_table(light_weights(emitted_));
    tables_.emissions.resize(emitted_.size() * emission_stride);
    for (std::size_t i = 0; i < emitted_.size(); ++i) {
        tables_.emissions[i * emission_stride + emission_probability] = emission.probability[i];
        tables_.emissions[i * emission_stride + emission_alias_threshold] = emission.threshold[i];
    }
    tables_.emission_alias = emission.alias;
}

} // namespace gradus
