#include "runtime/scene/light_builder.h"

#include "kernels/shared/texture.h"
#include "runtime/scene/traits.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace gradus {

using namespace lib_float;

namespace {
constexpr double pi = std::numbers::pi;
}

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

TreeLight LightBuilder::tree_light(std::uint32_t light) {
    const float *record = &tables_.lights[std::size_t(light) * light_stride];
    const auto vector = [&](int field) { return Double3{record[field], record[field + 1], record[field + 2]}; };
    const Double3 p = vector(light_p_x);
    TreeLight result{p, p, {}, pi, 0, light};
    switch (tables_.light_kinds[light]) {
    case light_kind_triangle: {
        const Double3 e1 = vector(light_e1_x), e2 = vector(light_e2_x);
        for (const Double3 &corner : {gradus::add(p, e1), gradus::add(p, e2)})
            for (int i = 0; i < 3; ++i) {
                result.low[i] = std::min(result.low[i], corner[i]);
                result.high[i] = std::max(result.high[i], corner[i]);
            }
        result.axis = normalize(cross(e1, e2));
        result.half_angle = 0;
        result.intensity = powers_[light].power / pi;
        break;
    }
    case light_kind_sphere: {
        const double radius = record[light_e1_x];
        result.low = subtract(p, {radius, radius, radius});
        result.high = gradus::add(p, {radius, radius, radius});
        result.intensity = powers_[light].power / (4 * pi);
        break;
    }
    case light_kind_point:
        result.intensity = powers_[light].power / (4 * pi);
        break;
    default: { // a spot or a projector
        const Emitter &emitter = scene_.emitters[powers_[light].emitter];
        const Rgb mean = mean_of(emitter);
        result.axis = vector(light_e1_x);
        result.half_angle = tables_.light_kinds[light] == light_kind_spot
                                ? double(emitter.cutoff)
                                : std::atan(std::hypot(emitter.picture[0], emitter.picture[1]) / 2);
        result.intensity = luminance(mean);
    }
    }
    return result;
}

void LightBuilder::grow_tree(const std::vector<double> &weights) {
    std::vector<TreeLight> near;
    std::vector<std::uint32_t> far;
    std::vector<double> far_weights;
    double far_weight = 0, all = 0;
    for (std::uint32_t i = 0; i < powers_.size(); ++i) {
        all += weights[i];
        if (powers_[i].at_infinity) {
            far.push_back(i);
            far_weights.push_back(weights[i]);
            far_weight += weights[i];
        } else {
            near.push_back(tree_light(i));
        }
    }
    LightTree tree = make_light_tree(std::move(near), far, far_weights, tables_.light_count, tables_.bounds.extent());
    const double share = far_weight / all;
    for (std::uint32_t i = 0; i < powers_.size(); ++i)
        tables_.lights[std::size_t(i) * light_stride + light_probability] =
            float(tree.probability[i] * (powers_[i].at_infinity ? share : 1 - share));
    tables_.light_tree = std::move(tree);
    tables_.light_share_at_infinity = float(share);
}

bool LightBuilder::wants_tree(const LightTreeFrom &from) const {
    std::size_t lights = 0;
    std::set<std::uint32_t> emitters;
    for (const LightPower &power : powers_)
        if (!power.at_infinity) {
            ++lights;
            emitters.insert(power.emitter);
        }
    return lights > 0 && (lights >= from.lights || emitters.size() >= from.emitters);
}

void LightBuilder::finish(const LightTreeFrom &tree_from) {
    tables_.light_count = static_cast<std::uint32_t>(powers_.size());
    // A black light follows the last: what the environment is where there is none.
    tables_.lights.resize((powers_.size() + 1) * light_stride, 0.0f);
    if (has_textures_)
        add_texture(Emitter());
    if (!has_environment_)
        tables_.environment_light = tables_.light_count;
    if (powers_.empty())
        return;
    const std::vector<double> weights = light_weights(powers_);
    const AliasTable alias = make_alias_table(weights);
    for (std::size_t i = 0; i < powers_.size(); ++i) {
        tables_.lights[i * light_stride + light_probability] = alias.probability[i];
        tables_.lights[i * light_stride + light_alias_threshold] = alias.threshold[i];
    }
    tables_.light_alias = alias.alias;
    if (wants_tree(tree_from))
        grow_tree(weights);
    const AliasTable emission = make_alias_table(light_weights(emitted_));
    tables_.emissions.resize(emitted_.size() * emission_stride);
    for (std::size_t i = 0; i < emitted_.size(); ++i) {
        tables_.emissions[i * emission_stride + emission_probability] = emission.probability[i];
        tables_.emissions[i * emission_stride + emission_alias_threshold] = emission.threshold[i];
    }
    tables_.emission_alias = emission.alias;
}

} // namespace gradus
