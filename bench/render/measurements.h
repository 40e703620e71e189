// The measurements of gradus-bench-render, one file each. Each prints its table and returns the same as JSON. What is
// compared takes turns (A B A B), so that a machine that slows down slows both; medians over the turns count.
#pragma once

#include "bench/render/job.h"

namespace gradus::bench {

/// Render time against the time in which Embree alone traces the very same rays in the same order and packets: the
/// floor. Beside it the same rays in packets that are no beams, and one by one, as Embree is mostly called.
nlohmann::json measure_floor(const Settings &settings, const Job &job);

/// Kernels compiled for the scene against kernels with every trait on: time, and the largest difference of the images.
nlohmann::json measure_specialisation(const Settings &settings, const Job &job);

/// Light paths alone: how many a second, and their time over that of Embree on the same rays.
nlohmann::json measure_light_paths(const Settings &settings, const Job &job);

/// Shifts of chains alone (Hua et al. 2017, figure 4): L2 errors of gpm's gradients and of the differences of its
/// throughput, of its reconstruction and of the throughput itself, over passes, where no light counts but that of
/// photons that come from a specular or glossy surface. The samples a pixel are the longest render's passes.
nlohmann::json measure_chains(const Settings &settings, const Job &job);

/// What comes before a scene's first sample, without the device and its kernels: over a plain read of its files, its
/// pictures' decoding and Embree's building of its tree.
nlohmann::json measure_loading(const Settings &settings, const std::string &path);

/// Orders in which rays are traced.
nlohmann::json measure_ray_order(const Settings &settings, const Job &job);

} // namespace gradus::bench
