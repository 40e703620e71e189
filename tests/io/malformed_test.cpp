// Broken files: each must end in an Error that names the file, the line and what is wrong. Never a crash, never a
// wrong image in silence.
#include "tests/io/scene_text.h"

#include <vector>

namespace gradus {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

struct Case {
    const char *name;
    std::string text; ///< the whole file
    const char *line; ///< "scene.xml:3", or a part of what stands there instead
    std::vector<const char *> words;
};

std::string in_shape(const std::string &shape) { return scene_around(shape, "3.0.0", ""); }
std::string in_bsdf(const std::string &bsdf) {
    return scene_around("<shape type=\"sphere\">\n" + bsdf + "</shape>", "3.0.0", "");
}
std::string in_sensor(const std::string &inside) {
    return "<scene version=\"3.0.0\">\n<sensor type=\"perspective\">\n" + inside +
           "</sensor><shape type=\"sphere\"/></scene>";
}
std::string in_transform(const std::string &step) {
    return in_shape("<shape type=\"cube\"><transform name=\"to_world\">\n" + step + "</transform></shape>");
}

const std::vector<Case> cases{
    // The file as XML.
    {"empty_file", "", "scene.xml", {"not well-formed XML"}},
    {"no_xml", "this is no scene", "scene.xml", {"not well-formed XML", "a scene is an XML file"}},
    {"unclosed_tag", "<scene version=\"3.0.0\">\n<sensor type=\"perspective\">\n</scene>", "scene.xml:3", {"XML"}},
    {"unclosed_attribute", "<scene version=\"3.0.0\">\n<sensor type=\"perspective/>\n</scene>", "scene.xml", {"XML"}},
    {"two_roots", "<scene version=\"3.0.0\"/>\n<scene version=\"3.0.0\"/>", "scene.xml:2", {"second root", "scene"}},
    {"wrong_root", "<bsdf type=\"diffuse\"/>", "scene.xml:1", {"bsdf", "<scene>"}},
    {"bad_version", "<scene version=\"three\"/>", "scene.xml:1", {"version", "three"}},
    {"binary_rubbish", std::string("\x00\x01\xff\xfe\x00<", 6), "scene.xml", {"XML"}},
    {"too_deep",
     [] {
         std::string text = "<scene version=\"3.0.0\">\n";
         for (int i = 0; i < 5000; ++i)
             text += "<bsdf type=\"twosided\">";
         for (int i = 0; i < 5000; ++i)
             text += "</bsdf>";
         return text + "</scene>";
     }(),
     "scene.xml:2",
     {"nested", "100"}},
    // Elements, plugins and references.
    {"unknown_element", scene_around("<shappe type=\"sphere\"/>"), "scene.xml:3", {"<shappe>", "did you mean <shape>"}},
    {"unknown_nested_element",
     in_bsdf("<bsdf type=\"diffuse\"><flote name=\"x\" value=\"1\"/></bsdf>"),
     "scene.xml:4",
     {"<flote>", "<float>"}},
    {"unknown_bsdf",
     in_bsdf("<bsdf type=\"difuse\"/>"),
     "scene.xml:4",
     {"difuse", "did you mean \"diffuse\"", "roughconductor", "twosided"}},
    {"unknown_shape",
     in_shape("<shape type=\"torus\"/>"),
     "scene.xml:3",
     {"torus", "known: cube, cylinder, disk, instance, merge, obj, ply"}},
    {"unknown_emitter", scene_around("<emitter type=\"ambient\"/>"), "scene.xml:3", {"ambient", "directional"}},
    {"masks_of_other_textures_in_blend",
     in_bsdf("<bsdf type=\"blendbsdf\"><bsdf type=\"mask\"><texture name=\"opacity\" type=\"checkerboard\"/><bsdf "
             "type=\"diffuse\"/></bsdf><bsdf type=\"diffuse\"/></bsdf>"),
     "scene.xml:4",
     {"a blend of masks of different opacities", "numbers, not textures"}},
    {"textured_mask_in_textured_mask",
     in_bsdf("<bsdf type=\"mask\"><texture name=\"opacity\" type=\"checkerboard\"/><bsdf type=\"mask\"><texture "
             "name=\"opacity\" type=\"checkerboard\"/><bsdf type=\"diffuse\"/></bsdf></bsdf>"),
     "scene.xml:4",
     {"both with textures", "their product"}},
    {"two_opacities",
     in_bsdf("<bsdf type=\"twosided\"><bsdf type=\"mask\"><bsdf type=\"diffuse\"/></bsdf><bsdf "
             "type=\"diffuse\"/></bsdf>"),
     "scene.xml:4",
     {"one opacity"}},
    {"sky", scene_around("<emitter type=\"sunsky\"/>"), "scene.xml:3", {"sunsky", "envmap"}},
    {"unknown_sensor",
     "<scene version=\"3.0.0\">\n<sensor type=\"fisheye\"/><shape type=\"cube\"/></scene>",
     "scene.xml:2",
     {"fisheye", "perspective"}},
    {"film_without_type", in_sensor("<film/>"), "scene.xml:3", {"<film> needs a type"}},
    {"shape_of_mitsuba", in_shape("<shape type=\"hair\"/>"), "scene.xml:3", {"hair", "not supported", "known: cube"}},
    {"sensor_of_mitsuba",
     "<scene version=\"3.0.0\">\n<sensor type=\"irradiancemeter\"/><shape type=\"cube\"/></scene>",
     "scene.xml:2",
     {"irradiancemeter", "not supported"}},
    {"cylinder_of_no_length",
     in_shape("<shape type=\"cylinder\"><point name=\"p1\" x=\"0\" y=\"0\" z=\"0\"/></shape>"),
     "scene.xml:3",
     {"p0 and p1"}},
    {"instance_of_nothing", in_shape("<shape type=\"instance\"/>"), "scene.xml:3", {"needs one shapegroup"}},
    {"instance_of_a_cube",
     in_shape("<shape type=\"instance\"><shape type=\"cube\"/></shape>"),
     "scene.xml:3",
     {"of a shapegroup", "\"cube\""}},
    {"instance_of_an_instance",
     in_shape("<shape type=\"instance\"><shape type=\"shapegroup\">\n<shape type=\"instance\"><shape "
              "type=\"shapegroup\"><shape type=\"cube\"/></shape></shape></shape></shape>"),
     "scene.xml:4",
     {"instance in a shapegroup"}},
    {"instance_of_a_stretched_sphere",
     in_shape("<shape type=\"instance\"><transform name=\"to_world\"><scale x=\"2\"/></transform><shape "
              "type=\"shapegroup\"><shape type=\"sphere\"/></shape></shape>"),
     "scene.xml:3",
     {"scale all directions alike"}},
    {"merge_in_itself",
     in_shape("<shape type=\"merge\" id=\"m\"><ref id=\"m\"/></shape>"),
     "scene.xml:3",
     {"contains itself"}},
    {"texture",
     in_bsdf("<bsdf type=\"diffuse\">\n<texture name=\"reflectance\" type=\"bitmap\"/></bsdf>"),
     "scene.xml:5",
     {"bitmap needs a filename"}},
    {"no_type", in_bsdf("<bsdf/>"), "scene.xml:4", {"<bsdf>", "type"}},
    {"medium", scene_around("<medium type=\"homogeneous\"/>"), "scene.xml:3", {"media", "--ignore-media"}},
    {"medium_of_a_shape",
     in_shape("<shape type=\"cube\">\n<medium name=\"interior\" type=\"homogeneous\"/></shape>"),
     "scene.xml:4",
     {"media", "--ignore-media"}},
    {"medium_of_the_sensor", in_sensor("<medium type=\"homogeneous\"/>"), "scene.xml:3", {"media", "--ignore-media"}},
    {"missing_reference",
     in_bsdf("<ref id=\"mettal\"/></shape><bsdf id=\"metal\" type=\"diffuse\"/><shape type=\"cube\">"),
     "scene.xml:4",
     {"mettal", "did you mean \"metal\""}},
    {"reference_without_id", in_bsdf("<ref name=\"bsdf\"/>"), "scene.xml:4", {"<ref>", "id"}},
    {"circular_reference",
     in_bsdf("<bsdf type=\"twosided\" id=\"a\"><bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf></bsdf>"),
     "scene.xml:4",
     {"contains itself"}},
    {"duplicate_id",
     scene_around("<bsdf id=\"a\" type=\"diffuse\"/>\n<bsdf id=\"a\" type=\"null\"/>"),
     "scene.xml:4",
     {"\"a\"", "already taken", "scene.xml:3"}},
    // Parameters of the scene.
    {"undefined_parameter", in_sensor("<float name=\"fov\" value=\"$fo\"/>"), "scene.xml:3", {"$fo", "-D"}},
    {"undefined_parameter_nearest",
     in_sensor("<default name=\"width\" value=\"3\"/></sensor>"
               "<default name=\"width\" value=\"3\"/>\n<sensor type=\"$widht\">"),
     "scene.xml:4",
     {"$widht", "did you mean $width"}},
    {"circular_parameter",
     "<scene version=\"3.0.0\">\n<default name=\"a\" value=\"$b\"/><default name=\"b\" value=\"$a\"/>\n<sensor "
     "type=\"$a\"/></scene>",
     "scene.xml:3",
     {"circle"}},
    {"exploding_parameter",
     [] {
         std::string text = "<scene version=\"3.0.0\">\n<default name=\"a0\" value=\"xxxxxxxxxxxxxxxx\"/>";
         for (int i = 1; i < 16; ++i) {
             const std::string below = "$a" + std::to_string(i - 1) + " ";
             std::string value;
             for (int j = 0; j < 16; ++j)
                 value += below;
             text += "<default name=\"a" + std::to_string(i) + "\" value=\"" + value + "\"/>";
         }
         return text + "\n<sensor type=\"$a15\"/></scene>";
     }(),
     "scene.xml:3",
     {"1 MiB"}},
    {"default_without_value", scene_around("<default name=\"spp\"/>"), "scene.xml:3", {"<default>", "value"}},
    {"missing_include", scene_around("<include filename=\"nowhere.xml\"/>"), "scene.xml:3", {"nowhere.xml"}},
    {"include_itself", scene_around("<include filename=\"scene.xml\"/>"), "scene.xml:3", {"circle"}},
    {"include_nothing", scene_around("<include/>"), "scene.xml:3", {"<include>", "filename"}},
    // Values.
    {"number", in_sensor("<float name=\"fov\" value=\"forty\"/>"), "scene.xml:3", {"fov", "number", "forty"}},
    {"number_with_tail", in_sensor("<float name=\"fov\" value=\"40deg\"/>"), "scene.xml:3", {"fov", "40deg"}},
    {"number_with_comma", in_sensor("<float name=\"fov\" value=\"40,5\"/>"), "scene.xml:3", {"fov", "40,5"}},
    {"number_nan", in_sensor("<float name=\"fov\" value=\"nan\"/>"), "scene.xml:3", {"fov", "nan"}},
    {"number_infinite", in_sensor("<float name=\"fov\" value=\"1e999\"/>"), "scene.xml:3", {"fov", "1e999"}},
    {"number_empty", in_sensor("<float name=\"fov\" value=\"\"/>"), "scene.xml:3", {"fov", "number"}},
    {"no_value", in_sensor("<float name=\"fov\"/>"), "scene.xml:3", {"fov", "no value"}},
    {"fov_range", in_sensor("<float name=\"fov\" value=\"180\"/>"), "scene.xml:3", {"fov", "180"}},
    {"fov_axis",
     in_sensor("<float name=\"fov\" value=\"40\"/>\n<string name=\"fov_axis\" value=\"z\"/>"),
     "scene.xml:4",
     {"fov_axis", "z", "diagonal"}},
    {"focal_length", in_sensor("<string name=\"focal_length\" value=\"long\"/>"), "scene.xml:3", {"focal_length"}},
    {"integer",
     in_sensor("<film type=\"hdrfilm\">\n<integer name=\"width\" value=\"1.5\"/></film>"),
     "scene.xml:4",
     {"width", "integer", "1.5"}},
    {"film_zero",
     in_sensor("<film type=\"hdrfilm\">\n<integer name=\"width\" value=\"0\"/></film>"),
     "scene.xml:4",
     {"width", "0"}},
    {"film_negative",
     in_sensor("<film type=\"hdrfilm\">\n<integer name=\"height\" value=\"-8\"/></film>"),
     "scene.xml:4",
     {"height", "-8"}},
    {"film_absurd",
     in_sensor("<film type=\"hdrfilm\">\n<integer name=\"width\" value=\"100000\"/>\n<integer name=\"height\" "
               "value=\"100000\"/></film>"),
     "scene.xml:4",
     {"100000 x 100000", "pixels"}},
    {"crop_outside",
     in_sensor("<film type=\"hdrfilm\"><integer name=\"width\" value=\"10\"/><integer name=\"crop_offset_x\" "
               "value=\"5\"/>\n<integer name=\"crop_width\" value=\"6\"/></film>"),
     "scene.xml:4",
     {"crop_width", "6"}},
    {"boolean",
     in_shape("<shape type=\"sphere\">\n<boolean name=\"flip_normals\" value=\"maybe\"/></shape>"),
     "scene.xml:4",
     {"flip_normals", "maybe"}},
    {"samples_zero",
     in_sensor("<sampler type=\"independent\">\n<integer name=\"sample_count\" value=\"0\"/></sampler>"),
     "scene.xml:4",
     {"sample_count", "0"}},
    {"max_depth",
     scene_around("<integrator type=\"path\">\n<integer name=\"max_depth\" value=\"-2\"/></integrator>"),
     "scene.xml:4",
     {"max_depth", "-2"}},
    {"rr_depth",
     scene_around("<integrator type=\"path\">\n<integer name=\"rr_depth\" value=\"0\"/></integrator>"),
     "scene.xml:4",
     {"rr_depth", "0"}},
    {"rgb_count",
     in_bsdf("<bsdf type=\"diffuse\">\n<rgb name=\"reflectance\" value=\"0.1 0.2\"/></bsdf>"),
     "scene.xml:5",
     {"reflectance", "0.1 0.2"}},
    {"rgb_negative",
     in_bsdf("<bsdf type=\"diffuse\">\n<rgb name=\"reflectance\" value=\"-0.1\"/></bsdf>"),
     "scene.xml:5",
     {"reflectance", "negative"}},
    {"rgb_hex",
     in_bsdf("<bsdf type=\"diffuse\">\n<rgb name=\"reflectance\" value=\"#12345g\"/></bsdf>"),
     "scene.xml:5",
     {"reflectance", "#12345g"}},
    {"rgb_overflow",
     scene_around("<emitter type=\"constant\">\n<rgb name=\"radiance\" value=\"1e300\"/></emitter>"),
     "scene.xml:4",
     {"radiance", "single precision"}},
    {"color_kind",
     in_bsdf("<bsdf type=\"diffuse\">\n<string name=\"reflectance\" value=\"red\"/></bsdf>"),
     "scene.xml:5",
     {"reflectance", "<string>"}},
    {"blackbody",
     scene_around("<emitter type=\"constant\">\n<blackbody name=\"radiance\" value=\"5000\"/></emitter>"),
     "scene.xml:4",
     {"radiance", "<blackbody>", "temperature=\"5000K\""}},
    {"blackbody_cold",
     scene_around("<emitter type=\"constant\">\n<blackbody name=\"radiance\" temperature=\"-3K\"/></emitter>"),
     "scene.xml:4",
     {"radiance", "temperature"}},
    {"animation",
     scene_around("<shape type=\"cube\">\n<animation name=\"to_world\"/></shape>"),
     "scene.xml:4",
     {"<animation> without a keyframe"}},
    {"old_camera", scene_around("\n<camera type=\"perspective\"/>"), "scene.xml:4", {"<camera>", "0.4", "<sensor>"}},
    {"old_luminaire", scene_around("\n<luminaire type=\"area\"/>"), "scene.xml:4", {"<luminaire>", "<emitter>"}},
    {"mixture_weights",
     in_bsdf(
         "<bsdf type=\"mixturebsdf\">\n<string name=\"weights\" value=\"0.5 0.5\"/><bsdf type=\"diffuse\"/></bsdf>"),
     "scene.xml:5",
     {"each of its 1", "0.5 0.5"}},
    {"mixture_negative",
     in_bsdf("<bsdf type=\"mixturebsdf\">\n<string name=\"weights\" value=\"-0.5\"/><bsdf type=\"diffuse\"/></bsdf>"),
     "scene.xml:5",
     {"negative"}},
    {"mixture_of_nothing",
     in_bsdf("<bsdf type=\"mixturebsdf\">\n<string name=\"weights\" value=\"0\"/><bsdf type=\"diffuse\"/></bsdf>"),
     "scene.xml:5",
     {"more than 0"}},
    {"spectrum_pairs",
     in_bsdf("<bsdf type=\"diffuse\">\n<spectrum name=\"reflectance\" value=\"400:0.1, 500\"/></bsdf>"),
     "scene.xml:5",
     {"500", "wavelength:value"}},
    {"spectrum_order",
     in_bsdf("<bsdf type=\"diffuse\">\n<spectrum name=\"reflectance\" value=\"500:0.1, 400:0.2\"/></bsdf>"),
     "scene.xml:5",
     {"rise", "400:0.2"}},
    {"ior_name",
     in_bsdf("<bsdf type=\"dielectric\">\n<string name=\"int_ior\" value=\"diamnd\"/></bsdf>"),
     "scene.xml:5",
     {"int_ior", "did you mean \"diamond\"", "water"}},
    {"ior_zero",
     in_bsdf("<bsdf type=\"dielectric\">\n<float name=\"int_ior\" value=\"0\"/></bsdf>"),
     "scene.xml:5",
     {"int_ior", "0"}},
    {"conductor_name",
     in_bsdf("<bsdf type=\"conductor\">\n<string name=\"material\" value=\"Unobtainium\"/></bsdf>"),
     "scene.xml:5",
     {"Unobtainium", "Ag, Al, AlAs"}},
    {"conductor_twice",
     in_bsdf("<bsdf type=\"conductor\">\n<rgb name=\"k\" value=\"1\"/>\n<string name=\"material\" "
             "value=\"Al\"/></bsdf>"),
     "scene.xml:6",
     {"material or its eta and k"}},
    {"distribution",
     in_bsdf("<bsdf type=\"roughconductor\">\n<string name=\"distribution\" value=\"blinn\"/></bsdf>"),
     "scene.xml:5",
     {"blinn", "beckmann, ggx"}},
    {"alpha_negative",
     in_bsdf("<bsdf type=\"roughconductor\">\n<float name=\"alpha\" value=\"-0.1\"/></bsdf>"),
     "scene.xml:5",
     {"alpha", "-0.1"}},
    {"twosided_empty", in_bsdf("<bsdf type=\"twosided\"/>"), "scene.xml:4", {"twosided", "0"}},
    {"twosided_glass",
     in_bsdf("<bsdf type=\"twosided\">\n<bsdf type=\"dielectric\"/></bsdf>"),
     "scene.xml:5",
     {"twosided", "through"}},
    {"two_bsdfs", in_bsdf("<bsdf type=\"diffuse\"/>\n<bsdf type=\"diffuse\"/>"), "scene.xml:5", {"second"}},
    {"two_emitters", in_bsdf("<emitter type=\"area\"/>\n<emitter type=\"area\"/>"), "scene.xml:5", {"second"}},
    {"point_in_shape", in_bsdf("<emitter type=\"point\"/>"), "scene.xml:4", {"area", "point"}},
    {"area_alone", scene_around("<emitter type=\"area\"/>"), "scene.xml:3", {"area", "inside"}},
    {"two_environments",
     scene_around("<emitter type=\"constant\"/>\n<emitter type=\"constant\"/>"),
     "scene.xml:4",
     {"environment", "scene.xml:3"}},
    {"direction_zero",
     scene_around("<emitter type=\"directional\">\n<vector name=\"direction\" x=\"0\"/></emitter>"),
     "scene.xml:4",
     {"direction", "zero"}},
    {"point_beyond_single_precision",
     scene_around("<emitter type=\"point\">\n<point name=\"position\" x=\"1e39\"/></emitter>"),
     "scene.xml:4",
     {"point emitter cannot be so far away"}},
    {"spot_beyond_single_precision",
     scene_around(
         "<emitter type=\"spot\">\n<transform name=\"to_world\"><translate z=\"-1e39\"/></transform></emitter>"),
     "scene.xml:4",
     {"spot emitter cannot be so far away"}},
    {"position_twice",
     scene_around(
         "<emitter type=\"point\">\n<point name=\"position\" x=\"1\"/><transform name=\"to_world\"/></emitter>"),
     "scene.xml:4",
     {"position", "to_world"}},
    // Transforms.
    {"matrix_count", in_transform("<matrix value=\"1 2 3\"/>"), "scene.xml:4", {"matrix", "16 or 9", "3"}},
    {"matrix_word", in_transform("<matrix value=\"1 0 0 0 1 0 0 0 one\"/>"), "scene.xml:4", {"matrix", "numbers"}},
    {"matrix_of_nothing",
     in_transform("<matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 0\"/>"),
     "scene.xml:4",
     {"last row"}},
    {"matrix_slightly_projective",
     in_transform("<matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 0 0 -1e-5 1\"/>"),
     "scene.xml:4",
     {"last row"}},
    {"matrix_transposed",
     in_transform("<matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 3 4 5 1\"/>"),
     "scene.xml:4",
     {"last row", "is the matrix transposed?"}},
    {"translate_count", in_transform("<translate value=\"1 2\"/>"), "scene.xml:4", {"translate", "three numbers"}},
    {"matrix_projective",
     in_transform("<matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1\"/>"),
     "scene.xml:4",
     {"last row"}},
    {"rotate_axis", in_transform("<rotate angle=\"40\"/>"), "scene.xml:4", {"rotate", "axis"}},
    {"rotate_angle", in_transform("<rotate x=\"1\"/>"), "scene.xml:4", {"rotate", "angle"}},
    {"translate_word", in_transform("<translate x=\"far\"/>"), "scene.xml:4", {"translate", "far"}},
    {"lookat_point",
     in_transform("<lookat origin=\"1 2 3\" target=\"1 2 3\" up=\"0 1 0\"/>"),
     "scene.xml:4",
     {"lookat", "same point"}},
    {"lookat_missing", in_transform("<lookat origin=\"1 2 3\"/>"), "scene.xml:4", {"lookat", "target"}},
    {"transform_step", in_transform("<shear x=\"1\"/>"), "scene.xml:4", {"shear", "rotate"}},
    {"transform_overflow", in_transform("<scale value=\"1e200\"/><scale value=\"1e200\"/>"), "scene.xml:3", {"finite"}},
    {"camera_flat",
     in_sensor("<transform name=\"to_world\"><scale x=\"0\"/></transform>"),
     "scene.xml:3",
     {"no inverse"}},
    // Shapes.
    {"no_filename", in_shape("<shape type=\"obj\"/>"), "scene.xml:3", {"obj", "filename"}},
    {"missing_file",
     in_shape("<shape type=\"ply\">\n<string name=\"filename\" value=\"gone.ply\"/></shape>"),
     "scene.xml:4",
     {"gone.ply"}},
    {"sphere_stretched",
     in_shape("<shape type=\"sphere\">\n<transform name=\"to_world\"><scale x=\"2\"/></transform></shape>"),
     "scene.xml:4",
     {"sphere", "scale"}},
    {"sphere_sheared",
     in_shape("<shape type=\"sphere\">\n<transform name=\"to_world\"><matrix value=\"1 0.1 0 0 1 0 0 0 "
              "1\"/></transform></shape>"),
     "scene.xml:4",
     {"sphere", "shear"}},
    {"sphere_of_no_size",
     in_shape("<shape type=\"sphere\">\n<float name=\"radius\" value=\"0\"/></shape>"),
     "scene.xml:4",
     {"radius"}},
    {"sphere_center",
     in_shape("<shape type=\"sphere\">\n<point name=\"center\" x=\"1\" y=\"two\"/></shape>"),
     "scene.xml:4",
     {"center", "two"}},
    // The scene as a whole.
    {"no_sensor", "<scene version=\"3.0.0\">\n<emitter type=\"constant\"/></scene>", "scene.xml: ", {"<sensor>"}},
    {"nothing_to_render", scene_around("<emitter type=\"point\"/>", "3.0.0", ""), "scene.xml: ", {"no shapes"}},
};

class MalformedScene : public testing::TestWithParam<Case> {};

TEST_P(MalformedScene, IsRefusedWithAMessage) {
    const std::string message = error_of_text(GetParam().text);
    EXPECT_THAT(message, testing::HasSubstr(GetParam().line));
    for (const char *word : GetParam().words)
        EXPECT_THAT(message, testing::HasSubstr(word));
}

INSTANTIATE_TEST_SUITE_P(All, MalformedScene, testing::ValuesIn(cases),
                         [](const auto &info) { return std::string(info.param.name); });

TEST(MalformedScenes, AreMoreThanForty) { EXPECT_GE(cases.size(), 40u); }

TEST(MalformedScenes, MissingSceneFileIsNamed) {
    EXPECT_THAT(error_of("/no/such/folder/scene.xml"), testing::HasSubstr("/no/such/folder/scene.xml"));
    TemporaryFolder folder;
    EXPECT_THAT(error_of(folder.path().string()), testing::HasSubstr("cannot read"));
}

TEST(MalformedScenes, AllMissingFilesAreListedAtOnce) {
    std::string body;
    for (const char *name : {"a.obj", "b.ply", "c.serialized"})
        body += "<shape type=\"" + std::string(name).substr(2) + "\"><string name=\"filename\" value=\"" + name +
                "\"/></shape>\n";
    const std::string message = error_of_text(in_shape(body));
    EXPECT_THAT(message, testing::HasSubstr("scene.xml:3: cannot find the file \"a.obj\""));
    EXPECT_THAT(message, testing::HasSubstr("scene.xml:4: cannot find the file \"b.ply\""));
    EXPECT_THAT(message, testing::HasSubstr("scene.xml:5: cannot find the file \"c.serialized\""));
}

TEST(MalformedScenes, WhatIsNoFileIsTold) {
    TemporaryFolder folder;
    std::filesystem::create_directory(folder.path() / "meshes.ply");
    const auto error_with = [&](const std::string &name) {
        return error_of(folder.write(
            "scene.xml", in_shape("<shape type=\"ply\"><string name=\"filename\" value=\"" + name + "\"/></shape>")));
    };
    EXPECT_THAT(error_with("meshes.ply"),
                HasSubstr("scene.xml:3: cannot find the file \"meshes.ply\": it is a folder"));
    EXPECT_THAT(error_with("/dev/zero"), HasSubstr("cannot find the file \"/dev/zero\": it is not a regular file"));
}

/// Once for all shapes that name it.
TEST(MalformedScenes, ABrokenMeshIsToldWithWhoNamesIt) {
    TemporaryFolder folder;
    folder.write("broken.ply", "no ply");
    const std::string shape = "<shape type=\"ply\"><string name=\"filename\" value=\"broken.ply\"/></shape>\n";
    const std::string message = error_of(folder.write("scene.xml", in_shape("\n" + shape + shape)));
    EXPECT_THAT(message, HasSubstr("broken.ply: not a PLY file"));
    EXPECT_THAT(message, HasSubstr("the file is named at " + (folder.path() / "scene.xml:4").string()));
    EXPECT_EQ(message.find("not a PLY file"), message.rfind("not a PLY file"));
}

/// A file that many shapes name is told of once, and what else is wrong with its shapes beside it.
TEST(MalformedScenes, AMissingFileHidesNothing) {
    std::string body;
    for (int i = 0; i < 150; ++i)
        body += "<shape type=\"serialized\"><string name=\"filename\" value=\"all.serialized\"/></shape>\n";
    body += "<shape type=\"obj\"><string name=\"filename\" value=\"b.obj\"/><bsdf type=\"hk\"/>"
            "<emitter type=\"lamp\"/></shape>\n";
    const std::string message = error_of_text(in_shape(body));
    for (const char *part : {"scene.xml:3: cannot find the file \"all.serialized\"",
                             "scene.xml:153: cannot find the file \"b.obj\"", "\"hk\"", "\"lamp\""})
        EXPECT_THAT(message, HasSubstr(part));
    EXPECT_EQ(message.find("all.serialized"), message.rfind("all.serialized"));
}

/// A medium is told of once, however many shapes it is in, and hides nothing.
TEST(MalformedScenes, AMediumHidesNothing) {
    const std::string message = error_of_text(scene_around(
        "<medium type=\"homogeneous\" id=\"m\"><what/></medium><shape type=\"cube\"><ref name=\"interior\" id=\"m\"/>"
        "<bsdf type=\"hk\"/></shape><shape type=\"sphere\"><ref name=\"interior\" id=\"m\"/><float name=\"radius\" "
        "value=\"wide\"/></shape>"));
    for (const char *part : {"\"hk\"", "needs a number, not \"wide\""})
        EXPECT_THAT(message, HasSubstr(part));
    EXPECT_THAT(message, Not(HasSubstr("unknown element")));
    EXPECT_EQ(message.find("participating media"), message.rfind("participating media"));
}

TEST(MalformedScenes, ASensorInAShapeIsNamed) {
    EXPECT_THAT(error_of_text("<scene version=\"3.0.0\">\n<shape type=\"cube\">\n<sensor type=\"irradiancemeter\"/>"
                              "</shape></scene>"),
                HasSubstr("scene.xml:3: <sensor type=\"irradiancemeter\"> inside <shape type=\"cube\">"));
}

TEST(MalformedScenes, AllMissingIncludesAreListedAtOnce) {
    const std::string message =
        error_of_text(scene_around("<include filename=\"a.xml\"/>\n<include filename=\"b.xml\"/>"));
    EXPECT_THAT(message, testing::HasSubstr("scene.xml:3: "));
    EXPECT_THAT(message, testing::HasSubstr("scene.xml:4: "));
}

TEST(MalformedScenes, ErrorsOfSeveralObjectsAreCollected) {
    const std::string message =
        error_of_text(in_bsdf("<bsdf type=\"x\"/></shape>\n<emitter type=\"y\"/>\n<shape type=\"z\">"));
    for (const char *place : {"scene.xml:4", "scene.xml:5", "scene.xml:6"})
        EXPECT_THAT(message, testing::HasSubstr(place));
}

TEST(MalformedScenes, ErrorsInIncludedFilesNameThatFile) {
    TemporaryFolder folder;
    folder.write("parts/light.xml", "<scene version=\"3.0.0\">\n\n<emitter type=\"lamp\"/>\n</scene>");
    const std::string message =
        error_of(folder.write("scene.xml", scene_around("<include filename=\"parts/light.xml\"/>")));
    EXPECT_THAT(message, testing::HasSubstr("light.xml:3: unknown emitter plugin \"lamp\""));
}

TEST(SceneFileItself, SaysWhyItCannotBeRead) {
    TemporaryFolder folder;
    EXPECT_THAT(error_of((folder.path() / "absent.xml").string()),
                HasSubstr("cannot read this scene file: there is none"));
    EXPECT_THAT(error_of(folder.path().string()), HasSubstr("cannot read this scene file: it is a folder"));
    EXPECT_THAT(error_of("/dev/null"), HasSubstr("cannot read this scene file: it is no regular file"));
    // What a scene includes may be anywhere, and its author is not to learn what there is.
    const auto path = folder.write("scene.xml", scene_around("<include filename=\"" + folder.path().string() + "\"/>"));
    EXPECT_THAT(error_of(path), Not(HasSubstr("folder:")));
}

TEST(SceneSettings, ADepthOfNothingIsWarnedOf) {
    const auto warnings = [](const char *depth) {
        return load_text(scene_around("<integrator type=\"path\"><integer name=\"max_depth\" value=\"" +
                                      std::string(depth) + "\"/></integrator><emitter type=\"constant\"/>"))
            .warnings;
    };
    EXPECT_THAT(warnings("0"), ElementsAre(HasSubstr("max_depth 0 leaves no path")));
    EXPECT_THAT(warnings("1"), IsEmpty());
}

} // namespace
} // namespace gradus
