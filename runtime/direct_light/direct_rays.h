// What camera rays see of lights.
#pragma once

#include "runtime/scene/scene_tables.h"
#include "runtime/trace/camera_rays.h"
#include "runtime/trace/tracer.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus {

/// Of these at once.
constexpr std::size_t most_direct_rays = 1 << 16;

/// A batch at a time.
class DirectRays {
  public:
    /// Adds the rays that are traced to `rays`.
    DirectRays(const SceneTables &tables, Tracer &tracer, std::uint64_t &rays)
        : tables_(tables), tracer_(tracer), rays_(rays) {}

    /// The light along `count` rays: ray i goes through place(i). `as_one`: an
    /// environment's map is taken for one colour, since it changes everywhere and it is its border that is sought.
    template <class Place>
    const std::vector<lib_float::rgb> &trace(std::size_t count, bool as_one, const Place &place) {
        rays_ += camera_rays_.trace(tables_, tracer_, count, place);
        light_.resize(count);
        tracer_.in_parallel(count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                light_[i] = light_along(i, as_one);
        });
        return light_;
    }

  private:
    lib_float::rgb light_along(std::size_t i, bool as_one) const;
    lib_float::rgb textured(lib_float::rgb found, std::uint32_t light, std::uint32_t primitive,
                            const lib_float::primitive_hit &hit, bool as_one) const;

    const SceneTables &tables_;
    Tracer &tracer_;
    std::uint64_t &rays_;
    CameraRays camera_rays_;
    std::vector<lib_float::rgb> light_;
};

} // namespace gradus
