// Images against a reference: every figure of `gradus compare`, as data, as text and as JSON.
#pragma once

#include "runtime/film/block_test.h"
#include "runtime/film/error_calibration.h"
#include "runtime/film/image.h"
#include "runtime/film/metrics.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

struct CompareRequest {
    std::vector<std::string> images; ///< one or more, of independent seeds
    std::string reference, variance; ///< variance: of the reference's mean; empty: none
    std::string layer;               ///< empty: R, G, B
    int block = 16;
    double samples_per_pixel = 0; ///< of one image; 0: what its metadata says
    double reference_spp = 0;     ///< 0: what the reference's metadata says
    int reference_batches = 64;
    double threshold = 0;            ///< largest |z| of a block that passes; 0: Sidak's limit
    double largest_relative_mse = 0; ///< of the images' mean; 0: not judged
    std::uint64_t limits = 1;        ///< of read_image()
};

struct Comparison {
    struct Figures {
        std::string name;
        double relative_mse = 0, trimmed_relative_mse = 0, psnr = 0;
        MeanComparison mean;
        std::uint64_t non_finite = 0;
        std::optional<ErrorCalibration> error_layer; ///< where the image has one
    };
    std::vector<Figures> images;
    std::optional<Figures> mean; ///< of the mean image, where there are several
    std::string reference;
    double reference_peak = 0;
    std::optional<double> reference_relative_mse; ///< of the reference itself, where its variance is given
    std::uint64_t reference_non_finite = 0;
    bool judged = false; ///< by z scores or by relMSE

    int block = 16;
    double samples_per_pixel = 0, reference_spp = 0; ///< 0: not known
    bool variance_given = false;
    std::optional<BlockTest> whole, blocks, pixels; ///< z tests; none where the variance is not known

    std::vector<std::string> notes;    ///< what the user should know
    std::vector<std::string> failures; ///< empty: the comparison holds
    Image mean_image, reference_image; ///< as compared, for an error picture
};

/// Reads the images and computes all figures. The verdict is over the whole image (|z| of each channel within its
/// limit), the blocks (largest |z| and the count over 3), and values that are not finite; pixels are only shown, as
/// single pixels are far from normal. Throws Error.
Comparison compare_images(const CompareRequest &request);

/// What a comparison must be given to judge bias.
extern const char *const what_bias_needs;

std::string comparison_text(const Comparison &comparison);
nlohmann::json comparison_json(const Comparison &comparison);

} // namespace gradus
