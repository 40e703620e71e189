#include "runtime/io/exr_header.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>

namespace gradus {

namespace {

constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t lines_in_a_block = 256; // of the compression that takes most of them

std::uint64_t times(std::uint64_t a, std::uint64_t b) { return b != 0 && a > most / b ? most : a * b; }
std::uint64_t plus(std::uint64_t a, std::uint64_t b) { return a > most - b ? most : a + b; }

class Header {
  public:
    explicit Header(const std::string &path) : file_(path, std::ios::binary) {}

    std::optional<ExrSize> read() {
        if (number() != 0x01312f76u)
            return std::nullopt;
        const bool has_parts = number() & 0x1000u;
        ExrSize sum;
        do {
            const std::optional<ExrSize> part = read_part();
            if (!part) {
                sum.is_whole = false;
                return sum;
            }
            sum.bytes = plus(sum.bytes, part->bytes);
            sum.blocks = plus(sum.blocks, part->blocks);
        } while (has_parts && file_.peek() != 0); // an empty header ends the list
        return sum;
    }

  private:
    std::uint32_t number() {
        unsigned char bytes[4] = {};
        file_.read(reinterpret_cast<char *>(bytes), 4);
        return at(bytes);
    }
    static std::uint32_t at(const unsigned char *bytes) {
        return bytes[0] | std::uint32_t(bytes[1]) << 8 | std::uint32_t(bytes[2]) << 16 | std::uint32_t(bytes[3]) << 24;
    }
    /// Up to its zero byte; names have 255 bytes at most.
    std::string name() {
        std::string text;
        for (int c = file_.get(); c > 0; c = file_.get()) {
            text += char(c);
            if (text.size() > 255)
                file_.setstate(std::ios::failbit);
        }
        return text;
    }

    std::optional<ExrSize> read_part() {
        std::uint64_t width = 0, height = 0, tile_width = 0, tile_height = 0, channels = 0;
        for (std::string attribute = name(); !attribute.empty(); attribute = name()) {
            const std::string type = name();
            const std::uint32_t size = number();
            if (!file_)
                return std::nullopt;
            if (attribute == "dataWindow" && size == 16) {
                std::int64_t box[4];
                for (std::int64_t &side : box)
                    side = std::int32_t(number());
                width = std::uint64_t(std::max<std::int64_t>(box[2] - box[0] + 1, 0));
                height = std::uint64_t(std::max<std::int64_t>(box[3] - box[1] + 1, 0));
            } else if (attribute == "tiles" && size == 9) {
                tile_width = number();
                tile_height = number();
                file_.get();
            } else if (attribute == "channels") {
                const std::streamoff end = file_.tellg() + std::streamoff(size);
                for (; file_ && !name().empty(); ++channels) {
                    // uint, half or float; OpenImageIO 2.4 ends the process at others.
                    if (number() > 2)
                        return std::nullopt;
                    file_.seekg(12, std::ios::cur);
                }
                file_.seekg(end);
            } else
                file_.seekg(size, std::ios::cur);
        }
        if (!file_)
            return std::nullopt;
        ExrSize part;
        part.bytes = times(times(width, height), times(channels, 4));
        part.blocks = tile_width > 0 && tile_height > 0
                          ? times((width + tile_width - 1) / tile_width, (height + tile_height - 1) / tile_height)
                          : height / lines_in_a_block;
        return part;
    }

    std::ifstream file_;
};

} // namespace

std::optional<ExrSize> exr_size(const std::string &path) { return Header(path).read(); }

} // namespace gradus
