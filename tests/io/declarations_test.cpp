// What plugins declare is what they read: each parameter of each plugin, in both dialects, changes what is loaded, and
// is refused where it is rubbish. A new parameter is tested by its declaration alone; one that needs something beside
// it, or a value that its type does not tell, has a line in the lists below, without which it fails.
#include "runtime/io/image_io.h"
#include "runtime/io/plugins/catalogue.h"
#include "runtime/io/text.h"
#include "tests/io/mesh_text.h"
#include "tests/io/scene_print.h"
#include "tests/io/scene_text.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace gradus {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

const std::string diffuse = "<bsdf type=\"diffuse\"/>", metal = "<bsdf type=\"conductor\"/>";
const std::string board = "<texture type=\"checkerboard\"/>", cube = "<shape type=\"cube\"/>";
const std::string picture = "<texture type=\"bitmap\"><string name=\"filename\" value=\"a.png\"/></texture>";
const std::string lamp = "<emitter type=\"area\"/>", white = "<rgb name=\"irradiance\" value=\"1\"/>";

std::string named(const std::string &tag, const std::string &name, const std::string &value) {
    return "<" + tag + " name=\"" + name + "\" value=\"" + value + "\"/>";
}
std::string file(const std::string &name) { return named("string", "filename", name); }

/// What a plugin must have within it.
const std::map<std::string, std::string> needed = {
    {"bsdf blendbsdf", diffuse + metal},
    {"bsdf bumpmap", picture + diffuse},
    {"bsdf mixturebsdf", named("string", "weights", "0.25 0.75") + diffuse + metal},
    {"bsdf normalmap", picture + diffuse},
    {"bsdf mask", diffuse},
    {"bsdf twosided", diffuse},
    {"emitter envmap", file("a.png")},
    {"emitter projector", white},
    {"sensor thinlens", named("float", "aperture_radius", "1")},
    {"shape instance", "<shape type=\"shapegroup\">" + cube + "</shape>"},
    {"shape merge", cube},
    {"shape shapegroup", cube},
    {"shape obj", file("a.obj")},
    {"shape ply", file("a.ply")},
    {"shape serialized", file("a.serialized")},
    {"texture bitmap", file("a.png")},
    {"texture blackbody", named("float", "temperature", "1500")},
    {"texture mesh_attribute", named("string", "name", "vertex_color")},
    {"texture scale", board},
};

/// What a parameter needs beside it to count.
const std::map<std::string, std::string> beside = {
    {"bsdf conductor eta", named("rgb", "k", "2")},
    {"bsdf conductor k", named("rgb", "eta", "2")},
    {"bsdf conductor ext_eta", named("rgb", "eta", "2") + named("rgb", "k", "2")},
    {"bsdf roughconductor eta", named("rgb", "k", "2")},
    {"bsdf roughconductor k", named("rgb", "eta", "2")},
    {"bsdf roughconductor ext_eta", named("rgb", "eta", "2") + named("rgb", "k", "2")},
    {"bsdf phong ensure_energy_conservation", named("rgb", "diffuse_reflectance", "0.9")},
    {"bsdf ward ensure_energy_conservation", named("rgb", "diffuse_reflectance", "0.9")},
    {"emitter projector fov_axis", named("float", "fov", "30") + named("rgb", "irradiance", "2")},
    {"sensor perspective fov_axis", named("float", "fov", "30")},
    {"sensor thinlens fov_axis", named("float", "fov", "30")},
};

/// Objects that stand in place of those that are needed.
const std::map<std::string, std::string> instead = {
    {"bsdf blendbsdf bsdf", metal + metal},
    {"bsdf bumpmap texture", board + diffuse},
    {"bsdf mixturebsdf bsdf", named("string", "weights", "0.25 0.75") + metal + metal},
    {"bsdf bumpmap bsdf", picture + metal},
    {"bsdf normalmap texture", board + diffuse},
    {"bsdf normalmap bsdf", picture + metal},
    {"bsdf mask bsdf", metal},
    {"bsdf twosided bsdf", metal},
    {"bsdf twosided allow_transmission",
     named("boolean", "allow_transmission", "true") + "<bsdf type=\"thindielectric\"/>"},
    {"shape instance shape", "<shape type=\"shapegroup\">" + cube + cube + "</shape>"},
    {"shape merge shape", cube + cube},
    {"shape shapegroup shape", cube + cube},
    {"texture scale texture", picture},
};

/// Values that its type does not tell.
const std::map<std::string, std::string> values = {
    {"bsdf conductor eta", named("rgb", "eta", "1 2 3") + named("rgb", "k", "2")},
    {"bsdf conductor k", named("spectrum", "k", "2") + named("float", "eta", "0")},
    {"bsdf roughconductor eta", named("rgb", "eta", "1 2 3") + named("rgb", "k", "2")},
    {"bsdf roughconductor k", named("spectrum", "k", "2") + named("float", "eta", "0")},
    {"bsdf conductor material", named("string", "material", "Al")},
    {"bsdf roughconductor material", named("string", "material", "Al")},
    {"bsdf mixturebsdf weights", named("string", "weights", "0.5 0.25") + diffuse + metal},
    {"bsdf roughplastic alpha_u", named("float", "alpha_u", "0.3") + named("float", "alpha_v", "0.3")},
    {"bsdf roughplastic alpha_v", named("float", "alpha_v", "0.3") + named("float", "alpha_u", "0.3")},
    {"emitter projector focal_length", named("string", "focal_length", "80mm")},
    {"sensor perspective focal_length", named("string", "focal_length", "80mm")},
    {"sensor thinlens focal_length", named("string", "focal_length", "80mm")},
    {"shape obj usemtl", named("string", "usemtl", "x")},
    {"shape obj usemtl_other_than", named("string", "usemtl_other_than", "x")},
    {"texture bitmap channel", named("string", "channel", "g")},
    {"emitter envmap gamma", named("float", "gamma", "1")},
    {"texture bitmap gamma", named("float", "gamma", "1")},
    {"texture mesh_attribute name", named("string", "name", "vertex_other")},
    // Nested objects.
    {"emitter spot texture", board},
    {"film hdrfilm rfilter", "<rfilter type=\"box\"/>"},
    {"sensor film", "<film type=\"hdrfilm\"><integer name=\"width\" value=\"5\"/></film>"},
    {"sensor sampler", "<sampler type=\"independent\"><integer name=\"sample_count\" value=\"5\"/></sampler>"},
    {"shape bsdf", metal},
    {"shape emitter", lamp},
};

std::string camel_case(const std::string &name) {
    std::string text;
    for (std::size_t i = 0; i < name.size(); ++i)
        text += name[i] == '_' && i + 1 < name.size() ? char(std::toupper(name[++i])) : name[i];
    return text;
}

class Declarations : public testing::Test {
  protected:
    void SetUp() override {
        Mesh mesh = folded_square();
        folder_.write("a.serialized", serialized_file({mesh, Mesh{mesh.positions, {}, {}, {{0, 1, 2}}, {}}}, {}));
        folder_.write("b.serialized", serialized_file({Mesh{mesh.positions, {}, {}, {{0, 1, 2}}, {}}}, {}));
        for (const std::string name : {"a", "b"}) {
            const std::string corner = name == "a" ? "0 1 0.5" : "0 2 0";
            folder_.write(name + ".mtl", "newmtl x\nKd 1 0 0\n");
            folder_.write(name + ".obj", "mtllib " + name + ".mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv " + corner +
                                             "\nvt 0 0.25\nvt 1 0\nf 1/1 2/2 3/1\nusemtl x\nf 1/1 3/2 4/1\n");
            folder_.write(
                name + ".ply",
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
                "z\nproperty float s\nproperty float t\nproperty float r\nproperty float g\nproperty float "
                "b\nproperty float other_x\nproperty float other_y\nproperty float other_z\nelement face "
                "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0.25 0.5 0.2 0.1 1 1 1\n1 0 0 "
                "1 0 0.5 0.2 0.1 1 1 1\n1 1 0 1 1 0.5 0.2 0.1 1 1 1\n" +
                    corner + " 0 1 0.5 0.2 0.1 1 1 1\n4 0 1 2 3\n");
            Image image;
            image.width = 2;
            image.height = 1;
            const float first = name == "a" ? 0.25f : 0.75f;
            image.channels = {{"R", {first, 1}}, {"G", {0.5f, 1}}, {"B", {1, 0.125f}}};
            write_image(image, (folder_.path() / (name + ".exr")).string());
            write_png(image, (folder_.path() / (name + ".png")).string());
        }
    }

    /// The scene of one plugin with what stands in it, which begins on line 4.
    std::string scene_of(const CataloguedPlugin &plugin, const std::string &inside, const std::string &version) const {
        const std::string object = "\n\n<" + plugin.category + " type=\"" + plugin.name + "\"" +
                                   (plugin.category == "shape" ? " id=\"it\"" : "") + ">\n" + inside + "</" +
                                   plugin.category + ">";
        return "<scene version=\"" + version + "\">" + around(plugin, object) + "</scene>";
    }
    std::string around(const CataloguedPlugin &plugin, const std::string &object) const {
        const std::string &category = plugin.category;
        const std::string sensor = "<sensor type=\"perspective\"/>", sky = "<emitter type=\"constant\"/>";
        // A mesh with attributes, whose colours are wanted.
        const std::string wants = "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"mesh_attribute\">" +
                                  named("string", "name", "vertex_color") + "</texture></bsdf>";
        if (category == "sensor")
            return object + cube + sky;
        if (category == "film" || category == "sampler")
            return "<sensor type=\"perspective\">" + object + "</sensor>" + cube + sky;
        if (category == "rfilter")
            return "<sensor type=\"perspective\"><film type=\"hdrfilm\">" + object + "</film></sensor>" + cube + sky;
        if (category == "bsdf")
            return "<shape type=\"cube\">" + object + "</shape>" + sensor + sky;
        if (category == "texture")
            return "<shape type=\"ply\">" + object_as_reflectance(object) + file("a.ply") + "</shape>" + sensor + sky;
        if (plugin.name == "shapegroup")
            return object + "<shape type=\"instance\"><ref id=\"it\"/></shape>" + sensor + sky;
        if (plugin.name == "ply" && category == "shape" && object.find("<bsdf") == std::string::npos)
            return insert_before_end(object, wants) + sensor + sky;
        if (category == "emitter" && plugin.name == "area")
            return "<shape type=\"rectangle\">" + object + "</shape>" + sensor;
        return object + sensor + cube + (category == "emitter" ? "" : sky);
    }
    static std::string insert_before_end(std::string object, const std::string &what) {
        return object.insert(object.rfind("</"), what);
    }
    static std::string object_as_reflectance(std::string object) {
        object.insert(object.find(" type="), " name=\"reflectance\"");
        return "<bsdf type=\"diffuse\">" + object + "</bsdf>";
    }

    static std::string found(const std::map<std::string, std::string> &list, const CataloguedPlugin &plugin,
                             const std::string &parameter) {
        for (const std::string &key :
             {plugin.category + " " + plugin.name + " " + parameter, plugin.category + " " + parameter})
            if (const auto entry = list.find(key); entry != list.end())
                return entry->second;
        return "";
    }
    /// What the plugin must have but for the parameter itself.
    static std::string needed_for(const CataloguedPlugin &plugin, const std::string &parameter) {
        const auto entry = needed.find(plugin.category + " " + plugin.name);
        std::string rest = entry == needed.end() ? "" : entry->second;
        if (rest.find("name=\"" + parameter + "\"") != std::string::npos)
            rest = "";
        return rest;
    }
    static std::string rest_for(const CataloguedPlugin &plugin, const std::string &parameter) {
        return found(beside, plugin, parameter) + needed_for(plugin, parameter);
    }
    std::string printed(const CataloguedPlugin &plugin, const std::string &inside, const std::string &version) {
        LoadOptions options;
        options.strict = true; // what is not known is an error
        const std::string text = scene_of(plugin, inside, version);
        try {
            return ScenePrint(load_scene(folder_.write("scene.xml", text), options).scene).text();
        } catch (const Error &error) {
            ADD_FAILURE() << error.what() << "\n" << text;
            return "";
        }
    }

    /// Elements that say something else than the default: that any of them counts is enough, but all must be read.
    static std::vector<std::string> other_values(const CataloguedPlugin &plugin, const Parameter &parameter,
                                                 const std::string &name, bool is_old) {
        if (const std::string value = found(values, plugin, parameter.name); !value.empty())
            return {value};
        const char *otherwise =
            is_old && parameter.otherwise_before_2 ? parameter.otherwise_before_2 : parameter.otherwise;
        const std::string normal = otherwise ? otherwise : "";
        const auto color = [&](bool may_be_texture) {
            std::vector<std::string> list = {named("rgb", name, "0.1 0.2 0.3"),
                                             named("spectrum", name, "400:0.1, 700:0.7")};
            if (may_be_texture)
                list.push_back("<texture name=\"" + name + "\" type=\"checkerboard\"/>");
            return list;
        };
        switch (parameter.takes) {
        case Takes::number:
        case Takes::textured_number: {
            const double least = std::max(parameter.lowest, -1e3), most = std::min(parameter.highest, 1e3);
            double value = parse_number(normal).value_or(1) * 0.75 + 0.1;
            value = std::clamp(value, least, most);
            std::vector<std::string> list = {named("float", name, std::to_string(value))};
            if (parameter.takes == Takes::textured_number)
                list.push_back("<texture name=\"" + name + "\" type=\"checkerboard\"/>");
            return list;
        }
        case Takes::integer:
            return {named("integer", name, std::to_string(parse_integer(normal).value_or(6) + 1))};
        case Takes::boolean:
            return {named("boolean", name, normal == "true" ? "False" : "true")};
        case Takes::choice: {
            std::vector<std::string> list;
            for (const std::string &word : parameter.words)
                list.push_back(named("string", name, word));
            return list;
        }
        case Takes::filename: {
            const auto rest = needed.find(plugin.category + " " + plugin.name);
            std::string value = rest == needed.end() ? "" : rest->second;
            if (const std::size_t place = value.find("a."); place != std::string::npos)
                value[place] = 'b';
            return {value};
        }
        case Takes::point:
            return {named("point", name, "0.5 0.25 2"), "<vector name=\"" + name + "\" x=\"0.5\" y=\"0.25\" z=\"2\"/>"};
        case Takes::transform:
            return {"<transform name=\"" + name +
                    "\"><rotate x=\"1\" y=\"1\" angle=\"30\"/><translate x=\"1\" "
                    "y=\"2\" z=\"3\"/></transform>"};
        case Takes::reflectance:
        case Takes::textured_emission:
            return color(true);
        case Takes::emission:
        case Takes::color:
        case Takes::signed_color:
            return color(false);
        case Takes::refractive_index:
            return {named("float", name, "1.7"), named("string", name, "diamond")};
        case Takes::nothing:
            return {named("float", name, "0.5")};
        case Takes::string:
        case Takes::objects:
            break;
        }
        return {};
    }

    template <typename Visit>
    void for_each_parameter(const Visit &visit) {
        for (const CataloguedPlugin &plugin : plugin_catalogue())
            for (const Parameter &parameter : plugin.declaration.parameters) {
                SCOPED_TRACE(plugin.category + " " + plugin.name + ": " + parameter.name);
                visit(plugin, parameter);
            }
    }

    TemporaryFolder folder_;
};

bool is_of_media(const Parameter &parameter) {
    return parameter.takes == Takes::objects &&
           (parameter.name == "medium" || parameter.name == "subsurface" || parameter.name == "volume");
}

TEST_F(Declarations, EachParameterCountsInBothDialects) {
    int count = 0;
    for_each_parameter([&](const CataloguedPlugin &plugin, const Parameter &parameter) {
        if (is_of_media(parameter))
            return;
        for (const bool is_old : {false, true}) {
            if (parameter.is_of_before_2 && !is_old)
                continue;
            const std::string version = is_old ? "0.6.0" : "3.0.0";
            std::vector<std::string> names = {parameter.name};
            if (parameter.also_named)
                names.push_back(parameter.also_named);
            for (const std::string &plain : names) {
                const std::string name = is_old ? camel_case(plain) : plain;
                std::vector<std::string> others = other_values(plugin, parameter, name, is_old);
                const std::string whole = found(instead, plugin, parameter.name);
                if (!whole.empty())
                    others = {whole};
                ASSERT_FALSE(others.empty()) << "a new parameter needs a line in the lists of this test";
                // Of what is required the others must differ among themselves.
                const bool is_told = !found(values, plugin, parameter.name).empty();
                const std::string without =
                    is_told ? needed_for(plugin, parameter.name) : rest_for(plugin, parameter.name);
                const auto plain_case = needed.find(plugin.category + " " + plugin.name);
                const std::string base = printed(
                    plugin, parameter.is_required ? (plain_case == needed.end() ? "" : plain_case->second) : without,
                    version);
                bool counts = false;
                for (const std::string &other : others) {
                    counts |= printed(plugin, whole.empty() ? other + without : whole, version) != base;
                }
                EXPECT_EQ(counts, parameter.takes != Takes::nothing) << others.front() << " in " << version;
                ++count;
            }
        }
    });
    EXPECT_GT(count, 400);
}

/// Values that are none of the type, and those out of bounds.
std::vector<std::string> wrong_values(const Parameter &parameter) {
    const std::string &name = parameter.name;
    std::vector<std::string> list;
    switch (parameter.takes) {
    case Takes::point:
        list = {named("point", name, "1 2 rubbish"), named("float", name, "1")};
        break;
    case Takes::transform:
        list = {named("float", name, "1"),
                "<transform name=\"" + name + "\"><rotate x=\"rubbish\" angle=\"1\"/></transform>"};
        break;
    case Takes::reflectance:
    case Takes::emission:
    case Takes::textured_emission:
    case Takes::color:
    case Takes::signed_color:
        list = {named("rgb", name, "rubbish"), named("rgb", name, "1 2"), named("string", name, "1"),
                named("spectrum", name, "500:rubbish")};
        if (parameter.takes != Takes::signed_color)
            list.push_back(named("rgb", name, "-1"));
        break;
    case Takes::objects:
    case Takes::nothing:
        return {};
    default:
        list = {named("string", name, "rubbish"), "<string name=\"" + name + "\"/>",
                "<transform name=\"" + name + "\"/>"};
    }
    constexpr double large = 1e12; // bounds beyond are there for the arithmetic alone
    if (parameter.lowest > -large)
        list.push_back(named("float", name, std::to_string(parameter.lowest - 1)));
    if (parameter.highest < large)
        list.push_back(named("float", name, std::to_string(parameter.highest + 1)));
    return list;
}

TEST_F(Declarations, RubbishIsRefusedWhereItStands) {
    int count = 0;
    for_each_parameter([&](const CataloguedPlugin &plugin, const Parameter &parameter) {
        for (const std::string &wrong : wrong_values(parameter)) {
            const std::string text = scene_of(plugin, wrong + rest_for(plugin, parameter.name), "3.0.0");
            const std::string message = error_of(folder_.write("scene.xml", text));
            EXPECT_THAT(message, HasSubstr("scene.xml:4: ")) << text;
            EXPECT_THAT(message, AnyOf(HasSubstr(parameter.name), HasSubstr("rubbish"))) << text;
            ++count;
        }
    });
    EXPECT_GT(count, 600);
}

TEST_F(Declarations, WhatIsRequiredIsAskedFor) {
    for_each_parameter([&](const CataloguedPlugin &plugin, const Parameter &parameter) {
        if (!parameter.is_required)
            return;
        const std::string message = error_of(folder_.write("scene.xml", scene_of(plugin, "", "3.0.0")));
        EXPECT_THAT(message, HasSubstr("scene.xml:3: " + plugin.name + " needs a"));
        EXPECT_THAT(message, HasSubstr(parameter.name));
    });
}

/// Names of other plugins' parameters are unknown in this one: the list that is read is the list that is declared.
TEST_F(Declarations, WhatIsNotDeclaredIsUnknown) {
    LoadOptions options;
    options.strict = true;
    for (const CataloguedPlugin &plugin : plugin_catalogue()) {
        if (plugin.category == "sampler") // whose rest passes in silence
            continue;
        const auto rest = needed.find(plugin.category + " " + plugin.name);
        const std::string text = scene_of(
            plugin, "<float name=\"nobody_knows\" value=\"1\"/>" + (rest == needed.end() ? "" : rest->second), "3.0.0");
        EXPECT_THAT(error_of(folder_.write("scene.xml", text), options),
                    HasSubstr("scene.xml:4: unknown parameter \"nobody_knows\" of " + plugin.category))
            << text;
    }
}

TEST_F(Declarations, NamesAreUnique) {
    for (const CataloguedPlugin &plugin : plugin_catalogue()) {
        std::vector<std::string> names;
        for (const Parameter &parameter : plugin.declaration.parameters) {
            EXPECT_EQ(snake_case(camel_case(parameter.name)), parameter.name);
            const std::string name = (parameter.takes == Takes::objects ? "<>" : "") + parameter.name;
            EXPECT_EQ(std::ranges::count(names, name), 0) << plugin.name << ": " << name;
            names.push_back(name);
        }
    }
}

} // namespace
} // namespace gradus
