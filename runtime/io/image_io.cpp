#include "runtime/io/image_io.h"

#include "runtime/error.h"
#include "runtime/film/tonemap.h"
#include "runtime/io/atomic_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
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
    throw Error(ExitCode::output, fmt::format("cannot write '{}': {}", path, reason));
}

bool holds_srgb(const OIIO::ImageSpec &spec) {
    return !spec.format.is_floating_point() && spec.get_string_attribute("oiio:ColorSpace") == "sRGB";
}

/// Appends the channels of the part that `input` stands at.
void read_part(OIIO::ImageInput &input, int part, const std::string &path, Image &image) {
    const OIIO::ImageSpec spec = input.spec();
    if (spec.deep)
        fail_read(path, "deep images are not supported");
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1)
        fail_read(path, "it is not a plane of pixels");
    const auto width = static_cast<std::uint32_t>(spec.width), height = static_cast<std::uint32_t>(spec.height);
    if (part == 0) {
        image.width = width;
        image.height = height;
    } else if (image.width != width || image.height != height) {
        fail_read(path,
                  fmt::format("part {} is {}x{}, the first one {}x{}", part, width, height, image.width, image.height));
    }
    const std::size_t pixels = std::size_t(width) * height, count = static_cast<std::size_t>(spec.nchannels);
    std::vector<float> interleaved(pixels * count);
    if (!input.read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, interleaved.data()))
        fail_read(path, input.geterror());
    const std::string part_name(spec.get_string_attribute("oiio:subimagename", std::to_string(part)));
    const std::string prefix = part == 0 ? "" : part_name + ".";
    const bool decode = holds_srgb(spec);
    for (std::size_t c = 0; c < count; ++c) {
        Channel channel{prefix + spec.channelnames[c], std::vector<float>(pixels)};
        const bool linear = !decode || static_cast<int>(c) == spec.alpha_channel;
        for (std::size_t i = 0; i < pixels; ++i) {
            const float value = interleaved[i * count + c];
            channel.values[i] = linear ? value : srgb_decode(value);
        }
        image.channels.push_back(std::move(channel));
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

/// Has OpenImageIO encode into memory, so that every error of the disk is met, and named, in one place.
std::vector<unsigned char> encode(const char *format, const OIIO::ImageSpec &spec, OIIO::TypeDesc type,
                                  const void *pixels, const std::string &path) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create(format, &memory);
    if (!output)
        fail_write(path, OIIO::geterror());
    if (!output->open(path, spec) || !output->write_image(type, pixels) || !output->close())
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

Image read_image(const std::string &path) {
    set_up_library();
    const auto input = OIIO::ImageInput::open(path);
    if (!input)
        fail_read(path, OIIO::geterror());
    Image image;
    for (int part = 0; input->seek_subimage(part, 0); ++part)
        read_part(*input, part, path, image);
    return image;
}

void write_image(const Image &image, const std::string &path) {
    set_up_library();
    check_channels(image, path);
    const std::size_t pixels = std::size_t(image.width) * image.height, count = image.channels.size();
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), static_cast<int>(count),
                         OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    for (const Channel &channel : image.channels)
        spec.channelnames.push_back(channel.name);
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    for (const auto &[key, value] : image.metadata)
        spec.attribute(metadata_prefix + key, value);
    std::vector<float> interleaved(pixels * count);
    for (std::size_t c = 0; c < count; ++c)
        for (std::size_t i = 0; i < pixels; ++i)
            interleaved[i * count + c] = image.channels[c].values[i];
    const std::vector<unsigned char> bytes = encode("exr", spec, OIIO::TypeDesc::FLOAT, interleaved.data(), path);
    write_file_atomically(path, bytes.data(), bytes.size());
}

void write_png(const Image &image, const std::string &path) {
    set_up_library();
    check_channels(image, path);
    const std::vector<std::uint8_t> pixels = tonemap(image);
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    const std::vector<unsigned char> bytes = encode("png", spec, OIIO::TypeDesc::UINT8, pixels.data(), path);
    write_file_atomically(path, bytes.data(), bytes.size());
}

} // namespace gradus
