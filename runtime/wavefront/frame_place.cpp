#include "runtime/wavefront/frame_place.h"

#include "kernels/lib/additive_sequence.h"
#include "kernels/lib/filter_table.h"
#include "kernels/lib/random.h"

namespace gradus {

using namespace lib_float;

FramePlace frame_place(const Session &session, std::uint64_t frame) {
    // Where parts have a sequence of their own each (kernels/lib/sample_number.h).
    const int bits = session.traits.at("TRAIT_PART_BITS");
    const bool is_apart = bits > 1 || (bits == 1 && !session.has("TRAIT_SHARED_START"));
    const std::uint64_t number = is_apart ? frame >> bits | frame << (64 - bits) : frame;
    const std::uint64_t seed = session.options.seed;
    const random_bits start =
        random_key(std::uint32_t(seed), std::uint32_t(seed >> 32), 0xFFFFFFFFu, 0, std::uint32_t(number >> 32));
    const auto low = std::uint32_t(number);
    point2 place;
    if (session.has("TRAIT_STRATIFIED")) {
        place = additive_sequence(start.x, start.y, low);
    } else {
        const random4 u = random_draw(start.x, low, random_dimension_camera);
        place.x = u.a, place.y = u.b;
    }
    return {filter_number(filter_place_of(place.x)), filter_number(filter_place_of(place.y))};
}

FramePlace place_of_own() {
    const std::uint32_t number = filter_number({filter_cells, 0});
    return {number, number};
}

} // namespace gradus
