// <shape type="obj">: a Wavefront OBJ file as one mesh, or as one for each of its materials.
#include "runtime/io/material_library.h"
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/text.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace gradus {

namespace {

/// Between names of materials in a parameter: no line of an OBJ file has it within one.
constexpr char between = '\n';

FacesOf faces_of(Properties &properties) {
    FacesOf faces;
    for (const char *name : {"usemtl", "usemtl_other_than"}) {
        if (!properties.has(name))
            continue;
        faces.others = std::string(name) != "usemtl";
        const std::string names = properties.string(name);
        std::size_t begin = 0;
        for (std::size_t end; (end = names.find(between, begin)) != std::string::npos; begin = end + 1)
            faces.materials.insert(names.substr(begin, end - begin));
        faces.materials.insert(names.substr(begin));
    }
    return faces;
}

void check(const FacesOf &faces, const ObjFile &obj, const std::string &path, const Location &location) {
    for (const std::string &material : faces.materials)
        if (!obj.has_material(material))
            throw SceneError(location, std::string("\"") + (faces.others ? "usemtl_other_than" : "usemtl") +
                                           "\": no face of " + path + " has the material \"" + shortened(material, 40) +
                                           "\"");
}

/// The name under which an object is nested; empty where that says nothing.
std::string name_of(const Element &child) {
    const std::string name = child.attribute_or("name", "");
    return name == "bsdf" ? "" : name;
}

/// The libraries one by one: a line whose whole is no file names several where one of its words is.
std::vector<ObjNames::Library> single_libraries(const ObjNames &names, const std::filesystem::path &obj,
                                                const SceneBuilder &builder) {
    constexpr std::size_t longest_line = 4096; // each word is looked for
    std::vector<ObjNames::Library> libraries;
    for (const ObjNames::Library &library : names.libraries) {
        if (library.name.size() > longest_line) {
            libraries.push_back(library);
            continue;
        }
        std::vector<ObjNames::Library> words;
        std::istringstream line(library.name);
        for (std::string word; line >> word;)
            words.push_back({word, library.line});
        const auto is_there = [&](const ObjNames::Library &one) { return builder.look_for(one.name, obj).has_value(); };
        if (!is_there(library) && std::ranges::any_of(words, is_there))
            libraries.insert(libraries.end(), words.begin(), words.end());
        else
            libraries.push_back(library);
    }
    return libraries;
}

/// BSDFs of the material libraries that a file names, by material.
std::map<std::string, Element> read_libraries(const ObjNames &names, MeshFile &file, const Location &shape,
                                              SceneBuilder &builder) {
    std::map<std::string, Element> bsdfs;
    std::set<std::string> read;
    const auto obj = std::make_shared<const std::string>(file.path().string());
    for (const auto &[name, line] : single_libraries(names, file.path(), builder)) {
        const Location location{obj, line};
        if (!read.insert(name).second)
            continue;
        const auto found = builder.look_for(name, file.path());
        if (!found) {
            builder.diagnostics().warn(location, "cannot find the material library \"" + shortened(name, 100) +
                                                     "\": its materials are gray");
            continue;
        }
        const auto opened = builder.mesh_file(found->path, shape);
        const std::string &text = opened->bytes();
        // Messages quote it, and a scene can name any file.
        if (lower_case(opened->place().extension().string()) != ".mtl") {
            builder.diagnostics().warn(location, "a material library is called .mtl: this one is not read");
            continue;
        }
        const Location library{std::make_shared<const std::string>(found->path.string())};
        MaterialLibrary materials = parse_mtl(text, *library.file, [&](const std::string &texture) {
            return builder.look_for(texture, found->path).has_value();
        });
        for (const std::string &option : materials.texture_options)
            builder.diagnostics().warn(library, "the option " + shortened(option, 20) + " of textures is not read");
        for (auto &[material, bsdf] : materials.bsdfs)
            bsdfs.insert_or_assign(material, std::move(bsdf));
    }
    return bsdfs;
}

/// Shapes like this one, with some of the faces each. In 0.x each BSDF is that of the faces whose material has the name
/// under which it is nested, and one without a name that of all others. `loads`: there is none such, and those of the
/// file's material libraries count. No shapes where all faces are to have the same.
ShapeGroup shapes_by_material(const Element &shape, bool loads, MeshFile &file, SceneBuilder &builder) {
    const ObjNames names = names_in_obj(file.bytes());
    std::map<std::string, const Element *> named;
    const Element *of_others = nullptr;
    Element rest = shape;
    std::erase_if(rest.children, [&](const Element &child) { return builder.is_bsdf(child); });
    const std::size_t bsdfs = shape.children.size() - rest.children.size();
    for (const Element &child : shape.children) {
        if (!builder.is_bsdf(child))
            continue;
        const std::string name = name_of(child);
        if (name.empty())
            of_others = &child;
        else if (names.materials.contains(name))
            named[name] = &child;
        else if (bsdfs == 1) // whatever its name is to say
            return {};
        else
            builder.diagnostics().warn(child.location,
                                       "no face of the file has the material \"" + name + "\": this BSDF is not used");
    }
    std::map<std::string, Element> libraries;
    if (loads)
        libraries = read_libraries(names, file, shape.location, builder);
    std::vector<std::string> others;
    for (const std::string &material : names.materials) {
        // One without a name is nobody's: the faces of "" have no material.
        if (const auto found = libraries.find(material); found != libraries.end() && !material.empty())
            named.insert({material, &found->second});
        if (!named.contains(material))
            others.push_back(material);
    }
    if (loads && others != std::vector<std::string>{""} && !others.empty())
        builder.diagnostics().warn(shape.location, "no material library of " + file.path().string() + " has " +
                                                       shortened(join(others), 200) +
                                                       ": give those faces a BSDF; they are gray");
    if (named.empty() && bsdfs < 2)
        return {};

    ShapeGroup group;
    const auto add = [&](const Element *bsdf, const char *parameter, const std::string &value) {
        Element part = rest;
        if (!value.empty())
            part.children.push_back(
                {"string", {{"name", parameter}, {"value", value}}, {}, part.location, part.version});
        if (bsdf)
            part.children.push_back(*bsdf);
        group.shapes.push_back(builder.keep(std::move(part)));
    };
    std::string all_named;
    for (const auto &[material, bsdf] : named) {
        add(bsdf, "usemtl", material);
        all_named += (all_named.empty() ? "" : std::string(1, between)) + material;
    }
    if (!others.empty())
        add(of_others, "usemtl_other_than", all_named);
    return group;
}

} // namespace

Declaration declare_shape_obj() {
    return {"a Wavefront OBJ file as one mesh; of 0.x with a BSDF for each name that its `usemtl` lines have",
            joined({{Parameter{"filename", Takes::filename, nullptr, "the file"}.required(),
                     {"flip_tex_coords", Takes::boolean, "true", "v becomes 1 − v"},
                     Parameter{"load_materials", Takes::boolean, "false",
                               "from its MTL files, for faces that have no BSDF otherwise"}
                         .before_2("true"),
                     Parameter{"usemtl", Takes::string, nullptr, "the faces of this material alone"}.or_else("all"),
                     Parameter{"usemtl_other_than", Takes::string, nullptr, "the faces of all others"}.or_else("all")},
                    parameters_of_meshes(),
                    // The first: which of an OBJ file's groups alone, in 0.6.
                    meaningless({"shape_index", "collapse"})})};
}

ShapeGeometry shape_obj(Properties &properties, SceneBuilder &builder) {
    const Element &shape = properties.element();
    const std::size_t bsdfs = properties.objects("bsdf").size();
    const bool is_for_all = std::any_of(shape.children.begin(), shape.children.end(), [&](const Element &child) {
        return builder.is_bsdf(child) && name_of(child).empty();
    });
    const bool loads = properties.boolean("load_materials") && !is_for_all;
    if (properties.has("shape_index"))
        properties.diagnostics().warn(properties.location_of("shape_index"),
                                      "shape_index of an OBJ file is not read: the shape is all of the file");
    const FacesOf faces = faces_of(properties);
    const bool is_part = !faces.materials.empty();
    // In later versions names of BSDFs say nothing, and a second one is an error, which the scene builder tells.
    const bool is_by_material = !is_part && (shape.is_legacy() ? bsdfs > 1 || loads : bsdfs == 0 && loads);
    const std::filesystem::path path = builder.find_file(properties);
    const std::shared_ptr<MeshFile> file = is_part || is_by_material
                                               ? builder.shared_mesh_file(path, properties.location())
                                               : builder.mesh_file(path, properties.location());
    if (is_by_material)
        if (ShapeGroup parts = shapes_by_material(shape, loads, *file, builder); !parts.shapes.empty())
            return parts;
    const bool flip = properties.boolean("flip_tex_coords"); // most files count v from the image's bottom
    const Location location = properties.location_of(faces.others ? "usemtl_other_than" : "usemtl");
    return pending_shape_mesh(properties, [file, flip, faces, is_part, location] {
        const std::string path = file->path().string();
        if (is_part)
            check(faces, file->obj(), path, location);
        Mesh mesh = is_part ? file->obj().mesh(faces) : parse_obj(file->bytes(), path, file->place());
        if (flip)
            turn_texcoords_over(mesh);
        return SerializedMesh{std::move(mesh)};
    });
}

} // namespace gradus
