// <shape type="obj">: a Wavefront OBJ file as one mesh, or as one for each of its materials.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/text.h"

#include <set>

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
        std::string names = properties.string(name);
        for (std::size_t end; (end = names.find(between)) != std::string::npos; names.erase(0, end + 1))
            faces.materials.insert(names.substr(0, end));
        faces.materials.insert(names);
    }
    return faces;
}

void check(const FacesOf &faces, MeshFile &file, const Location &location) {
    if (faces.materials.empty())
        return;
    const std::set<std::string> known = materials_of_obj(file.bytes());
    for (const std::string &material : faces.materials)
        if (!known.contains(material))
            throw SceneError(location, std::string("\"") + (faces.others ? "usemtl_other_than" : "usemtl") +
                                           "\": no face of " + file.path().string() + " has the material \"" +
                                           shortened(material, 40) + "\"");
}

/// The name under which an object is nested; empty where that says nothing.
std::string name_of(const Element &child) {
    const std::string name = child.attribute_or("name", "");
    return name == "bsdf" ? "" : name;
}

/// In 0.x each BSDF is that of the faces whose material has the name under which it is nested, and one without a name
/// that of all others: shapes like this one, with some of the faces each.
ShapeGroup shapes_by_material(Properties &properties, SceneBuilder &builder, MeshFile &file) {
    const Element &shape = properties.element();
    std::set<std::string> others = materials_of_obj(file.bytes());
    Element rest = shape;
    std::erase_if(rest.children, [&](const Element &child) { return builder.is_bsdf(child); });
    const auto with = [&rest](const Element *bsdf, const char *parameter, const std::string &value) {
        Element part = rest;
        if (!value.empty())
            part.children.push_back(
                {"string", {{"name", parameter}, {"value", value}}, {}, part.location, part.version});
        if (bsdf)
            part.children.push_back(*bsdf);
        return part;
    };
    ShapeGroup group;
    const Element *of_others = nullptr;
    std::string named;
    for (const Element &child : shape.children) {
        if (!builder.is_bsdf(child))
            continue;
        const std::string name = name_of(child);
        if (name.empty()) {
            of_others = &child;
        } else if (others.erase(name) > 0) {
            group.shapes.push_back(builder.keep(with(&child, "usemtl", name)));
            named += (named.empty() ? "" : std::string(1, between)) + name;
        } else {
            builder.diagnostics().warn(child.location,
                                       "no face of the file has the material \"" + name + "\": this BSDF is not used");
        }
    }
    if (!others.empty())
        group.shapes.push_back(builder.keep(with(of_others, "usemtl_other_than", named)));
    return group;
}

} // namespace

Declaration declare_shape_obj() {
    return {"a Wavefront OBJ file as one mesh; of 0.x with a BSDF for each name that its `usemtl` lines have",
            joined({{Parameter{"filename", Takes::filename, nullptr, "the file"}.required(),
                     {"flip_tex_coords", Takes::boolean, "true", "v becomes 1 − v"},
                     Parameter{"usemtl", Takes::string, nullptr, "the faces of this material alone"}.or_else("all"),
                     Parameter{"usemtl_other_than", Takes::string, nullptr, "the faces of all others"}.or_else("all")},
                    parameters_of_meshes(),
                    meaningless({"load_materials", "collapse", "shape_index"})})};
}

ShapeGeometry shape_obj(Properties &properties, SceneBuilder &builder) {
    const std::size_t bsdfs = properties.objects("bsdf").size();
    const bool is_by_material = properties.element().is_legacy() && bsdfs > 1;
    const FacesOf faces = faces_of(properties);
    const std::filesystem::path path = builder.find_file(properties);
    const std::shared_ptr<MeshFile> file = is_by_material || !faces.materials.empty()
                                               ? builder.shared_mesh_file(path, properties.location())
                                               : builder.mesh_file(path, properties.location());
    if (is_by_material)
        return shapes_by_material(properties, builder, *file);
    const bool flip = properties.boolean("flip_tex_coords"); // most files count v from the image's bottom
    // In 0.x the file's own materials count where the shape has none and nobody says otherwise.
    const bool is_missing_materials =
        properties.element().is_legacy() && !properties.has("load_materials") && bsdfs == 0 && faces.materials.empty();
    const Location location = properties.location_of(faces.others ? "usemtl_other_than" : "usemtl");
    return pending_shape_mesh(properties, [file, flip, faces, is_missing_materials, location] {
        const std::string &text = file->bytes();
        check(faces, *file, location);
        Mesh mesh = parse_obj(text, file->path().string(), file->place(), faces);
        if (flip)
            for (auto &[u, v] : mesh.texcoords)
                v = 1 - v;
        SerializedMesh read{std::move(mesh)};
        if (is_missing_materials && text.find("\nusemtl") != std::string::npos)
            read.warning = file->path().string() + " names materials of an MTL file, which is not read: the shape is " +
                           "gray; give it a BSDF";
        return read;
    });
}

} // namespace gradus
