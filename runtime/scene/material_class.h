// Materials whose textures, blends and maps are read in the same way. The stage `material` has a kernel for each class,
// which does what these materials need and nothing else.
#pragma once

#include "runtime/scene/traits.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gradus {

/// Textures of one use: which features they have, and numbers between which they all lie.
struct TextureUse {
    int features = 0; ///< bits of TRAIT_TEXTURES; 0: there is none
    std::uint32_t first = 0, last = 0;
};

struct MaterialClass {
    bool on_triangles = false, on_spheres = false, two_faced = false;
    int textured = 0;      ///< parameters that are textures, as in TRAIT_TEXTURED
    int all_textured = ~0; ///< those that all of them have as textures
    int lookups = 0;       ///< the most textures that one of them has for these
    int blends = 0;        ///< depth of nesting
    int blend_levels = 0;  ///< as TRAIT_BLEND_LEVELS
    int normals = 0;       ///< as TRAIT_TEXTURED_NORMALS
    TextureUse parameter, blend, normal;

    /// Blends and maps are left to the stage `material`, whoever reads textures.
    bool is_of_blends_or_maps() const { return blends > 0 || normals != 0; }
};

/// The classes of blends and maps, all of them.
constexpr std::uint32_t class_of_blends_and_maps = 0xFFFFFFFFu;

struct MaterialClasses {
    std::vector<MaterialClass> classes;
    /// By number of a material of the scene, the place in `classes`; 0 where no shape has it.
    std::vector<std::uint32_t> of_material;

    /// By which the kinds of a material that some shape has are kept apart: its place, or class_of_blends_and_maps.
    std::uint32_t of_kinds(std::size_t material) const {
        const std::uint32_t number = of_material[material];
        return classes[number].is_of_blends_or_maps() ? class_of_blends_and_maps : number;
    }
};

/// The classes of the materials that shapes have, at most `most` of them: those that are most alike go together.
MaterialClasses material_classes(const Scene &scene, std::size_t most);

/// Of all of these materials: what the scene's own traits say.
MaterialClass class_of_all_materials(const Scene &scene);

/// What the kernel of a class is compiled with (kernels/stages/material.cl).
std::map<std::string, std::string> definitions_of(const MaterialClass &one);

/// A BSDF kind on the materials of a class.
struct KindOfClass {
    std::string kind;
    std::uint32_t number; ///< of the class, as of_kinds() has it
};

/// Each kind that shapes have, on each class that it occurs in, kind by kind.
std::vector<KindOfClass> kinds_by_class(const Scene &scene, const MaterialClasses &classes);

} // namespace gradus
