// Groups of shapes that are kept as instances: images of Mitsuba 3, and those of the same scene as copies.
#include "runtime/error.h"
#include "runtime/io/load_scene.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/stability.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

LoadOptions as(InstanceChoice choice) {
    LoadOptions options;
    options.instances = choice;
    return options;
}

/// tests/scenes/instances.xml: textures, opacity, glass, anisotropic metal under a bump map, a mirror beside a rough
/// lobe and coarse normals; moved, mirrored, stretched, and sheared and mirrored.
ReferenceScene group_of_all(InstanceChoice choice, std::uint64_t samples) {
    ReferenceScene reference = own_reference("instances", as(choice));
    reference.scene.settings.samples_per_pixel = samples;
    return reference;
}

TEST(Instances, AreWhatMitsubaMakesOfThem) {
    const ReferenceScene kept = group_of_all(InstanceChoice::kept, 64);
    ASSERT_EQ(kept.scene.instances.size(), 4u);
    const std::vector<Image> images = render_seeds(kept.scene, 8);
    EXPECT_TRUE(agrees(images, 64, kept));
    const double score = largest_score(images, 64, kept);
    record_stability({"Numbers",
                      "instances that are mirrored or sheared turn surfaces over, or light them from elsewhere",
                      "a group of textured, glassy, half open and bumpy shapes: moved, mirrored, stretched, sheared",
                      "vertices are taken to the world, normals by the cofactors and the determinant's sign",
                      "largest z-score of 4 x 4 pixels against Mitsuba 3, over its limit", score, 1});
}

/// Images of one seed, as instances and as copies, against those of two seeds.
void expect_same_paths(const char *method, std::uint64_t samples, double most) {
    const Scene kept = group_of_all(InstanceChoice::kept, samples).scene;
    const Scene copies = group_of_all(InstanceChoice::copies, samples).scene;
    EXPECT_EQ(copies.instances.size(), 0u);
    RenderOptions options;
    options.photons = 100'000;
    const std::vector<Image> of_copies = render_seeds(copies, 2, options, 1, method);
    const Image of_kept = render_seeds(kept, 1, options, 1, method).front();
    const double alike = relative_mse(of_kept, of_copies[0]), apart = relative_mse(of_copies[1], of_copies[0]);
    fmt::print("{}: relMSE of one seed {:.3g}, of two {:.3g}\n", method, alike, apart);
    EXPECT_LT(alike, most * apart);
}

// The paths of one seed are the same but where rounding, or the chance to pass a surface that is half open, which goes
// by the instance, sends one another way. Light that went wrong everywhere would be as different as that of another
// seed.
TEST(FullInstances, HaveThePathsOfCopies) { expect_same_paths("pt", 64, 0.25); }
TEST(FullInstances, HaveThePathsOfCopiesInGradients) { expect_same_paths("gpt", 16, 0.5); }
TEST(FullInstances, HaveThePathsOfCopiesInGradientsOfManySamples) { expect_same_paths("gpt", 1024, 0.5); }
TEST(FullInstances, HaveThePathsOfCopiesInPhotons) { expect_same_paths("sppm", 64, 0.5); }

TEST(FullInstances, AgreeWithCopiesInGradients) {
    const auto images = [](InstanceChoice choice, std::uint64_t first) {
        return render_seeds(group_of_all(choice, 64).scene, 8, {}, first, "gpt");
    };
    EXPECT_TRUE(agree("instances-gpt", images(InstanceChoice::kept, 1), images(InstanceChoice::copies, 100), 64));
}

// Nothing of an image depends on how rays were packed, nor on where the path tracer's batch ended.
TEST(Instances, AreTheSameInAnyBatch) {
    const Scene scene = group_of_all(InstanceChoice::kept, 4).scene;
    RenderOptions small, large;
    small.batch_size = 1000;
    large.threads = 1;
    const Image a = render(scene, small).image, b = render(scene, large).image;
    for (const char *channel : {"R", "G", "B"})
        EXPECT_EQ(a.find(channel)->values, b.find(channel)->values);
}

TEST(Instances, AreRefusedByWalks) {
    Scene scene = group_of_all(InstanceChoice::kept, 1).scene;
    scene.textures.clear();
    scene.materials.assign(scene.materials.size(), Material());
    for (Shape &shape : scene.shapes)
        shape.emitter = -1;
    try {
        make_method("gpm", shared_device(), scene, {});
        FAIL();
    } catch (const Error &error) {
        EXPECT_NE(std::string(error.what()).find("--instances copies"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace gradus::testing
