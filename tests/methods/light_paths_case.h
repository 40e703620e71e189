// Light paths of a scene, without a method that gathers them.
#pragma once

#include "methods/path_stages.h"
#include "methods/photons/light_paths.h"
#include "runtime/wavefront/host_table.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

#include <array>
#include <optional>
#include <vector>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/tables.h"

namespace gradus::testing {

struct Photon {
    std::array<double, 3> position, wi, power, normal;
    std::uint32_t slot, depth;
    bool operator==(const Photon &) const = default;
};

class LightPathsCase {
  public:
    explicit LightPathsCase(const Scene &scene, const RenderOptions &options = {},
                            LightPaths::Direct direct = LightPaths::Direct::photons)
        : session_(shared_device(), scene, options, {}), paths(session_, stages_, scene, options, direct),
          tables_(shared_device(), paths.tables(), {}, options.precision) {
        paths.attach(tables_);
    }

    std::vector<Photon> trace(std::uint64_t first_path, std::uint32_t count) {
        using namespace lib_float;
        const std::uint32_t stored = paths.trace(first_path, count);
        const HostTable table(tables_["photon"], tables_.rows_of("photon"), tables_.precision());
        const HostTable origin(tables_["photon_origin"], tables_.rows_of("photon_origin"), tables_.precision());
        const auto order = tables_["photon_order"].map(Access::read);
        std::vector<Photon> photons;
        for (std::uint32_t i = 0; i < stored; ++i) {
            const std::uint32_t row = order.as<std::uint32_t>()[i];
            Photon &photon = photons.emplace_back();
            for (int axis = 0; axis < 3; ++axis) {
                photon.position[axis] = table.real(photon_position_x + axis, row);
                photon.wi[axis] = table.real(photon_wi_x + axis, row);
                photon.power[axis] = table.real(photon_power_r + axis, row);
                photon.normal[axis] = table.real(photon_normal_x + axis, row);
            }
            photon.slot = origin.uint(photon_origin_slot, row);
            photon.depth = table.uint(photon_depth, row);
        }
        return photons;
    }

  private:
    Session session_;
    Stages stages_;

  public:
    LightPaths paths;

  private:
    Tables tables_;
};

/// The flux of those photons that `counts` accepts, by light path: its mean and standard error. Times `weight`.
template <class Counts>
Spread flux(const std::vector<Photon> &photons, std::uint32_t light_paths, Counts counts, int channel = 1) {
    std::vector<double> by_path(light_paths, 0.0);
    for (const Photon &photon : photons)
        by_path[photon.slot] += photon.power[channel] * double(counts(photon));
    return spread_of(by_path);
}

} // namespace gradus::testing
