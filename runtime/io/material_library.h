// Material libraries of OBJ files (MTL), as Mitsuba 0.6 reads them.
#pragma once

#include "runtime/io/element.h"

#include <functional>
#include <map>
#include <set>
#include <string>

namespace gradus {

struct MaterialLibrary {
    std::map<std::string, Element> bsdfs;    ///< by material: what a scene file of version 0.x would say, at its line
    std::set<std::string> texture_options{}; ///< that were met, and have no meaning here
};

/// `newmtl` with Kd, Ks (encoded as sRGB), Ns, d, illum, map_Kd, map_Ks, map_d and bump; all else is skipped. illum 2
/// is `phong`, where it has Ks and Ns, 4, 6, 7 and 9 `dielectric`, 5 and 8 a `conductor` of aluminium, all others
/// `diffuse`. Textures that are not where they are named, as `is_there` tells, are named without their folders: many
/// files have paths of the machine that wrote them. Throws SceneError.
MaterialLibrary parse_mtl(const std::string &text, const std::string &file_name,
                          const std::function<bool(const std::string &)> &is_there);

} // namespace gradus
