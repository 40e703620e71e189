#include "runtime/wavefront/shared_weights.h"

#include "kernels/lib/additive_sequence.h"
#include "kernels/lib/filter_table.h"
#include "kernels/lib/random.h"
#include "runtime/wavefront/sample_parts.h"

#include <algorithm>

namespace gradus {

using namespace lib_float;

namespace {

constexpr double least_share = 0.4;

} // namespace

SharedWeights::SharedWeights(const Session &session)
    : session_(session), are_there_(session.has("TRAIT_FILTER_SIGNED")) {}

void SharedWeights::begin_at(std::uint64_t first_frame) {
    first_frame_ = first_frame;
    sums_.clear();
}

/// As kernels/stages/camera.cl draws it.
double SharedWeights::weight(std::uint64_t frame, std::uint32_t start_number) const {
    frame += first_frame_;
    // Where parts are more than two, each has a sequence of its own (kernels/lib/sample_number.h).
    const int bits = session_.traits.at("TRAIT_PART_BITS");
    const std::uint64_t number = bits > 1 ? frame >> bits | frame << (64 - bits) : frame;
    const std::uint64_t seed = session_.options.seed;
    const random_bits start = random_key(std::uint32_t(seed), std::uint32_t(seed >> 32), 0xFFFFFFFFu, start_number,
                                         std::uint32_t(number >> 32));
    const auto low = std::uint32_t(number);
    point2 jitter;
    if (session_.has("TRAIT_STRATIFIED")) {
        jitter = additive_sequence(start.x, start.y, low);
    } else {
        const random4 u = random_draw(start.x, low, random_dimension_camera);
        jitter.x = u.a, jitter.y = u.b;
    }
    const float *camera = session_.scene.camera.data();
    return double(filter_table_sample(camera, 1, jitter.x).weight) * filter_table_sample(camera, 1, jitter.y).weight;
}

SharedWeights::Sums SharedWeights::sums(std::uint64_t frames, std::uint32_t part, std::uint32_t parts) const {
    const auto count = double(count_of_part(frames, part, parts));
    if (!are_there_)
        return {count, count};
    // Even and odd ones are asked for where samples have no parts, too.
    const std::uint64_t all_parts = std::max(1u << session_.traits.at("TRAIT_PART_BITS"), 2u);
    while (sums_.size() < frames) {
        const std::uint64_t frame = sums_.size();
        const double weighs = weight(frame, session_.numbers.at("shared_start"));
        const Sums before = frame >= all_parts ? sums_[frame - all_parts] : Sums();
        sums_.push_back({before.weights + weighs, before.squares + weighs * weighs});
    }
    Sums all;
    for (std::uint64_t first = part; first < std::min(all_parts, frames); first += parts) {
        const Sums &one = sums_[first + (frames - 1 - first) / all_parts * all_parts];
        all.weights += one.weights;
        all.squares += one.squares;
    }
    return all;
}

double SharedWeights::of_part(std::uint64_t frames, std::uint32_t part, std::uint32_t parts) const {
    return std::max(sums(frames, part, parts).weights, least_share * double(count_of_part(frames, part, parts)));
}

SampleWeights SharedWeights::of_samples(std::uint64_t frames, std::uint32_t part, std::uint32_t parts) const {
    const double squares = sums(frames, part, parts).squares;
    const double first = sums(std::min<std::uint64_t>(frames, part + 1), part, parts).squares;
    return {of_part(frames, part, parts), squares, squares - first};
}

std::uint32_t SharedWeights::chosen_start() const {
    constexpr std::uint32_t starts = 256, few = 32;
    constexpr double enough = 0.95;
    if (!are_there_)
        return 0;
    const std::uint32_t parts = 1u << session_.traits.at("TRAIT_PART_BITS");
    std::uint32_t best = 0;
    double best_least = -1e30;
    for (std::uint32_t start = 0; start < starts && best_least < enough; ++start) {
        // The least mean weight of the first frames, of each part and of all.
        std::vector<double> sums(parts + 1, 0.0);
        double least = 1e30;
        for (std::uint32_t frame = 0; frame < few; ++frame) {
            const double weighs = weight(frame, start);
            const std::uint32_t part = frame % parts;
            least = std::min(least, (sums[part] += weighs) / (frame / parts + 1));
            least = std::min(least, (sums[parts] += weighs) / (frame + 1));
        }
        if (least > best_least) {
            best_least = least;
            best = start;
        }
    }
    return best;
}

} // namespace gradus
