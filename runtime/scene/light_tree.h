// A tree of lights, by which kernels choose among many (kernels/lib/light_tree.h).
#pragma once

#include "runtime/scene/transform.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gradus {

/// What a tree knows of a light: where it is and where it shines.
struct TreeLight {
    Double3 low{}, high{}; ///< of a box that holds it
    Double3 axis{};        ///< unit vector in the middle of its normals, or zero where it shines all around
    double half_angle = 0; ///< from the axis to the last normal; a normal shines by the cosine to it
    double intensity = 0;  ///< radiant intensity where it is largest, W/sr; positive
    std::uint32_t light = 0;
};

struct LightTree {
    std::uint32_t levels = 0;
    std::vector<std::uint32_t> nodes, leaves, slots; ///< as in kernels/shared/light_tree.h
    std::vector<std::uint32_t> leaf;                 ///< by light
    std::vector<float> probability;                  ///< by light: of being chosen in its leaf
    std::array<float, 3> origin{};                   ///< a place p is at (p - origin) scale in the tree's units
    float scale = 1;
};

/// Lights at infinity are in a leaf of their own, chosen by `far_weights`, which are by `far`. light_count: of all.
/// scene_extent: the longest side of what light is sent to; places further away than a million times the lights' box
/// would leave the range of the tree's units.
/// Splits are those of the least cost by power, orientation and size (Conty Estevez and Kulla 2018), as far as the
/// halves then fit into the levels below. Takes time O(n log n), on all cores, and is always the same tree.
LightTree make_light_tree(std::vector<TreeLight> lights, const std::vector<std::uint32_t> &far,
                          const std::vector<double> &far_weights, std::uint32_t light_count, double scene_extent);

} // namespace gradus
