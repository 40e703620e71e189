#include "runtime/pictures/image_codec.h"

#include "runtime/film/tonemap.h"
#include "runtime/io/image_checks.h"
#include "runtime/pictures/picture_input.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <algorithm>

namespace gradus {
namespace {

/// As told, 8 bits are unless the file says otherwise; some formats have no place to say so.
bool holds_srgb(const OIIO::ImageSpec &spec, WholeNumbers are) {
    if (are != WholeNumbers::as_told)
        return are == WholeNumbers::srgb &&
               (spec.format == OIIO::TypeDesc::UINT8 || spec.format == OIIO::TypeDesc::UINT16);
    const std::string space(spec.get_string_attribute("oiio:ColorSpace"));
    return !spec.format.is_floating_point() &&
           (space == "sRGB" || (spec.format == OIIO::TypeDesc::UINT8 && !OIIO::Strutil::iequals(space, "linear")));
}

/// Appends the channels of the part that `input` stands at.
void read_part(OIIO::ImageInput &input, int part, const OpenFile &file, WholeNumbers are, PixelLimit &limit,
               Image &image) {
    const OIIO::ImageSpec spec = input.spec();
    if (spec.deep || spec.depth > 1)
        fail_to_read(file, "it is not a plane of pixels");
    limit.begin_part(part, spec.width, spec.height, std::uint64_t(spec.nchannels), image);
    const std::uint32_t width = image.width, height = image.height;
    const std::size_t pixels = std::size_t(width) * height, count = static_cast<std::size_t>(spec.nchannels);
    const std::string part_name(spec.get_string_attribute("oiio:subimagename", std::to_string(part)));
    const std::string prefix = part == 0 ? "" : part_name + ".";
    const bool decode = holds_srgb(spec, are);
    const std::size_t first_channel = image.channels.size();
    for (std::size_t c = 0; c < count; ++c)
        image.channels.push_back({prefix + spec.channelnames[c], std::vector<float>(pixels)});
    // Tiles lie across rows, and are read as a whole.
    const std::uint32_t step = spec.tile_width > 0 ? height : std::min(height, std::uint32_t(rows_at_a_time));
    std::vector<float> rows(std::size_t(step) * width * count);
    for (std::uint32_t begin = 0; begin < height; begin += step) {
        const std::uint32_t end = std::min(begin + step, height);
        const bool done = spec.tile_width > 0
                              ? input.read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, rows.data())
                              : input.read_scanlines(part, 0, spec.y + int(begin), spec.y + int(end), spec.z, 0,
                                                     spec.nchannels, OIIO::TypeDesc::FLOAT, rows.data());
        if (!done)
            fail_to_read(file, named_in(input.geterror(), file));
        for (std::size_t c = 0; c < count; ++c) {
            const bool linear = !decode || static_cast<int>(c) == spec.alpha_channel;
            float *to = image.channels[first_channel + c].values.data() + std::size_t(begin) * width;
            for (std::size_t i = 0; i < std::size_t(end - begin) * width; ++i) {
                const float value = rows[i * count + c];
                to[i] = linear ? value : srgb_decode(value);
            }
        }
    }
    if (part == 0)
        for (const OIIO::ParamValue &attribute : spec.extra_attribs)
            // A part's name, as OpenEXR calls it.
            image.metadata[attribute.name() == "oiio:subimagename" ? "name" : attribute.name().string()] =
                attribute.get_string();
}

} // namespace

Image decode_image(const OpenFile &file, std::uint64_t limits, WholeNumbers are) {
    PixelLimit limit(file, limits);
    const PictureInput opened = open_picture(file);
    if (!opened.input)
        fail_to_read(file, opened.error);
    Image image;
    for (int part = 0; opened.input->seek_subimage(part, 0); ++part)
        read_part(*opened.input, part, file, are, limit, image);
    return image;
}

// Into memory, so that every error of the disk is met, and named, in one place.
std::vector<unsigned char> encode_png(const Image &image, const std::string &path) {
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    std::vector<unsigned char> bytes;
    // As much as there may be: growing would copy what is there, and memory that is not used is not taken.
    bytes.reserve(std::size_t(spec.image_bytes()) + (std::size_t(1) << 16));
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create("png", &memory);
    if (!output)
        fail_to_write(path, OIIO::geterror());
    if (!output->open(path, spec))
        fail_to_write(path, output->geterror());
    std::vector<std::uint8_t> rows(std::size_t(std::min(rows_at_a_time, spec.height)) * image.width * 3);
    for (int begin = 0; begin < spec.height; begin += rows_at_a_time) {
        const int end = std::min(begin + rows_at_a_time, spec.height);
        tonemap(image, std::size_t(begin), std::size_t(end), rows.data());
        if (!output->write_scanlines(begin, end, 0, OIIO::TypeDesc::UINT8, rows.data()))
            fail_to_write(path, output->geterror());
    }
    if (!output->close())
        fail_to_write(path, output->geterror());
    return bytes;
}

} // namespace gradus
