#include "runtime/scene/texture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gradus {

namespace {

using Value = std::array<double, 3>;

Value times(double a, const Value &c) { return {a * c[0], a * c[1], a * c[2]}; }
Value plus(const Value &a, const Value &b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

/// Where a coordinate lies in [0, 1].
double wrapped(double s, Texture::Wrap wrap) {
    if (wrap == Texture::Wrap::repeat)
        s -= std::floor(s);
    if (wrap == Texture::Wrap::mirror) {
        s -= 2 * std::floor(s / 2);
        s = std::min(s, 2 - s);
    }
    return s > 0 ? std::min(s, 1.0) : 0; // 0 for what is no number
}

/// The texel at place `i`, which is at most one beyond the picture.
std::uint32_t texel_at(std::int64_t i, std::uint32_t size, Texture::Wrap wrap) {
    if (wrap == Texture::Wrap::repeat)
        return i < 0 ? size - 1 : i >= size ? 0 : std::uint32_t(i);
    return std::uint32_t(std::clamp<std::int64_t>(i, 0, size - 1));
}

Value texel(const Texture &texture, std::uint32_t x, std::uint32_t y) {
    Value color;
    for (int c = 0; c < 3; ++c) {
        const double stored = texture.bitmap->channel(x, y, texture.bitmap->is_color ? c : 0);
        color[c] = texture.is_srgb ? srgb_to_linear_value(stored) : stored;
    }
    return color;
}

Value checkerboard(const Texture &texture, double s, double t) {
    const bool across = s - std::floor(s) > 0.5, down = t - std::floor(t) > 0.5;
    const std::array<float, 3> &color = across == down ? texture.color_0 : texture.color_1;
    return {color[0], color[1], color[2]};
}

} // namespace

std::array<double, 3> texture_finished(const Texture &texture, std::array<double, 3> color) {
    for (int c = 0; c < 3; ++c) {
        const double value = color[c] * texture.scale[c];
        color[c] = value > texture.lowest ? std::min(value, double(texture.highest)) : double(texture.lowest);
    }
    return color;
}

double half_value(std::uint32_t bits) {
    const int exponent = int(bits >> 10 & 31), mantissa = int(bits & 1023);
    const double sign = bits & 0x8000u ? -1 : 1;
    if (exponent == 31)
        return mantissa == 0 ? sign * INFINITY : NAN;
    return sign * (exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25));
}

double srgb_to_linear_value(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

std::uint64_t Bitmap::words_for(std::uint64_t texels, Format format, bool is_color) {
    const std::uint64_t channels = texels * (!is_color ? 1 : format == Format::real ? 3 : 4);
    const std::uint64_t in_a_word = format == Format::byte ? 4 : format == Format::real ? 1 : 2;
    return (channels + in_a_word - 1) / in_a_word;
}

void Bitmap::resize(std::uint32_t new_width, std::uint32_t new_height, Format new_format, bool color) {
    width = new_width;
    height = new_height;
    format = new_format;
    is_color = color;
    words.assign(std::size_t(words_for(std::uint64_t(width) * height, format, is_color)), 0);
}

namespace {

struct TexelPlace {
    std::size_t word;
    std::uint32_t shift, mask;
};

TexelPlace place_of(const Bitmap &bitmap, std::uint32_t x, std::uint32_t y, int channel) {
    const std::uint64_t number = std::uint64_t(y) * bitmap.width + x;
    if (bitmap.format == Bitmap::Format::real)
        return {std::size_t(number * (bitmap.is_color ? 3 : 1) + std::uint64_t(channel)), 0, ~0u};
    const std::uint64_t element = bitmap.is_color ? 4 * number + std::uint64_t(channel) : number;
    if (bitmap.format == Bitmap::Format::byte)
        return {std::size_t(element / 4), 8 * std::uint32_t(element % 4), 0xffu};
    return {std::size_t(element / 2), 16 * std::uint32_t(element % 2), 0xffffu};
}

} // namespace

std::uint32_t Bitmap::bits(std::uint32_t x, std::uint32_t y, int channel) const {
    const TexelPlace place = place_of(*this, x, y, channel);
    return words[place.word] >> place.shift & place.mask;
}

double Bitmap::channel(std::uint32_t x, std::uint32_t y, int channel) const {
    const std::uint32_t stored = bits(x, y, channel);
    switch (format) {
    case Format::byte:
        return stored / 255.0;
    case Format::word:
        return stored / 65535.0;
    case Format::half:
        return half_value(stored);
    case Format::real:
        break;
    }
    return std::bit_cast<float>(stored);
}

void Bitmap::set(std::uint32_t x, std::uint32_t y, int channel, std::uint32_t bits) {
    const TexelPlace place = place_of(*this, x, y, channel);
    words[place.word] = (words[place.word] & ~(place.mask << place.shift)) | (bits & place.mask) << place.shift;
}

std::array<double, 3> texture_value(const Texture &texture, double u, double v) {
    const auto &m = texture.to_uv;
    double s = m[0] * u + m[1] * v + m[2], t = m[3] * u + m[4] * v + m[5];
    s = std::isfinite(s) ? s : 0;
    t = std::isfinite(t) ? t : 0;
    if (texture.kind == Texture::Kind::checkerboard)
        return texture_finished(texture, checkerboard(texture, s, t));
    const Bitmap &bitmap = *texture.bitmap;
    const double x = wrapped(s, texture.wrap) * bitmap.width, y = wrapped(t, texture.wrap_along_v()) * bitmap.height;
    if (texture.is_nearest)
        return texture_finished(texture, texel(texture, std::min(std::uint32_t(x), bitmap.width - 1),
                                               std::min(std::uint32_t(y), bitmap.height - 1)));
    const auto left = std::int64_t(std::floor(x - 0.5)), top = std::int64_t(std::floor(y - 0.5));
    const double right_share = x - 0.5 - double(left), bottom_share = y - 0.5 - double(top);
    const auto row = [&](std::int64_t at) {
        const std::uint32_t line = texel_at(at, bitmap.height, texture.wrap_along_v());
        return plus(times(1 - right_share, texel(texture, texel_at(left, bitmap.width, texture.wrap), line)),
                    times(right_share, texel(texture, texel_at(left + 1, bitmap.width, texture.wrap), line)));
    };
    return texture_finished(texture, plus(times(1 - bottom_share, row(top)), times(bottom_share, row(top + 1))));
}

namespace {

/// What is found, one value of a channel after the other; the sum in place of the mean.
class RangeSum {
  public:
    void add(int channel, double value, double times_found = 1) {
        range_.mean[channel] += value * times_found;
        range_.least[channel] = std::min(range_.least[channel], value);
        range_.most[channel] = std::max(range_.most[channel], value);
    }
    void add(const Value &color) {
        for (int c = 0; c < 3; ++c)
            add(c, color[c]);
    }
    void add(const RangeSum &other) {
        for (int c = 0; c < 3; ++c) {
            range_.mean[c] += other.range_.mean[c];
            range_.least[c] = std::min(range_.least[c], other.range_.least[c]);
            range_.most[c] = std::max(range_.most[c], other.range_.most[c]);
        }
    }
    /// Of so many.
    TextureRange mean(double count) const {
        TextureRange range = range_;
        range.mean = times(1 / count, range.mean);
        return range;
    }

  private:
    TextureRange range_{.mean = {}, .least = {INFINITY, INFINITY, INFINITY}, .most = {-INFINITY, -INFINITY, -INFINITY}};
};

/// Of 8 bits: each of the 256 values is decoded once.
RangeSum sum_of_bytes(const Texture &texture) {
    const Bitmap &bitmap = *texture.bitmap;
    std::array<std::array<std::uint64_t, 256>, 3> found{};
    const std::uint64_t texels = std::uint64_t(bitmap.width) * bitmap.height;
    for (std::uint64_t i = 0; i < texels; ++i)
        for (int c = 0; c < 3; ++c) {
            const std::uint32_t word = bitmap.words[std::size_t(bitmap.is_color ? i : i / 4)];
            ++found[c][word >> 8 * (bitmap.is_color ? std::uint32_t(c) : std::uint32_t(i % 4)) & 255];
        }
    RangeSum sum;
    for (int value = 0; value < 256; ++value) {
        const double stored = value / 255.0, linear = texture.is_srgb ? srgb_to_linear_value(stored) : stored;
        const Value color = texture_finished(texture, {linear, linear, linear});
        for (int c = 0; c < 3; ++c)
            if (found[c][value] > 0)
                sum.add(c, color[c], double(found[c][value]));
    }
    return sum;
}

/// value_at(x, y) of all texels. Rows on all cores, and their sums in their order, so that they are always the same.
template <class ValueAt>
RangeSum sum_of_rows(const Bitmap &bitmap, const ValueAt &value_at) {
    std::vector<RangeSum> rows(bitmap.height);
    tbb::parallel_for(std::uint32_t(0), bitmap.height, [&](std::uint32_t y) {
        RangeSum row; // of its own: others lie beside those of the list
        for (std::uint32_t x = 0; x < bitmap.width; ++x)
            row.add(value_at(x, y));
        rows[y] = row;
    });
    RangeSum sum;
    for (const RangeSum &row : rows)
        sum.add(row);
    return sum;
}

/// Colours of half precision, which large pictures have: each of the 65536 values is decoded once.
RangeSum sum_of_half_colors(const Texture &texture) {
    const Bitmap &bitmap = *texture.bitmap;
    constexpr std::uint32_t codes = 1u << 16;
    std::vector<Value> decoded(codes);
    tbb::parallel_for(std::uint32_t(0), codes, [&](std::uint32_t bits) {
        const double value = half_value(bits);
        decoded[bits] = texture_finished(texture, {value, value, value});
    });
    return sum_of_rows(bitmap, [&](std::uint32_t x, std::uint32_t y) -> Value {
        const std::uint32_t *const words = &bitmap.words[2 * (std::size_t(y) * bitmap.width + x)];
        return {decoded[words[0] & 0xffffu][0], decoded[words[0] >> 16][1], decoded[words[1] & 0xffffu][2]};
    });
}

} // namespace

TextureRange texture_range(const Texture &texture) {
    RangeSum both;
    switch (texture.kind) {
    case Texture::Kind::mesh_attribute:
        both.add(texture_finished(texture, {0, 0, 0}));
        both.add(texture_finished(texture, {1, 1, 1}));
        return both.mean(2);
    case Texture::Kind::checkerboard:
        both.add(texture_finished(texture, checkerboard(texture, 0.25, 0.25)));
        both.add(texture_finished(texture, checkerboard(texture, 0.25, 0.75)));
        return both.mean(2);
    case Texture::Kind::bitmap:
        break;
    }
    const Bitmap &bitmap = *texture.bitmap;
    const double texels = double(bitmap.width) * double(bitmap.height);
    if (bitmap.format == Bitmap::Format::byte)
        return sum_of_bytes(texture).mean(texels);
    if (bitmap.format == Bitmap::Format::half && bitmap.is_color && texels > 1 << 16)
        return sum_of_half_colors(texture).mean(texels);
    return sum_of_rows(bitmap, [&](std::uint32_t x,
                                   std::uint32_t y) { return texture_finished(texture, texel(texture, x, y)); })
        .mean(texels);
}

} // namespace gradus
