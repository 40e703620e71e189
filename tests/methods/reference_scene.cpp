#include "tests/methods/reference_scene.h"

#include "runtime/film/metrics.h"
#include "runtime/io/image_io.h"
#include "runtime/io/load_scene.h"
#include "tests/support/render.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace gradus::testing {

namespace {

namespace fs = std::filesystem;

const fs::path root = GRADUS_ROOT;
const fs::path shared = root / ".." / "shared";

/// One of ../shared/references: scene file and what its README says of it.
struct SharedReference {
    std::string name, scene;
    std::uint32_t width, height;
    int max_depth;
    double samples_per_pixel;
};
const SharedReference shared_references[] = {{"cornell-box", "cornell-box/scene.xml", 256, 256, 30, 32768},
                                             {"torus-soft", "torus/scene-soft.xml", 256, 192, 30, 32768},
                                             {"veach-mis", "veach-mis/scene.xml", 320, 180, 3, 32768},
                                             {"bathroom", "bathroom/scene-3.xml", 256, 256, 16, 10240}};

void use_box_filter(Scene &scene, std::uint32_t width, std::uint32_t height) {
    FilmSettings film;
    film.width = width;
    film.height = height;
    film.filter = FilmSettings::Filter::box;
    film.filter_radius = 0.5f;
    scene.film = film;
}

constexpr int reference_batches = 64; ///< of tests/references/make.py

std::string score_text(const char *what, const BlockTest &test) {
    const std::size_t per_channel = std::size_t(test.blocks_x) * test.blocks_y;
    const std::size_t at = test.largest_index % per_channel;
    return fmt::format("{}: {} scores, {} not finite, largest |z| {:.2f} in {} at block ({}, {}), limit {:.2f}; "
                       "{} over 3, limit {}\n",
                       what, test.tested, test.non_finite, test.largest,
                       test.channels[test.largest_index / per_channel], at % test.blocks_x, at / test.blocks_x,
                       test.largest_limit, test.over_three, test.over_three_limit);
}

::testing::AssertionResult judge(const std::string &name, const std::vector<Image> &seeds, double samples_per_pixel,
                                 const Image &reference, const Image &variance, double reference_samples_per_pixel,
                                 int batches, int block = 16) {
    const auto test = [&](int size) {
        return block_z_test(seeds, reference, variance, samples_per_pixel, reference_samples_per_pixel, size, batches);
    };
    const BlockTest blocks = test(block), whole = test(0);
    const Image mean = mean_image(seeds);
    const std::string text =
        fmt::format("{}, {} seeds of {} samples a pixel: mean ratio {:.5f}, relMSE {:.2e}\n", name, seeds.size(),
                    samples_per_pixel, compare_means(mean, reference).ratio, relative_mse(mean, reference)) +
        score_text("blocks", blocks) + score_text("whole image", whole);
    std::fputs(text.c_str(), stdout);
    if (blocks.passed() && whole.passed())
        return ::testing::AssertionSuccess() << text;
    const fs::path folder = fs::current_path() / "failed-images";
    fs::create_directories(folder);
    const Image error = relative_error_image(mean, reference);
    write_image(mean, (folder / (name + "-mean.exr")).string());
    write_image(error, (folder / (name + "-error.exr")).string());
    write_png(error_picture(error), (folder / (name + "-error.png")).string());
    return ::testing::AssertionFailure() << text << "images are in " << folder.string();
}

} // namespace

Scene own_scene(const std::string &file, std::uint32_t width, std::uint32_t height) {
    Scene scene = load_scene((root / "scenes" / file).string()).scene;
    use_box_filter(scene, width, height);
    return scene;
}

ReferenceScene own_reference(const std::string &name, LoadOptions options) {
    const fs::path folder = root / "tests" / "references";
    std::ifstream file(folder / (name + ".json"));
    const nlohmann::json json = nlohmann::json::parse(file);
    for (const auto &[key, value] : json.at("parameters").items())
        options.parameters[key] = value.is_string() ? value.get<std::string>() : value.dump();
    ReferenceScene reference;
    reference.name = name;
    reference.scene = load_scene((root / json.at("scene").get<std::string>()).string(), options).scene;
    if (json.at("filter") == "box") // the reference's, whatever the file's
        use_box_filter(reference.scene, json.at("width"), json.at("height"));
    reference.scene.film.width = json.at("width");
    reference.scene.film.height = json.at("height");
    reference.scene.settings.max_depth = json.at("max_depth");
    reference.mean = read_image((folder / (name + "-mean.exr")).string());
    reference.variance = read_image((folder / (name + "-variance.exr")).string());
    reference.samples_per_pixel = json.at("spp");
    if (json.at("width") <= 64 && json.at("filter") == "box") // wider filters make neighbours alike in the reference
        reference.block = 4;
    return reference;
}

bool has_shared_references() { return fs::exists(shared / "references") && fs::exists(shared / "scenes"); }

ReferenceScene shared_reference(const std::string &name) {
    const auto from = std::find_if(std::begin(shared_references), std::end(shared_references),
                                   [&](const SharedReference &reference) { return reference.name == name; });
    if (from == std::end(shared_references))
        throw std::runtime_error("no shared reference " + name);
    ReferenceScene reference;
    reference.name = from->name;
    reference.scene = load_scene((shared / "scenes" / from->scene).string()).scene;
    use_box_filter(reference.scene, from->width, from->height);
    reference.scene.settings.max_depth = from->max_depth;
    reference.mean = read_image((shared / "references" / (from->name + "-mean.exr")).string());
    reference.variance = read_image((shared / "references" / (from->name + "-variance.exr")).string());
    reference.samples_per_pixel = from->samples_per_pixel;
    return reference;
}

::testing::AssertionResult agrees(const std::vector<Image> &seeds, double samples_per_pixel,
                                  const ReferenceScene &reference) {
    return judge(reference.name, seeds, samples_per_pixel, reference.mean, reference.variance,
                 reference.samples_per_pixel, reference_batches, reference.block);
}

bool is_met(const std::vector<Image> &seeds, double samples_per_pixel, const ReferenceScene &reference) {
    const auto passes = [&](int block) {
        return block_z_test(seeds, reference.mean, reference.variance, samples_per_pixel, reference.samples_per_pixel,
                            block, reference_batches)
            .passed();
    };
    return passes(reference.block) && passes(0);
}

double largest_score(const std::vector<Image> &seeds, double samples_per_pixel, const ReferenceScene &reference) {
    const BlockTest blocks = block_z_test(seeds, reference.mean, reference.variance, samples_per_pixel,
                                          reference.samples_per_pixel, reference.block, reference_batches);
    return blocks.largest / blocks.largest_limit;
}

::testing::AssertionResult agree(const std::string &name, const std::vector<Image> &a, const std::vector<Image> &b,
                                 double samples_per_pixel) {
    const MeanAndVariance other = mean_and_variance(b);
    // The counts are left out: what is noise in one set need not be in the other.
    return judge(name, a, samples_per_pixel, other.mean, other.variance, 0, int(b.size()));
}

} // namespace gradus::testing
