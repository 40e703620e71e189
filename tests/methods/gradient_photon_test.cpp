// Gradient-domain photon mapping: its differences have the means that those of its primal image have, its primal is
// photon mapping's image, and neither batches nor threads show.
#include "tests/methods/reference_scene.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/small_scenes.h"
#include "tests/support/test_name.h"
#include "tests/support/textures.h"

#include <fmt/format.h>

#include <bit>

namespace gradus::testing {
namespace {

// Pixels are large, so shifts go far and their Jacobians are far from 1.
constexpr std::size_t image_seeds = 16;
constexpr std::uint64_t passes = 16;

struct PhotonCase {
    const char *scene;
    bool direct_photons = false;
};

std::string name_of(const ::testing::TestParamInfo<PhotonCase> &info) {
    return test_name(info.param.scene) + (info.param.direct_photons ? "_direct_photons" : "");
}

RenderOptions few_photons(bool direct_photons = false) {
    RenderOptions options;
    options.photons = 4000;
    options.radius = RenderOptions::GatherRadius{1.5, false};
    options.direct_photons = direct_photons;
    return options;
}

/// Of one render, the differences less those of its primal, times the sign that these have in an independent image:
/// differences that are too small everywhere show in every block.
Image deviations(const Image &image, const Image &signs, bool right) {
    const Image of_primal = differences(image, "primal", right);
    const Layer change(image, right ? "dx" : "dy"), primal(of_primal, ""), sign(signs, "");
    return image_of(image.width, image.height, [&](int c, std::uint32_t x, std::uint32_t y) {
        return (change(c, x, y) - primal(c, x, y)) * (sign(c, x, y) < 0 ? -1 : 1);
    });
}

/// What a pass costs goes by its launches: there are a fourth of them, of twice the photons that the options say, or in
/// full of four times those. Returns the variance of the differences over that of the primal.
double expect_differences_of_the_primal(const std::string &name, Scene scene, RenderOptions options,
                                        std::size_t seeds = image_seeds) {
    scene.settings.samples_per_pixel = passes / 4;
    options.photons = (is_full() ? 4 : 2) * options.photons;
    do_not_weigh(options);
    const std::vector<Image> images = render_seeds(scene, seeds, options, 1, "gpm");
    options.seed = 4711;
    const Image other = render(scene, options, "gpm").image;
    double noise = 0, plain = 0;
    for (const bool right : {true, false}) {
        const Image signs = differences(other, "primal", right);
        std::vector<Image> ours;
        for (const Image &image : images)
            ours.push_back(deviations(image, signs, right));
        ReferenceScene nothing;
        nothing.name = fmt::format("gpm-{}-{}", name, right ? "dx" : "dy");
        nothing.mean = image_of(scene.film.width, scene.film.height, [](auto...) { return 0.0; });
        nothing.variance = nothing.mean;
        EXPECT_TRUE(agrees(ours, double(passes / 4), nothing));
        for (int c = 0; c < 3; ++c) // of the first two seeds
            for (std::uint32_t y = 0; y + 1 < scene.film.height; ++y)
                for (std::uint32_t x = 0; x + 1 < scene.film.width; ++x) {
                    const char *const d = right ? "dx" : "dy";
                    noise += std::pow(layer(images[0], d, c, x, y) - layer(images[1], d, c, x, y), 2);
                    plain += std::pow(layer(images[0], "primal", c, x, y) - layer(images[1], "primal", c, x, y), 2);
                }
    }
    std::printf("%s: variance of the differences over the primal's: %.4f\n", name.c_str(), noise / plain);
    return noise / plain;
}

class GradientPhotons : public ::testing::TestWithParam<PhotonCase> {};

TEST_P(GradientPhotons, DifferencesAreThoseOfThePrimal) {
    expect_differences_of_the_primal(GetParam().scene, own_scene(fmt::format("{}.xml", GetParam().scene), 32, 24),
                                     few_photons(GetParam().direct_photons));
}

/// A floor that all photons come to from three walls. Gather points are small, so that most photons of a pixel do not
/// count in the next one and are moved.
void expect_differences_under_walls(const std::string &name, SceneMaker maker, const Bsdf &side, const Bsdf &back,
                                    std::size_t seeds) {
    maker.look({0, 2.5, 1.5}, {0, 0, 0}, 40);
    maker.scene.settings.max_depth = 3;
    maker.parallelogram({-1, 0, 1}, {0, 0, -2}, {0, 2, 0}, maker.material(two_sided(side)));
    maker.parallelogram({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, maker.material(two_sided(side)));
    maker.parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, maker.material(two_sided(back)));
    maker.point_light({1, 1, 1}, {0.2f, 1, 0});
    RenderOptions options = few_photons();
    options.radius->value = 0.5;
    expect_differences_of_the_primal(name, maker.scene, options, seeds);
}

/// What textures replace is far from what they are worth.
TEST(FullGradientPhotonImage, HasDifferencesOfThePrimalUnderTexturedWalls) {
    SceneMaker maker(24, passes);
    maker.scene.textures = {random_texture(3, 3, Bitmap::Format::word), random_texture(4, 3, Bitmap::Format::word)};
    maker.scene.textures[0].scale = {0.2f, 0.2f, 0.2f};
    Bsdf floor = diffuse(0.3), textured = diffuse(0.9), blend;
    floor.reflectance.texture = 1;
    textured.reflectance.texture = 0;
    maker.scene.blended = {diffuse(0.02), textured};
    maker.scene.blends = {{0, 1, 0.8f}};
    blend.blend = 0;
    maker.floor(-1, 1, 1, maker.material(floor));
    expect_differences_under_walls("textured-walls", maker, textured, blend, 16);
}

/// A wall whose normals lean to one side, or look into it: of these a light path must take the other one. What comes
/// from there to a small piece of floor is worth the same wherever it goes: who leaves by the surface's own normal, or
/// knows nothing of the choice, makes noise of it.
TEST(GradientPhotonImage, HasQuietDifferencesOfThePrimalUnderAWallWithANormalMap) {
    SceneMaker maker(16, passes);
    const auto leaning = std::make_shared<Bitmap>();
    leaning->resize(2, 1, Bitmap::Format::real, true);
    const float colors[2][3] = {{0.9f, 0.4f, 0.8f}, {0.2f, 0.45f, 0.35f}};
    for (std::uint32_t x = 0; x < 2; ++x)
        for (int c = 0; c < 3; ++c)
            leaning->set(x, 0, c, std::bit_cast<std::uint32_t>(colors[x][c]));
    maker.scene.textures.resize(1);
    maker.scene.textures[0].bitmap = leaning;
    Bsdf mapped = diffuse(0.9);
    mapped.map = {.kind = NormalTexture::Kind::normal, .texture = 0, .turns_over = true, .shadows = true};
    maker.look({0, 1, 0}, {0, 0, 0}, 15, {0, 0, 1});
    maker.scene.settings.max_depth = 3;
    maker.floor(-0.5f, 0.5f, 0.5f, maker.material(diffuse(0.5)));
    maker.parallelogram({1, 0, 1}, {0, 0, -2}, {0, 2, 0}, maker.material(two_sided(mapped)));
    maker.point_light({1, 1, 1}, {-0.6f, 0.8f, 0});
    RenderOptions options = few_photons();
    options.photons = 40'000;
    EXPECT_LT(expect_differences_of_the_primal("mapped-wall", maker.scene, options), 0.01);
}

/// By a mirror in a mask, and past a pane that half of the rays pass: where chance decides whether a chain is there, it
/// decides once.
TEST(FullGradientPhotonImage, HasDifferencesOfThePrimalByMirrorsInAMask) {
    for (const bool past_a_pane : {false, true}) {
        SceneMaker maker(16, passes);
        maker.look({0, 2.5f, -4}, {0, 0.2f, 0}, 40);
        maker.scene.settings.max_depth = 4;
        maker.scene.textures = {random_texture(3, 3, Bitmap::Format::word, false, 6)};
        Material above = material_of(mirror()), pane = two_sided(diffuse(0));
        if (!past_a_pane)
            above.opacity.texture = 0;
        pane.opacity = 0.5f;
        maker.floor(-2, 2, 2, maker.material(diffuse(0.7)));
        maker.parallelogram({-1.2f, 3, -1.2f}, {2.4f, 0, 0}, {0, 0, 2.4f}, maker.material(above));
        if (past_a_pane)
            maker.floor(0, 1.6f, 0.8f, maker.material(pane), 2.2f);
        maker.point_light({5, 5, 5}, {0.2f, 1.5f, 0});
        RenderOptions options = few_photons();
        options.only_chains = true;
        const std::map<std::string, std::uint64_t> shifts = render(maker.scene, options, "gpm").statistics.shifts;
        EXPECT_EQ(shifts.at("walked") > 1000u, past_a_pane) << shifts.at("walked"); // by the half that it leaves
        expect_differences_of_the_primal(past_a_pane ? "pane" : "mask", maker.scene, options, 32);
    }
}

/// Surfaces whose photons stay where they are beside others of the same kind, where they are moved: mirrors and walls
/// under a bump map, painted glass. Neither shifts nor walks mix them up.
TEST(GradientPhotonImage, HasDifferencesOfThePrimalBesideMapsAndPaintedGlass) {
    SceneMaker maker(24, passes);
    maker.look({0, 2, 2.5}, {0, 0, 0}, 30);
    maker.scene.settings.max_depth = 6;
    maker.scene.textures = {random_texture(9, 9, Bitmap::Format::word, false, 2),
                            random_texture(6, 6, Bitmap::Format::word, true, 3)};
    const NormalTexture bumps = {.kind = NormalTexture::Kind::bump, .texture = 0, .scale = 0.2f};
    Bsdf floor = diffuse(0.6), bumpy_wall = diffuse(0.9), bumpy_mirror = mirror(), painted_glass = glass(1.5);
    floor.map = bumpy_wall.map = bumpy_mirror.map = bumps;
    painted_glass.specular_transmittance.texture = 1;
    maker.floor(-1, 1, 1, maker.material(floor));
    maker.sphere({-0.4f, 0.4f, -0.2f}, 0.25f, maker.material(glass(1.5)));
    maker.sphere({0.05f, 0.4f, 0.2f}, 0.25f, maker.material(painted_glass));
    for (int i = 0; i < 6; ++i) // strips of a mirror and of a wall
        maker.parallelogram({0.5f, 0, 0.6f - 0.2f * float(i)}, {0, 0, -0.2f}, {0.3f, 0.9f, 0},
                            maker.material(two_sided(i % 2 == 0 ? bumpy_mirror : mirror())));
    for (int i = 0; i < 6; ++i)
        maker.parallelogram({-0.6f + 0.2f * float(i), 0, -0.6f}, {0.2f, 0, 0}, {0, 0.9f, -0.2f},
                            maker.material(two_sided(i % 2 == 0 ? bumpy_wall : diffuse(0.9))));
    maker.point_light({9, 9, 9}, {-0.3f, 2.5f, 0.4f});
    const std::map<std::string, std::uint64_t> shifts = render(maker.scene, few_photons(), "gpm").statistics.shifts;
    EXPECT_GT(shifts.at("walked"), 300u);
    EXPECT_GT(shifts.at("reconnected"), 300u);
    RenderOptions options = few_photons();
    options.photons *= 2; // with fewer, walks by the maps' mirrors would not show
    expect_differences_of_the_primal("maps", maker.scene, options);
}

/// Surfaces that are too smooth to gather at, but no mirrors: their half vectors are kept. With these vertices held
/// where they are the differences have 1.1 times the variance of the primal.
TEST(FullGradientPhotonImage, HasQuietDifferencesOfThePrimalByGlossyMetalAndGlass) {
    SceneMaker maker(24, passes);
    maker.look({0, 1, 1.2f}, {0, 0, 0}, 30);
    maker.scene.settings.max_depth = 6;
    maker.floor(-1, 1, 1, maker.material(diffuse(0.6)));
    maker.parallelogram({-9, 1.2f, 9}, {18, 0, 0}, {0, 0, -18}, maker.material(rough_glass(0.02, 1.5)));
    maker.parallelogram({-2, 0, -1}, {4, 0, 0}, {0, 1, 0}, maker.material(two_sided(rough_metal(0.02))));
    maker.point_light({9, 9, 9}, {0.1f, 1.4f, -0.2f});
    RenderOptions options = few_photons();
    options.only_chains = true;
    EXPECT_GT(render(maker.scene, options, "gpm").statistics.shifts.at("walked"), 1000u);
    EXPECT_LT(expect_differences_of_the_primal("glossy", maker.scene, options), 0.1);
}

/// The sum of the sizes of the differences to the right, of a floor with stripes that the sun shines on by a pane and a
/// wall: every photon that is moved to another stripe adds as much, so there is hardly any noise.
double difference_of_stripes(const Bsdf &pane, const Bsdf &wall) {
    SceneMaker maker(16, 1);
    maker.look({0, 1, 0}, {0, 0, 0}, 40, {0, 0, 1});
    maker.scene.camera.kind = Camera::Kind::orthographic;
    maker.scene.settings.max_depth = 4;
    const std::uint32_t dark = maker.material(diffuse(0.1)), light = maker.material(diffuse(0.9));
    for (int i = 0; i < 8; ++i)
        maker.parallelogram({-1 + 0.25f * float(i), 0, 1}, {0.25f, 0, 0}, {0, 0, -2}, i % 2 == 0 ? dark : light);
    maker.parallelogram({2, 0, -2}, {0, 0, 4}, {0, 4, 0}, maker.material(two_sided(wall)));
    maker.parallelogram({-1, 3.5f, 2}, {3, 0, 0}, {0, 0, -4}, maker.material(pane));
    for (const Bsdf &hidden : {glass(1.5), mirror(), rough_glass(0.005, 1.5), rough_metal(0.005)})
        maker.floor(0, 0.1f, 0.1f, maker.material(hidden), -0.5f); // in the floor's shadow: all have the same kernels
    maker.directional_light({4, 4, 4}, {1, -1, 0.1f});
    RenderOptions options = few_photons();
    options.photons = 400'000;
    options.radius->value = 0.5;
    options.only_chains = true;
    do_not_weigh(options);
    const Rendered rendered = render(maker.scene, options, "gpm");
    EXPECT_GT(rendered.statistics.shifts.at("walked"), 1000u);
    const Layer of(rendered.image, "dx");
    double sum = 0;
    for (std::uint32_t y = 0; y < 16; ++y)
        for (std::uint32_t x = 0; x < 15; ++x)
            sum += std::abs(of(1, x, y));
    std::printf("walked %.3f of the photons that are moved\n",
                double(rendered.statistics.shifts.at("walked")) /
                    double(rendered.statistics.shifts.at("walked") + rendered.statistics.shifts.at("failed")));
    return sum;
}

/// Nearly mirrors, they move light as mirrors do.
TEST(GradientPhotonImage, HasTheDifferencesOfMirrorsByGlossyMetalAndGlass) {
    const double of_mirrors = difference_of_stripes(glass(1.5), mirror());
    EXPECT_NEAR(difference_of_stripes(rough_glass(0.005, 1.5), rough_metal(0.005)) / of_mirrors, 1, 0.03);
}

/// What throws a picture whose colours are another in each direction, downwards.
void throw_picture(SceneMaker &maker, Emitter::Kind kind, Vector3 position) {
    maker.scene.textures.push_back(random_texture(7, 5, Bitmap::Format::word, true));
    Texture &picture = maker.scene.textures.back();
    picture.wrap = Texture::Wrap::clamp;
    if (kind == Emitter::Kind::projector) { // black in part
        picture = Texture();
        picture.kind = Texture::Kind::checkerboard;
        picture.color_0 = {1, 0.7f, 0.4f};
        picture.color_1 = {0, 0, 0};
    }
    Emitter &emitter = maker.picture(kind, {2, 2, 2}, maker.scene.textures.size() - 1, position, 0.7f, 0.6f);
    emitter.cutoff = 0.5f;
    emitter.beam = 0.1f;
}

Texture of_red_and_green() {
    Texture squares;
    squares.kind = Texture::Kind::checkerboard;
    squares.color_0 = {1, 0, 0};
    squares.color_1 = {0, 1, 0};
    return squares;
}

/// A ball of glass and a mirror over a floor, and light from no surface: from infinity, by a sun, by a map with a
/// bright spot, or from all directions alike; and from points that shine differently into each direction. All of it by
/// photons, so that some come straight from there, and some by chains.
class GradientPhotonsFrom : public ::testing::TestWithParam<const char *> {};

TEST_P(GradientPhotonsFrom, HaveDifferencesOfThePrimal) {
    const std::string light = GetParam();
    SceneMaker maker(24, passes);
    maker.look({0, 2, 2.5}, {0, 0, 0}, 30);
    maker.scene.settings.max_depth = 6;
    maker.floor(-1, 1, 1, maker.material(diffuse(0.6)));
    maker.sphere({-0.2f, 0.5f, 0}, 0.3f, maker.material(glass(1.5)));
    maker.parallelogram({0.4f, 0, 0.4f}, {0, 0, -0.8f}, {0.3f, 0.9f, 0}, maker.material(two_sided(mirror())));
    if (light == "a_sun")
        maker.directional_light({4, 4, 4}, {0.3f, -1, 0.1f});
    else if (light == "a_map")
        maker.environment_map(8, 4, [](std::uint32_t x, std::uint32_t y) { return x == 2 && y == 1 ? 5.0 : 0.2; });
    else if (light == "all_around")
        maker.environment(1);
    else if (light == "a_spot")
        maker.spot({9, 9, 9}, {0.3f, 2.5f, 0.2f}, {-0.1f, -1, -0.1f}, 5, 25);
    else {
        throw_picture(maker, Emitter::Kind::projector, {-0.3f, 2.5f, 0.2f});
        throw_picture(maker, Emitter::Kind::spot, {0.3f, 2.2f, 0.3f});
        throw_picture(maker, Emitter::Kind::spot, {0, 2.3f, -0.2f});
        maker.scene.emitters.back().value = {0, 3, 0}; // nothing, where the picture is red
        maker.scene.textures.back() = of_red_and_green();
        maker.point_light({1, 1, 1}, {0, 2.4f, -0.3f});
    }
    RenderOptions options = few_photons(true);
    const std::map<std::string, std::uint64_t> shifts = render(maker.scene, options, "gpm").statistics.shifts;
    const double all = double(shifts.at("walked") + shifts.at("reconnected") + shifts.at("failed"));
    std::printf("walked %.3f, reconnected %.3f of the photons that are moved\n", double(shifts.at("walked")) / all,
                double(shifts.at("reconnected")) / all);
    EXPECT_GT(double(shifts.at("walked")), 0.02 * all);
    EXPECT_GT(double(shifts.at("reconnected")), 0.5 * all);
    if (light == "pictures")
        options.photons *= 2; // with fewer, photons from where a picture is black would not show
    expect_differences_of_the_primal(light, maker.scene, options);
}
INSTANTIATE_TEST_SUITE_P(Image, GradientPhotonsFrom, ::testing::Values("a_sun", "pictures"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, GradientPhotonsFrom, ::testing::Values("a_map", "all_around", "a_spot"), name_of_scene);

/// Seen straight from above, a floor in the sun and under a projector that throws nothing but white has no differences
/// but for rounding: each photon is shared, or moved to where it is worth the same. A few, within rounding of a disc's
/// border, have no shift.
TEST(GradientPhotonImage, HasNoDifferencesWhereASunAndAProjectorShineOnAFloor) {
    SceneMaker maker(16, 1);
    maker.look({0, 1, 0}, {0, 0, 0}, 40, {0, 0, 1});
    maker.scene.camera.kind = Camera::Kind::orthographic; // the same radius everywhere
    maker.scene.settings.max_depth = 2;
    maker.floor(-3, 3, 3, maker.material(diffuse(0.6)));
    maker.directional_light({4, 4, 4}, {0.3f, -1, 0.1f});
    maker.picture(Emitter::Kind::projector, {9, 9, 9}, 0, {0.1f, 2, -0.2f}, 3, 3).texture = no_texture;
    RenderOptions options = few_photons(true);
    options.photons = 50'000;
    do_not_weigh(options);
    const Rendered rendered = render(maker.scene, options, "gpm");
    EXPECT_GT(rendered.statistics.shifts.at("reconnected"), 1000u);
    double change = 0, plain = 0;
    for (const bool right : {true, false}) {
        const Image of_primal = differences(rendered.image, "primal", right);
        const Layer of(rendered.image, right ? "dx" : "dy"), primal(of_primal, "");
        for (std::uint32_t y = 1; y < 15; ++y)
            for (std::uint32_t x = 1; x < 15; ++x) {
                change += std::pow(of(1, x, y), 2);
                plain += std::pow(primal(1, x, y), 2);
            }
    }
    std::printf("squares of the differences over those of the primal's noise: %.2g\n", change / plain);
    EXPECT_GT(plain, 0);
    EXPECT_LT(change, 1e-3 * plain);
}

/// Walls that mirror some photons and scatter others.
TEST(FullGradientPhotonImage, HasDifferencesOfThePrimalUnderWallsOfPlastic) {
    SceneMaker maker(24, passes);
    maker.floor(-1, 1, 1, maker.material(diffuse(0.5)));
    expect_differences_under_walls("plastic-walls", maker, plastic(0.2, 2.2), plastic(0.5, 1.5), 48);
}

INSTANTIATE_TEST_SUITE_P(Image, GradientPhotons, ::testing::Values(PhotonCase{"cornell-box"}, PhotonCase{"metal-ring"}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Full, GradientPhotons,
                         ::testing::Values(PhotonCase{"cornell-box", true}, PhotonCase{"torus-rough-glass"},
                                           PhotonCase{"plates"}, PhotonCase{"door-ajar"}, PhotonCase{"materials"},
                                           PhotonCase{"lamp-in-egg"}, PhotonCase{"textures"}, PhotonCase{"plastics"},
                                           PhotonCase{"sundial"}, PhotonCase{"slab-and-ball"}),
                         name_of);

class GradientPhotonsOf : public ::testing::TestWithParam<const char *> {
  protected:
    Scene small_scene(std::uint32_t width, std::uint32_t height, std::uint64_t count) const {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", width, height);
        scene.settings.samples_per_pixel = count;
        return scene;
    }
};

/// Strips of some rows, and windows of a few pairs.
TEST_P(GradientPhotonsOf, DoNotDependOnBatches) {
    const Scene scene = small_scene(29, 21, 2);
    RenderOptions options = few_photons();
    options.photons = 2000;
    const Image image = render(scene, options, "gpm").image;
    for (const std::uint32_t batch_size : {64u, 300u}) {
        options.batch_size = batch_size;
        EXPECT_TRUE(equal_bits(image, render(scene, options, "gpm").image)) << "batch size " << batch_size;
    }
}

TEST_P(GradientPhotonsOf, DoNotDependOnThreads) {
    const Scene scene = small_scene(24, 18, 2);
    RenderOptions options = few_photons();
    options.threads = 1;
    const Image image = render(scene, options, "gpm").image;
    options.threads = 3;
    EXPECT_TRUE(equal_bits(image, render(scene, options, "gpm").image));
    options.seed = 1;
    EXPECT_FALSE(equal_bits(image, render(scene, options, "gpm").image));
}

/// The base paths are photon mapping's: the same numbers, added up in another order.
TEST_P(GradientPhotonsOf, HaveThePrimalOfPhotonMapping) {
    Scene scene = small_scene(32, 24, 3);
    scene.settings.hide_emitters = true; // their edges are sampled anew
    RenderOptions options = few_photons();
    options.reconstruction = Reconstruction::l1; // no halves, which have numbers and radii of their own
    const Image primal = whole(render(scene, options, "gpm").image), plain = render(scene, options, "sppm").image;
    const double error = relative_mse(primal, plain);
    std::printf("%s: relMSE of both %.2g\n", GetParam(), error);
    EXPECT_LT(error, 1e-9); // float's rounding, squared, at some hundred sums
}

INSTANTIATE_TEST_SUITE_P(Methods, GradientPhotonsOf, ::testing::Values("cornell-box", "lamp-in-egg"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, GradientPhotonsOf, ::testing::Values("materials", "textures", "plastics"),
                         name_of_scene);

/// What the reconstruction gains where surfaces are diffuse, with the radii of the defaults.
TEST(GradientPhotonImage, HasFarLessErrorThanPhotonMapping) {
    ReferenceScene reference = own_reference("cornell-box");
    reference.scene.settings.samples_per_pixel = 4;
    RenderOptions options;
    options.photons = 250'000;
    const double ours = relative_mse(render(reference.scene, options, "gpm").image, reference.mean);
    const double plain = relative_mse(render(reference.scene, options, "sppm").image, reference.mean);
    std::printf("relMSE of 4 passes: gpm %.2e, sppm %.2e\n", ours, plain);
    EXPECT_LT(ours, 0.5 * plain);
}

/// Blends of what gathers photons with what mirrors them, beside what only gathers: photons are kept wherever any part
/// gathers, also those that have been moved there.
TEST(GradientPhotonImage, HasDifferencesOfThePrimalOfBlendsThatGatherInPart) {
    SceneMaker maker(24, passes);
    maker.look({0, 2, 2.5}, {0, 0, 0}, 30);
    maker.scene.settings.max_depth = 5;
    maker.scene.textures = {random_texture(5, 5, Bitmap::Format::word, false, 4)};
    maker.scene.blended = {diffuse(0.7), mirror(), glass(1.5), diffuse(0.4)};
    maker.scene.blends = {{0, 1, 0.5f}, {2, 3, 0.5f}};
    maker.scene.blends[1].weight.texture = 0;
    Bsdf varnished, stained;
    varnished.blend = 0;
    stained.blend = 1;
    for (int i = 0; i < 6; ++i) // stripes
        maker.floor(-1.2f + 0.4f * float(i), -0.8f + 0.4f * float(i), 1,
                    maker.material(i % 3 == 0   ? two_sided(varnished)
                                   : i % 3 == 1 ? two_sided(diffuse(0.6))
                                                : material_of(stained)));
    maker.parallelogram({0.5f, 0, 0.6f}, {0, 0, -1.2f}, {0.3f, 0.9f, 0}, maker.material(two_sided(varnished)));
    maker.point_light({9, 9, 9}, {-0.3f, 2.5f, 0.4f});
    const std::map<std::string, std::uint64_t> shifts = render(maker.scene, few_photons(), "gpm").statistics.shifts;
    EXPECT_GT(shifts.at("walked"), 100u);
    EXPECT_GT(shifts.at("reconnected"), 500u);
    expect_differences_of_the_primal("blends", maker.scene, few_photons());
}

/// Photons are shifted that came by a part of a blend, but not where the part's chance differs from place to place.
TEST(GradientPhotonImage, WalksByPartsOfBlends) {
    enum Wall { plain, blend, textured };
    Bsdf walls[] = {mirror(), {}, {}};
    walls[blend].blend = 0;
    walls[textured].blend = 1;
    for (const Wall which : {plain, blend, textured}) {
        SceneMaker maker(16, 2);
        maker.scene.textures = {random_texture()};
        maker.scene.blended = {mirror(), mirror(), mirror(), mirror()};
        maker.scene.blends = {{0, 1, 0.5f}, {2, 3, 0.5f}};
        maker.scene.blends[1].weight.texture = 0;
        maker.floor(-1, 1, 1, maker.material(diffuse(0.5)));
        maker.parallelogram({-0.5f, 0, -0.5f}, {0, 1, 0}, {0, 0, 1}, maker.material(two_sided(walls[which])));
        for (const Bsdf &wall : walls) // in the floor's shadow: all have the same kernels
            maker.floor(-0.1f, 0.1f, 0.1f, maker.material(two_sided(wall)), -0.5f);
        maker.lamp({0.5f, 1, 0}, 0.5f, 0.5f, 5, maker.material(diffuse(0)));
        maker.look({0, 3, 0.1}, {0, 0, 0}, 30);
        RenderOptions options;
        options.photons = 4000;
        const Statistics statistics = render(maker.scene, options, "gpm").statistics;
        EXPECT_EQ(statistics.shifts.at("walked") < 100, which == textured) << statistics.shifts.at("walked");
        EXPECT_GT(statistics.shifts.at("reconnected"), 0u);
    }
}

/// All light on a floor comes through glass, from a point in a ball of it or from a sun over a pane: chains alone make
/// the very same image. In a room of rough walls they make none.
TEST(GradientPhotonImage, OfChainsAlone) {
    for (const bool by_the_sun : {false, true}) {
        SceneMaker maker(16, 2);
        maker.look({0, 3, 3}, {0, 0, 0}, 20);
        maker.scene.settings.max_depth = 6;
        maker.floor(-1, 1, 1, maker.material(diffuse(0.7)));
        const std::uint32_t clear = maker.material(glass(1.5));
        if (by_the_sun) {
            maker.parallelogram({-9, 0.5f, 9}, {18, 0, 0}, {0, 0, -18}, clear);
            maker.directional_light({5, 5, 5}, {0.2f, -1, 0.1f});
        } else {
            maker.sphere({0, 1.5f, 0}, 0.3f, clear);
            maker.point_light({5, 5, 5}, {0.05f, 1.5f, 0});
        }
        RenderOptions options = few_photons();
        const Image all = render(maker.scene, options, "gpm").image;
        options.only_chains = true;
        const Image chains = render(maker.scene, options, "gpm").image;
        EXPECT_GT(spread_of(chains, "primal.G").mean, 0);
        for (const char *channel : {"primal.G", "dx.R", "dy.B"})
            EXPECT_EQ(chains.find(channel)->values, all.find(channel)->values) << channel;
    }
    RenderOptions options = few_photons();
    options.only_chains = true;
    Scene room = own_scene("cornell-box.xml", 16, 12);
    room.settings.samples_per_pixel = 2;
    const Image none = render(room, options, "gpm").image;
    for (const char *channel : {"primal.G", "dx.R", "dy.B"})
        EXPECT_EQ(spread_of(none, channel).most, 0) << channel;
}

/// A mirror that sees the sky, and no photon at all: nothing to shift, and nothing that is not finite.
TEST(GradientPhotonImage, IsFiniteWhereNothingIsGathered) {
    SceneMaker maker(24, 2);
    maker.look({0, 1, 5}, {0, 0, 0}, 40);
    maker.floor(-1, 1, 1, maker.material(diffuse(0.5f)));
    maker.sphere({0, 0.5f, 0}, 0.4f, maker.material(mirror()));
    maker.point_light({5, 5, 5}, {1, 3, 2});
    RenderOptions options = few_photons();
    options.photons = 1;
    render(maker.scene, options, "gpm");
}

} // namespace
} // namespace gradus::testing
