#include "driver/place_in_frame.h"

#include <fmt/format.h>

#include <cstdio>

namespace gradus {
namespace {

/// Of a crop and another image that is none.
bool may_be_the_crop(const PlaceInFrame &crop, const PlaceInFrame &image) {
    if (image.is_whole)
        return false;
    PixelPlace first;
    if (!image.origin || *image.origin == PixelPlace{} ||
        std::sscanf(crop.crop.c_str(), "%d,%d", &first.x, &first.y) != 2)
        return true;
    return *image.origin == first;
}

} // namespace

PlaceInFrame place_in_frame(const Image &image) {
    PlaceInFrame place;
    place.origin = image.origin;
    if (const auto crop = image.metadata.find("crop"); crop != image.metadata.end())
        place.crop = crop->second;
    // Renders say their scene. Other programs keep such words where they cut a piece out, and say where it was.
    place.is_whole = place.crop.empty() && image.metadata.count("version") > 0 && image.metadata.count("scene") > 0 &&
                     image.origin.value_or(PixelPlace{}) == PixelPlace{};
    return place;
}

bool may_be_one_place(const PlaceInFrame &one, const PlaceInFrame &other) {
    if (!one.crop.empty() && !other.crop.empty())
        return one.crop == other.crop;
    if (!one.crop.empty() || !other.crop.empty())
        return one.crop.empty() ? may_be_the_crop(other, one) : may_be_the_crop(one, other);
    return !one.origin || !other.origin || one.origin == other.origin;
}

std::string place_text(const PlaceInFrame &place) {
    if (!place.crop.empty())
        return fmt::format("the crop {} of an image", place.crop);
    if (place.is_whole)
        return "a whole image";
    const PixelPlace origin = place.origin.value_or(PixelPlace{});
    return fmt::format("at pixel ({}, {}) of its frame", origin.x, origin.y);
}

} // namespace gradus
