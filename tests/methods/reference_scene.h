// Scenes with reference images, and the test that images of independent seeds agree with them.
#pragma once

#include "runtime/film/block_test.h"
#include "runtime/film/image.h"
#include "runtime/io/load_options.h"
#include "runtime/scene/scene.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace gradus::testing {

/// A scene prepared as its reference was rendered, and that reference.
struct ReferenceScene {
    std::string name;
    Scene scene; ///< at the reference's size and depth, box filter
    Image mean, variance;
    double samples_per_pixel = 0; ///< of the reference
    int block = 16; ///< pixels along an edge, of the test; small ones show what a lens or a filter blurs otherwise
};

/// One of the project's own, as tests/references/NAME.json says. Throws where any part of it is missing.
ReferenceScene own_reference(const std::string &name, LoadOptions options = {});

/// True where the folder of shared references is there.
bool has_shared_references();
/// One of ../shared/references, by its name.
ReferenceScene shared_reference(const std::string &name);

/// A file of the project's own scenes, at a size, with the box filter.
Scene own_scene(const std::string &file, std::uint32_t width, std::uint32_t height);

/// The reference's blocks and the whole image, each at the limits that an unbiased renderer fails once in a
/// thousand tests. On failure writes mean, error and picture of the error to the folder failed-images and says so.
::testing::AssertionResult agrees(const std::vector<Image> &seeds, double samples_per_pixel,
                                  const ReferenceScene &reference);

/// Whether agrees() would succeed, without its words and pictures.
bool is_met(const std::vector<Image> &seeds, double samples_per_pixel, const ReferenceScene &reference);

/// The largest score of the blocks, over its limit in agrees().
double largest_score(const std::vector<Image> &seeds, double samples_per_pixel, const ReferenceScene &reference);

/// As agrees(), for two sets of images of one size, of `samples_per_pixel` each, neither of which is a reference.
::testing::AssertionResult agree(const std::string &name, const std::vector<Image> &a, const std::vector<Image> &b,
                                 double samples_per_pixel);

} // namespace gradus::testing
