#include "runtime/pictures/bitmap_decoder.h"

#include "runtime/error.h"
#include "runtime/io/exr_header.h"
#include "runtime/io/image_checks.h"
#include "runtime/pictures/picture_input.h"

#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

namespace gradus {

namespace {

[[noreturn]] void refuse(const std::string &path, const std::string &reason) {
    throw Error(ExitCode::image, fmt::format("cannot read the texture '{}': {}", path, reason));
}

Bitmap::Format format_of(const OIIO::ImageSpec &spec) {
    switch (spec.format.basetype) {
    case OIIO::TypeDesc::UINT8:
        return Bitmap::Format::byte;
    case OIIO::TypeDesc::UINT16:
        return Bitmap::Format::word;
    case OIIO::TypeDesc::HALF:
        return Bitmap::Format::half;
    default:
        return Bitmap::Format::real;
    }
}

OIIO::TypeDesc type_of(Bitmap::Format format) {
    switch (format) {
    case Bitmap::Format::byte:
        return OIIO::TypeDesc::UINT8;
    case Bitmap::Format::word:
        return OIIO::TypeDesc::UINT16;
    case Bitmap::Format::half:
        return OIIO::TypeDesc::HALF;
    case Bitmap::Format::real:
        break;
    }
    return OIIO::TypeDesc::FLOAT;
}

void check_bytes(const OpenFile &file, double bytes, std::uint64_t limits) {
    const double most = double(most_pixel_bytes(file, limits));
    if (bytes > most)
        refuse(file.name().string(),
               fmt::format("its pixels would take {:.0f} MiB, far more than a file of its size holds; --limits 10 "
                           "allows ten times the {:.0f} MiB that are read",
                           bytes / 0x1p20, most / 0x1p20));
}

/// Before anything is allocated.
void check_size(const OpenFile &file, const OIIO::ImageSpec &spec, std::uint64_t limits) {
    if (spec.deep || spec.depth > 1 || spec.width <= 0 || spec.height <= 0)
        refuse(file.name().string(), "it is not a plane of pixels");
    check_bytes(file, double(spec.width) * spec.height * spec.nchannels * double(spec.format.size()), limits);
}

void check_exr(const OpenFile &file, std::uint64_t limits) {
    const std::optional<ExrSize> declared = exr_size(file.library_name());
    if (!declared)
        return;
    if (!declared->fits(file.bytes()))
        refuse(file.name().string(), "it is truncated or damaged: its header and its size do not agree");
    check_bytes(file, double(declared->bytes), limits);
}

int channel_named(const OIIO::ImageSpec &spec, const std::string &name) {
    for (int c = 0; c < spec.nchannels; ++c)
        if (OIIO::Strutil::iequals(spec.channelnames[std::size_t(c)], name))
            return c;
    return -1;
}

/// The channels to take: one or three.
std::vector<int> channels_of(const std::string &path, const OIIO::ImageSpec &spec, const BitmapRequest &request) {
    const std::string &asked = request.channel;
    if (!asked.empty()) {
        int channel = asked == "a" && spec.alpha_channel >= 0 ? spec.alpha_channel : channel_named(spec, asked);
        if (channel < 0 && (asked == "r" || asked == "g" || asked == "b")) // all that gray has is its one channel
            channel = spec.nchannels < 3 ? 0 : asked == "r" ? 0 : asked == "g" ? 1 : 2;
        if (channel < 0)
            refuse(path, fmt::format("it has no channel \"{}\"", asked));
        return {channel};
    }
    const int r = channel_named(spec, "R"), g = channel_named(spec, "G"), b = channel_named(spec, "B");
    if (r >= 0 && g >= 0 && b >= 0)
        return {r, g, b};
    const int x = channel_named(spec, "X"), y = channel_named(spec, "Y"), z = channel_named(spec, "Z");
    if (x >= 0 && y >= 0 && z >= 0) {
        if (request.is_linear) // a vector
            return {x, y, z};
        refuse(path, "its channels are X, Y and Z, colours of CIE XYZ or vectors: save colours as R, G and B; vectors "
                     "are read with raw set to true");
    }
    if (y >= 0)
        return {y};
    std::vector<int> others_than_alpha;
    for (int c = 0; c < spec.nchannels; ++c)
        if (c != spec.alpha_channel)
            others_than_alpha.push_back(c);
    if (spec.nchannels == 1 || others_than_alpha.size() == 1)
        return {others_than_alpha.empty() ? 0 : others_than_alpha.front()};
    if (others_than_alpha.size() == 2)
        refuse(path, fmt::format("its channels are {}: gray has one, with or without alpha, and colour R, G and B",
                                 OIIO::Strutil::join(spec.channelnames, ", ")));
    if (spec.nchannels <= 4)
        return {others_than_alpha[0], others_than_alpha[1], others_than_alpha[2]};
    refuse(path, fmt::format("of its {} channels none are R, G, B or Y", spec.nchannels));
}

/// Calls use(y, row) for each row of the file.
template <class Value, class Use>
void for_each_row(OIIO::ImageInput &input, const OpenFile &file, OIIO::TypeDesc type, Use use) {
    const OIIO::ImageSpec spec = input.spec();
    const int step = spec.tile_width > 0 ? spec.height : std::min(spec.height, rows_at_a_time); // tiles: as a whole
    const std::size_t line = std::size_t(spec.width) * std::size_t(spec.nchannels);
    std::vector<Value> rows(line * std::size_t(step));
    for (int begin = 0; begin < spec.height; begin += step) {
        const int end = std::min(begin + step, spec.height);
        const bool done = spec.tile_width > 0 ? input.read_image(0, 0, 0, spec.nchannels, type, rows.data())
                                              : input.read_scanlines(0, 0, spec.y + begin, spec.y + end, spec.z, 0,
                                                                     spec.nchannels, type, rows.data());
        if (!done)
            refuse(file.name().string(), named_in(input.geterror(), file));
        for (int y = begin; y < end; ++y)
            use(std::uint32_t(y), rows.data() + line * std::size_t(y - begin));
    }
}

} // namespace

ReadBitmap decode_bitmap(const OpenFile &file, const BitmapRequest &request) {
    const std::string path = file.name().string();
    check_exr(file, request.limits);
    const PictureInput opened = open_picture(file);
    if (!opened.input)
        refuse(path, opened.error);
    OIIO::ImageInput &input = *opened.input;
    const OIIO::ImageSpec spec = input.spec();
    check_size(file, spec, request.limits);
    const std::vector<int> channels = channels_of(path, spec, request);
    const bool is_alpha = channels.size() == 1 && channels[0] == spec.alpha_channel;
    ReadBitmap read;
    const Bitmap::Format stored = format_of(spec);
    const bool is_integer = stored == Bitmap::Format::byte || stored == Bitmap::Format::word;
    const bool is_srgb = is_integer && !request.is_linear && !is_alpha;
    const bool unfolds = is_srgb && stored == Bitmap::Format::word;
    read.is_srgb = is_srgb && !unfolds;
    read.bitmap.path = path;
    read.bitmap.resize(std::uint32_t(spec.width), std::uint32_t(spec.height), unfolds ? Bitmap::Format::real : stored,
                       channels.size() == 3);
    Bitmap &bitmap = read.bitmap;
    const auto channel = [&](const auto *texel, std::size_t c) { return texel[channels[c]]; };
    const auto copy = [&]<class Value>(const Value *row, std::uint32_t y, auto convert) {
        if (bitmap.is_color && bitmap.format != Bitmap::Format::byte) {
            // Colours of large pictures: whole words, three or two each.
            const bool is_wide = bitmap.format == Bitmap::Format::real;
            std::uint32_t *to = bitmap.words.data() + std::size_t(y) * bitmap.width * (is_wide ? 3 : 2);
            for (std::uint32_t x = 0; x < bitmap.width; ++x, row += spec.nchannels) {
                const std::uint32_t r = convert(channel(row, 0)), g = convert(channel(row, 1)),
                                    b = convert(channel(row, 2));
                *to++ = is_wide ? r : r | g << 16;
                if (is_wide)
                    *to++ = g;
                *to++ = b;
            }
            return;
        }
        for (std::uint32_t x = 0; x < bitmap.width; ++x)
            for (std::size_t c = 0; c < channels.size(); ++c)
                bitmap.set(x, y, int(c),
                           convert(row[std::size_t(x) * std::size_t(spec.nchannels) + std::size_t(channels[c])]));
    };
    const auto as_stored = [](auto value) { return std::uint32_t(value); };
    switch (stored) {
    case Bitmap::Format::byte:
        for_each_row<std::uint8_t>(input, file, type_of(stored), [&](std::uint32_t y, const std::uint8_t *row) {
            if (!bitmap.is_color)
                return copy(row, y, as_stored);
            // What large pictures are: a word each.
            std::uint32_t *to = bitmap.words.data() + std::size_t(y) * bitmap.width;
            for (std::uint32_t x = 0; x < bitmap.width; ++x, row += spec.nchannels)
                to[x] = channel(row, 0) | std::uint32_t(channel(row, 1)) << 8 | std::uint32_t(channel(row, 2)) << 16;
        });
        break;
    case Bitmap::Format::word:
        for_each_row<std::uint16_t>(input, file, type_of(stored), [&](std::uint32_t y, const std::uint16_t *row) {
            if (unfolds)
                copy(row, y, [](std::uint16_t value) {
                    return std::bit_cast<std::uint32_t>(float(srgb_to_linear_value(value / 65535.0)));
                });
            else
                copy(row, y, as_stored);
        });
        break;
    case Bitmap::Format::half:
        for_each_row<std::uint16_t>(input, file, type_of(stored), [&](std::uint32_t y, const std::uint16_t *row) {
            copy(row, y, [&](std::uint16_t bits) {
                const bool is_number = (bits & 0x7c00u) != 0x7c00u;
                read.not_numbers += !is_number;
                return is_number ? std::uint32_t(bits) : 0;
            });
        });
        break;
    case Bitmap::Format::real:
        // OpenImageIO divides whole numbers of 32 bits by the largest; OpenEXR's are what they say.
        const bool counts = spec.format == OIIO::TypeDesc::UINT32 && std::string(input.format_name()) == "openexr";
        const float unit = counts ? 0x1p32f : 1;
        for_each_row<float>(input, file, type_of(stored), [&](std::uint32_t y, const float *row) {
            copy(row, y, [&](float divided) {
                const float value = divided * unit;
                const bool is_number = std::isfinite(value);
                read.not_numbers += !is_number;
                return is_number ? std::bit_cast<std::uint32_t>(value) : 0;
            });
        });
        break;
    }
    return read;
}

} // namespace gradus
