// Which properties of a PLY file's vertices or faces are a mesh attribute, by Mitsuba 3's names.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

struct PlyPropertyName {
    std::string name;
    bool is_list = false;
    float largest = 0; ///< of a colour's number, which is worth 1; 0 where numbers are what they are
};

struct PlyAttribute {
    std::string name;                    ///< as textures name it
    std::vector<std::size_t> properties; ///< one or three, places in the list
    float unit = 1;                      ///< the number of the file that is worth 1
};

/// Of the wanted attributes those that an element has. prefix: "vertex_" or "face_". "color" is r, g and b or red,
/// green and blue; "name" is name_x, name_y and name_z, or name_0 to name_2, or name_1 to name_3; "name_color" also
/// name_r, name_g and name_b. Only the first of the three makes an attribute of one number. `error` becomes what is
/// wrong with one of them.
std::vector<PlyAttribute> find_ply_attributes(const std::string &prefix, const std::vector<PlyPropertyName> &properties,
                                              const std::vector<std::string> &wanted,
                                              std::optional<std::string> &error);

} // namespace gradus
