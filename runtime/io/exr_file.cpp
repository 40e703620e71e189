#include "runtime/io/exr_file.h"

#include "runtime/io/image_checks.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <thread>
#include <utility>

namespace gradus {
namespace {

const std::string metadata_prefix = "gradus:";

/// The library keeps buffers for every thread; past a few the disk is the limit. Less than a few of its blocks of 16
/// lines is done by the caller's.
int threads_for(std::uint64_t bytes) {
    constexpr std::uint64_t worth_threads = 1u << 20;
    if (bytes < worth_threads)
        return 0;
    const int threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 4u));
    try {
        // One by one, so that those that were started are kept.
        for (int count = Imf::globalThreadCount(); count < threads; ++count)
            Imf::setGlobalThreadCount(count + 1);
    } catch (const std::exception &) {
        // The system starts no more; fewer do as well.
    }
    return std::min(threads, Imf::globalThreadCount());
}

/// Texts and numbers.
void read_metadata(const Imf::Header &header, Image &image) {
    for (auto at = header.begin(); at != header.end(); ++at) {
        std::string name = at.name();
        if (name.compare(0, metadata_prefix.size(), metadata_prefix) == 0)
            name.erase(0, metadata_prefix.size());
        const Imf::Attribute &attribute = at.attribute();
        if (const auto *text = dynamic_cast<const Imf::StringAttribute *>(&attribute))
            image.metadata[name] = text->value();
        else if (const auto *whole = dynamic_cast<const Imf::IntAttribute *>(&attribute))
            image.metadata[name] = std::to_string(whole->value());
        else if (const auto *real = dynamic_cast<const Imf::FloatAttribute *>(&attribute))
            image.metadata[name] = fmt::format("{}", real->value());
        else if (const auto *longer = dynamic_cast<const Imf::DoubleAttribute *>(&attribute))
            image.metadata[name] = fmt::format("{}", longer->value());
    }
}

/// Layer by layer, those without one first, and in each R, G, B, A before others: files have them by the alphabet.
bool comes_before(const Channel &a, const Channel &b) {
    const auto key = [](const std::string &name) {
        const std::size_t dot = name.rfind('.'), from = dot == std::string::npos ? 0 : dot + 1;
        static const std::string colors = "RGBA";
        const std::size_t rank = name.size() == from + 1 ? colors.find(name[from]) : std::string::npos;
        return std::pair(name.substr(0, from), rank);
    };
    return key(a.name) < key(b.name);
}

/// Appends the channels of a part.
void read_part(Imf::MultiPartInputFile &input, int number, const OpenFile &file, PixelLimit &limit, Image &image) {
    const Imf::Header &header = input.header(number);
    if (header.hasType() && Imf::isDeepData(header.type()))
        fail_to_read(file, "deep images are not supported");
    const Imath::Box2i window = header.dataWindow();
    const std::int64_t wide = std::int64_t(window.max.x) - window.min.x + 1,
                       high = std::int64_t(window.max.y) - window.min.y + 1;
    const Imf::ChannelList &channels = header.channels();
    std::uint64_t count = 0;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
        ++count;
    limit.begin_part(number, wide, high, count, image);
    const PixelPlace origin{window.min.x, window.min.y};
    if (number == 0) {
        read_metadata(header, image);
        image.origin = origin;
    } else if (image.origin != origin)
        fail_to_read(file, fmt::format("part {} begins at pixel ({}, {}), the first one at ({}, {})", number, origin.x,
                                       origin.y, image.origin->x, image.origin->y));
    const std::string prefix = number == 0 ? "" : (header.hasName() ? header.name() : std::to_string(number)) + ".";
    Imf::FrameBuffer planes;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
            fail_to_read(file, fmt::format("its channel '{}' has not a value for each pixel", channel.name()));
        std::vector<float> values(std::size_t(image.width) * image.height);
        planes.insert(channel.name(), Imf::Slice::Make(Imf::FLOAT, values.data(), window));
        image.channels.push_back({prefix + channel.name(), std::move(values)});
    }
    std::stable_sort(image.channels.end() - std::ptrdiff_t(count), image.channels.end(), comes_before);
    Imf::InputPart part(input, number);
    part.setFrameBuffer(planes);
    part.readPixels(window.min.y, window.max.y);
}

class MemoryStream : public Imf::OStream {
  public:
    MemoryStream(const std::string &path, std::uint64_t expected_bytes) : Imf::OStream(path.c_str()) {
        // As much as there may be: growing would copy what is there, and memory that is not used is not taken.
        bytes.reserve(expected_bytes);
    }
    void write(const char from[], int count) override {
        const std::size_t end = at_ + std::size_t(count);
        if (end > bytes.size())
            bytes.resize(end);
        std::memcpy(bytes.data() + at_, from, std::size_t(count));
        at_ = end;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t position) override { at_ = position; }

    std::vector<unsigned char> bytes;

  private:
    std::size_t at_ = 0;
};

std::uint64_t bytes_of(const Image &image) {
    return std::uint64_t(image.width) * image.height * image.channels.size() * sizeof(float);
}

std::vector<unsigned char> encode(const Image &image, Imf::Compression compression, const std::string &path) {
    const PixelPlace first = image.origin.value_or(PixelPlace{});
    const Imath::Box2i window({first.x, first.y}, {first.x + int(image.width) - 1, first.y + int(image.height) - 1});
    Imf::Header header(window, window);
    header.compression() = compression;
    for (const auto &[key, value] : image.metadata)
        header.insert(metadata_prefix + key, Imf::StringAttribute(value));
    Imf::FrameBuffer planes;
    for (const Channel &channel : image.channels) {
        header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
        planes.insert(channel.name, Imf::Slice::Make(Imf::FLOAT, channel.values.data(), window));
    }
    MemoryStream memory(path, bytes_of(image) + (1u << 16));
    {
        Imf::OutputFile output(memory, header, threads_for(bytes_of(image)));
        output.setFrameBuffer(planes);
        output.writePixels(int(image.height));
    } // the table of lines is written last
    return std::move(memory.bytes);
}

/// Noise does not: of an image of few samples zip saves a fourteenth, and takes as long as the reconstruction. Tried
/// with some lines of it.
bool pays_to_compress(const Image &image, const std::string &path) {
    constexpr std::uint32_t tried = 16; // a block of OpenEXR's
    constexpr double worth = 0.85;
    if (image.height <= 2 * tried)
        return true;
    Image lines{image.width, tried, {}, {}};
    for (const Channel &channel : image.channels) {
        std::vector<float> values;
        for (std::uint32_t i = 0; i < tried; ++i) {
            const auto line =
                channel.values.begin() + std::ptrdiff_t(std::size_t(i) * image.height / tried * image.width);
            values.insert(values.end(), line, line + image.width);
        }
        lines.channels.push_back({channel.name, std::move(values)});
    }
    return double(encode(lines, Imf::ZIP_COMPRESSION, path).size()) < worth * double(bytes_of(lines));
}

} // namespace

Image read_exr(const OpenFile &file, const ExrSize &declared, std::uint64_t limits) {
    PixelLimit limit(file, limits);
    limit.check_bytes(declared.bytes);
    if (!declared.fits(file.bytes()))
        fail_to_read(file, "it is truncated or damaged: its header and its size do not agree");
    Image image;
    try {
        Imf::MultiPartInputFile input(file.library_name().c_str(), threads_for(declared.bytes));
        for (int part = 0; part < input.parts(); ++part)
            read_part(input, part, file, limit, image);
    } catch (const Iex::BaseExc &error) {
        fail_to_read(file, named_in(error.what(), file));
    }
    return image;
}

std::vector<unsigned char> encode_exr(const Image &image, const std::string &path) {
    try {
        return encode(image, pays_to_compress(image, path) ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION, path);
    } catch (const std::exception &error) {
        fail_to_write(path, error.what());
    }
}

} // namespace gradus
