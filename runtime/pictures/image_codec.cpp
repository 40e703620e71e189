#include "runtime/pictures/image_codec.h"

#include "runtime/error.h"
#include "runtime/film/tonemap.h"
#include "runtime/io/exr_header.h"
#include "runtime/pictures/picture_input.h"

#include <OpenImageIO/filesystem.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <thread>

namespace gradus {
namespace {

constexpr const char *metadata_prefix = "gradus:";

/// OpenEXR keeps buffers for every thread; past a few the disk is the limit.
void set_up_library() {
    static const bool done = [] {
        const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
        OIIO::attribute("exr_threads", static_cast<int>(std::min(cores, 4u)));
        return true;
    }();
    (void)done;
}

[[noreturn]] void fail_read(const std::string &path, const std::string &reason) {
    throw Error(ExitCode::image, fmt::format("cannot read the image '{}': {}", path, reason));
}

[[noreturn]] void fail_write(const std::string &path, const std::string &reason) {
    // Without memory the library has no words for its error either. Encoding meets no disk.
    if (reason.empty())
        throw Error(ExitCode::device, fmt::format("cannot write '{}': there is not enough memory to encode it; try a "
                                                  "smaller --size, or a --crop",
                                                  path));
    throw Error(ExitCode::output, fmt::format("cannot write '{}': {}", path, reason));
}

bool holds_srgb(const OIIO::ImageSpec &spec) {
    return !spec.format.is_floating_point() && spec.get_string_attribute("oiio:ColorSpace") == "sRGB";
}

/// What may be read of a file.
class PixelLimit {
  public:
    PixelLimit(const OpenFile &file, std::uint64_t limits)
        : path_(file.name().string()), most_channels_(1024 * limits), most_bytes_(most_pixel_bytes(file, limits)) {
        if (const std::optional<ExrSize> declared = exr_size(file.library_name())) {
            check_bytes(declared->bytes);
            if (!declared->is_whole || declared->blocks > file.bytes() / 8)
                fail_read(path_, "it is truncated or damaged: its header and its size do not agree");
        }
    }

    /// Before a part's pixels are read.
    void count(const OIIO::ImageSpec &spec) {
        channels_ += std::uint64_t(spec.nchannels);
        if (channels_ > most_channels_)
            fail_read(path_, fmt::format("it has more than {} channels; --limits 10 allows ten times as many",
                                         most_channels_));
        // At most 2^31 times 2^31 times 1024 * 4: in floating point, against overflow.
        const double bytes = double(spec.width) * double(spec.height) * double(spec.nchannels) * sizeof(float);
        check_bytes(bytes < 1e18 ? std::uint64_t(bytes) + bytes_ : ~std::uint64_t(0));
        bytes_ += std::uint64_t(bytes);
    }

  private:
    void check_bytes(std::uint64_t bytes) const {
        if (bytes > most_bytes_)
            fail_read(path_, fmt::format("its pixels would take {} MiB, far more than a file of its size holds; "
                                         "--limits 10 allows ten times the {} MiB that are read",
                                         bytes >> 20, most_bytes_ >> 20));
    }

    const std::string path_;
    std::uint64_t most_channels_, most_bytes_, channels_ = 0, bytes_ = 0;
};

/// Appends the channels of the part that `input` stands at.
void read_part(OIIO::ImageInput &input, int part, const OpenFile &file, PixelLimit &limit, Image &image) {
    const OIIO::ImageSpec spec = input.spec();
    const std::string path = file.name().string();
    if (spec.deep)
        fail_read(path, "deep images are not supported");
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1)
        fail_read(path, "it is not a plane of pixels");
    limit.count(spec);
    const auto width = static_cast<std::uint32_t>(spec.width), height = static_cast<std::uint32_t>(spec.height);
    if (part == 0) {
        image.width = width;
        image.height = height;
    } else if (image.width != width || image.height != height) {
        fail_read(path,
                  fmt::format("part {} is {}x{}, the first one {}x{}", part, width, height, image.width, image.height));
    }
    const std::size_t pixels = std::size_t(width) * height, count = static_cast<std::size_t>(spec.nchannels);
    const std::string part_name(spec.get_string_attribute("oiio:subimagename", std::to_string(part)));
    const std::string prefix = part == 0 ? "" : part_name + ".";
    const bool decode = holds_srgb(spec);
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
            fail_read(path, named_in(input.geterror(), file));
        for (std::size_t c = 0; c < count; ++c) {
            const bool linear = !decode || static_cast<int>(c) == spec.alpha_channel;
            float *to = image.channels[first_channel + c].values.data() + std::size_t(begin) * width;
            for (std::size_t i = 0; i < std::size_t(end - begin) * width; ++i) {
                const float value = rows[i * count + c];
                to[i] = linear ? value : srgb_decode(value);
            }
        }
    }
    if (part == 0) {
        const std::string lead = metadata_prefix;
        for (const OIIO::ParamValue &attribute : spec.extra_attribs) {
            std::string name = attribute.name().string();
            if (name.compare(0, lead.size(), lead) == 0)
                name.erase(0, lead.size());
            image.metadata[name] = attribute.get_string();
        }
    }
}

/// Has OpenImageIO encode into memory, so that every error of the disk is met, and named, in one place. `fill` writes
/// the values of rows [begin, end), interleaved.
template <class Value, class Fill>
std::vector<unsigned char> encode(const char *format, const OIIO::ImageSpec &spec, Fill fill, const std::string &path) {
    std::vector<unsigned char> bytes;
    // As much as there may be: growing would copy what is there, and memory that is not used is not taken.
    bytes.reserve(std::size_t(spec.image_bytes(true)) + (std::size_t(1) << 16));
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create(format, &memory);
    if (!output)
        fail_write(path, OIIO::geterror());
    if (!output->open(path, spec))
        fail_write(path, output->geterror());
    std::vector<Value> rows(std::size_t(std::min(rows_at_a_time, spec.height)) * std::size_t(spec.width) *
                            std::size_t(spec.nchannels));
    for (int begin = 0; begin < spec.height; begin += rows_at_a_time) {
        const int end = std::min(begin + rows_at_a_time, spec.height);
        fill(std::size_t(begin), std::size_t(end), rows.data());
        if (!output->write_scanlines(begin, end, 0, OIIO::TypeDesc(OIIO::BaseTypeFromC<Value>::value), rows.data()))
            fail_write(path, output->geterror());
    }
    if (!output->close())
        fail_write(path, output->geterror());
    return bytes;
}

void check_channels(const Image &image, const std::string &path) {
    if (image.width == 0 || image.height == 0 || image.channels.empty())
        fail_write(path, "the image is empty");
    for (const Channel &channel : image.channels)
        if (channel.values.size() != std::size_t(image.width) * image.height)
            fail_write(path, fmt::format("channel '{}' has {} values, not {} x {}", channel.name, channel.values.size(),
                                         image.width, image.height));
}

} // namespace

Image decode_image(const OpenFile &file, std::uint64_t limits) {
    set_up_library();
    PixelLimit limit(file, limits);
    const PictureInput opened = open_picture(file);
    if (!opened.input)
        fail_read(file.name().string(), opened.error);
    Image image;
    for (int part = 0; opened.input->seek_subimage(part, 0); ++part)
        read_part(*opened.input, part, file, limit, image);
    return image;
}

std::vector<unsigned char> encode_exr(const Image &image, const std::string &path) {
    set_up_library();
    check_channels(image, path);
    const std::size_t width = image.width, count = image.channels.size();
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), static_cast<int>(count),
                         OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    for (const Channel &channel : image.channels)
        spec.channelnames.push_back(channel.name);
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    for (const auto &[key, value] : image.metadata)
        spec.attribute(metadata_prefix + key, value);
    const auto interleave = [&](std::size_t begin, std::size_t end, float *to) {
        for (std::size_t c = 0; c < count; ++c) {
            const float *from = image.channels[c].values.data() + begin * width;
            for (std::size_t i = 0; i < (end - begin) * width; ++i)
                to[i * count + c] = from[i];
        }
    };
    return encode<float>("exr", spec, interleave, path);
}

std::vector<unsigned char> encode_png(const Image &image, const std::string &path) {
    set_up_library();
    check_channels(image, path);
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    const auto fill = [&](std::size_t begin, std::size_t end, std::uint8_t *to) { tonemap(image, begin, end, to); };
    return encode<std::uint8_t>("png", spec, fill, path);
}

} // namespace gradus
