/* The value of a texture at a point of a surface; texture_value() of runtime/scene/texture.h is the same in double. All
 * that the scene's textures have is computed for each row and one of it taken: TRAIT_TEXTURES says what they have. */
#ifndef GRADUS_LIB_TEXTURE_LOOKUP_H
#define GRADUS_LIB_TEXTURE_LOOKUP_H
//! traits: TRAIT_TEXTURES
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"
#include "kernels/shared/texture.h"

#if HAS_TEXTURES || !defined(__OPENCL_VERSION__)
GRADUS_LIB_BEGIN

#define TEXTURES_HAVE(feature) ((TRAIT_TEXTURES & (feature)) != 0)

/* n itself, computed after x, which must be finite (kernels/lib/ordered.h): indices into one array are packed too. */
GRADUS_FN uint texture_after(uint n, real x) { return n + (uint)(int)(R(0) * x); }

/* Where a coordinate lies in [0, 1]; 0 for what is no finite number. */
GRADUS_FN real texture_wrapped(real s, uint flags) {
    real place = s - r_floor(s);
    if (TEXTURES_HAVE(textures_wrapped_otherwise)) {
        const real twice = s - R(2) * r_floor(R(0.5) * s);
        const real mirrored = r_min(twice, R(2) - twice);
        const real other = texture_wrap(flags) == texture_wrap_mirror ? mirrored : s;
        place = texture_wrap(flags) == texture_wrap_repeat ? place : other;
    }
    return r_clamp(place, R(0), R(1));
}

/* The texel at place i, which is at most one before the picture; any other i is brought into it too. */
GRADUS_FN uint texture_texel(int i, uint size, uint flags) {
    const int repeats = !TEXTURES_HAVE(textures_wrapped_otherwise) || texture_wrap(flags) == texture_wrap_repeat;
    const uint inside = r_min((uint)i, size - 1u);
    return i < 0 ? (repeats ? size - 1u : 0u) : inside;
}

/* The one after that, texel `before`. */
GRADUS_FN uint texture_next_texel(int i, uint before, uint size, uint flags) {
    const int repeats = !TEXTURES_HAVE(textures_wrapped_otherwise) || texture_wrap(flags) == texture_wrap_repeat;
    const uint inside = before + 1u < size ? before + 1u : (repeats ? 0u : before);
    return i < 0 ? 0u : inside;
}

/* Half precision. Denormals lie below 2^-14: their float has the mantissa behind a fixed exponent, less that. */
GRADUS_FN real texture_half(uint bits) {
    const uint size = bits & 0x7FFFu;
    const real normal = as_float((size << 13) + (112u << 23));
    const real small = as_float((size << 13) + (113u << 23)) - as_float(113u << 23);
    const real value = size < 0x400u ? small : normal;
    return (bits & 0x8000u) != 0u ? -value : value;
}

typedef struct {
    uint flags, offset;
    GRADUS_NOT_IN_REGISTERS
} texture_place;

/* Texel `number` of a picture, linear. */
GRADUS_FN rgb texture_fetch(GRADUS_GLOBAL const uint *texels, GRADUS_GLOBAL const real *texture_decode,
                            texture_place place, uint number) {
    const uint flags = place.flags;
    const int is_color =
        !TEXTURES_HAVE(textures_in_gray) || (TEXTURES_HAVE(textures_in_color) && (flags & texture_flag_color) != 0u);
    rgb value = rgb_gray(R(0));
    (void)texels, (void)texture_decode, (void)number;
    if (TEXTURES_HAVE(textures_of_bytes)) {
        const int is_this = texture_format(flags) == texture_format_byte;
        const uint word = texels[place.offset + (is_this ? (is_color ? number : number >> 2) : 0u)];
        const uint shift = is_color ? 0u : 8u * (number & 3u), step = is_color ? 8u : 0u;
        const uint curve = (flags & texture_flag_srgb) != 0u ? 256u : 0u;
        const real r = texture_decode[curve + ((word >> shift) & 255u)];
        real g = r, b = r;
        if (TEXTURES_HAVE(textures_in_color)) {
            g = texture_decode[texture_after(curve, r) + ((word >> (shift + step)) & 255u)];
            b = texture_decode[texture_after(curve, g) + ((word >> (shift + 2u * step)) & 255u)];
        }
        value = rgb_select(is_this, rgb3(r, g, b), value);
    }
    if (TEXTURES_HAVE(textures_of_words) || TEXTURES_HAVE(textures_of_halves)) {
        const int is_half = texture_format(flags) == texture_format_half;
        const int is_this = is_half | (texture_format(flags) == texture_format_word);
        const uint at = is_this ? (is_color ? 2u * number : number >> 1) : 0u;
        const uint first = texels[place.offset + at];
        const uint second = texels[place.offset + at + ((is_color & is_this) ? 1u : 0u)];
        const uint bits_r = (is_color ? first : first >> (16u * (number & 1u))) & 0xFFFFu;
        const uint bits_g = is_color ? first >> 16 : bits_r, bits_b = is_color ? second & 0xFFFFu : bits_r;
        const real scale = R(1) / R(65535);
        const real r = is_half ? texture_half(bits_r) : (real)(int)bits_r * scale;
        const uint after_r = texture_after(bits_g, r);
        const real g = is_half ? texture_half(after_r) : (real)(int)after_r * scale;
        const uint after_g = texture_after(bits_b, g);
        const real b = is_half ? texture_half(after_g) : (real)(int)after_g * scale;
        value = rgb_select(is_this, rgb3(r, g, b), value);
    }
    if (TEXTURES_HAVE(textures_of_reals)) {
        const int is_this = texture_format(flags) == texture_format_real;
        const uint at = place.offset + (is_this ? (is_color ? 3u * number : number) : 0u);
        const uint step = (is_this & is_color) ? 1u : 0u;
        const real r = as_float(texels[at]);
        const real g = as_float(texels[texture_after(at + step, r)]);
        const real b = as_float(texels[texture_after(at + 2u * step, g)]);
        value = rgb_select(is_this, rgb3(r, g, b), value);
    }
    return value;
}

/* One after the other (kernels/lib/ordered.h): a + share (b - a). */
GRADUS_FN rgb texture_between(rgb a, rgb b, real share) {
    const real r = a.r + share * (b.r - a.r);
    const real g = a.g + r_after(share, r) * (b.g - a.g);
    const real blue = a.b + r_after(share, g) * (b.b - a.b);
    return rgb3(r, g, blue);
}

/* Where a texture is looked up. What the scene's textures do not ask for costs nothing. */
typedef struct {
    real u, v;
    uint triangle;      /* of the scene; 0 on spheres */
    real second, third; /* barycentric weights of its second and third vertex */
    GRADUS_NOT_IN_REGISTERS
} texture_point;

#if TRAIT_TEXTURES & textures_of_meshes
/* A channel of it, whose number at the first corner is at `at`. The gathers come one after the other
 * (kernels/lib/ordered.h), after `before`. */
GRADUS_FN real texture_of_corners(GRADUS_GLOBAL const uint *texels, int is_this, uint at, uint corner,
                                  texture_point point, real before) {
    /* Words that are none of an attribute may be no number, which must not come into an index. */
    const uint first = texture_after(at, before);
    const real word_a = as_float(texels[first]);
    const real a = is_this ? word_a : R(0);
    const real word_b = as_float(texels[texture_after(first + corner, a)]);
    const real b = is_this ? word_b : R(0);
    const real word_c = as_float(texels[texture_after(first + 2u * corner, b)]);
    const real c = is_this ? word_c : R(0);
    const real rest = R(1) - point.second - point.third;
    return rest * a + r_after(point.second, c) * b + point.third * c;
}

/* A mesh attribute; of other textures any value. */
GRADUS_FN rgb texture_of_mesh(GRADUS_GLOBAL const uint *texels, uint flags, uint offset, uint first, uint count,
                              texture_point point) {
    const int is_this = (flags & texture_flag_attribute) != 0u, is_by_face = (flags & texture_flag_by_face) != 0u;
    const uint channels = (flags & texture_flag_color) != 0u ? 3u : 1u;
    const uint corner = (is_this & !is_by_face) ? channels : 0u, step = (is_this & (channels > 1u)) ? 1u : 0u;
    /* Who asks for what is not there, and then takes a constant, may be anywhere. */
    const uint triangle = r_min(point.triangle - first, count - 1u);
    const uint at = is_this ? offset + triangle * (is_by_face ? channels : 3u * channels) : 0u;
    const real r = texture_of_corners(texels, is_this, at, corner, point, R(0));
    const real g = texture_of_corners(texels, is_this, at + step, corner, point, r);
    const real b = texture_of_corners(texels, is_this, at + 2u * step, corner, point, g);
    return rgb3(r, g, b);
}
#endif

GRADUS_FN rgb texture_lookup(GRADUS_GLOBAL const uint *textures, GRADUS_GLOBAL const real *texture_reals,
                             GRADUS_GLOBAL const uint *texels, GRADUS_GLOBAL const real *texture_decode, uint unit,
                             uint texture, texture_point point) {
    const real u = point.u, v = point.v;
    texture_place place;
    place.flags = FIELD_OF(texture, textures, texture, flags);
    place.offset = FIELD_OF(texture, textures, texture, offset);
    uint width = FIELD_OF(texture, textures, texture, width);
    uint height = FIELD_OF(texture, textures, texture, height);
#if TRAIT_TEXTURES & textures_of_meshes
    const rgb of_mesh = texture_of_mesh(texels, place.flags, place.offset, width, height, point);
    const int is_of_mesh = (place.flags & texture_flag_attribute) != 0u;
    place.offset = is_of_mesh ? 0u : place.offset;
    width = is_of_mesh ? 1u : width;
    height = is_of_mesh ? 1u : height;
#endif
    real s = u, t = v;
#if TRAIT_TEXTURES & textures_mapped
    s = FIELD_OF(texture_real, texture_reals, texture, u_of_u) * u +
        FIELD_OF(texture_real, texture_reals, texture, u_of_v) * v +
        FIELD_OF(texture_real, texture_reals, texture, u_of_1);
    t = FIELD_OF(texture_real, texture_reals, texture, v_of_u) * u +
        FIELD_OF(texture_real, texture_reals, texture, v_of_v) * v +
        r_after(FIELD_OF(texture_real, texture_reals, texture, v_of_1), s);
#endif
    rgb value = rgb_gray(R(0));
#if TRAIT_TEXTURES & (textures_bilinear | textures_nearest)
    const int is_nearest =
        !TEXTURES_HAVE(textures_bilinear) || (TEXTURES_HAVE(textures_nearest) && (place.flags & texture_flag_nearest));
    const real x = texture_wrapped(s, place.flags) * (real)(int)width;
    const real y = texture_wrapped(r_after(t, x), place.flags) * (real)(int)height;
    const real to_left = is_nearest ? x : x - R(0.5), to_top = is_nearest ? y : y - R(0.5);
    const real left = r_floor(to_left), top = r_floor(to_top);
    /* Nearest: what is at the very edge belongs to the texel before it, which is what texture_texel() says of it. */
    const uint x_0 = texture_texel((int)left, width, place.flags);
    const uint y_0 = texture_texel((int)top, height, place.flags);
    value = texture_fetch(texels, texture_decode, place, y_0 * width + x_0);
#if TRAIT_TEXTURES & textures_bilinear
    const uint x_1 = is_nearest ? x_0 : texture_next_texel((int)left, x_0, width, place.flags);
    const uint y_1 = is_nearest ? y_0 : texture_next_texel((int)top, y_0, height, place.flags);
    const rgb right = texture_fetch(texels, texture_decode, place, texture_after(y_0 * width + x_1, value.b));
    const rgb below = texture_fetch(texels, texture_decode, place, texture_after(y_1 * width + x_0, right.b));
    const rgb opposite = texture_fetch(texels, texture_decode, place, texture_after(y_1 * width + x_1, below.b));
    const real x_share = is_nearest ? R(0) : to_left - left, y_share = is_nearest ? R(0) : to_top - top;
    const rgb upper = texture_between(value, right, x_share);
    const rgb lower = texture_between(below, opposite, r_after(x_share, upper.b));
    value = texture_between(upper, lower, r_after(y_share, lower.b));
#endif
#endif
#if TRAIT_TEXTURES & textures_checkerboards
    const real across = r_clamp(s - r_floor(s), R(0), R(1)), down = r_after(t, across);
    const int is_across = across > R(0.5), is_down = down - r_floor(down) > R(0.5);
    const rgb field = rgb_select(is_across == is_down, FIELD_RGB(texture_real, texture_reals, texture, color_0),
                                 FIELD_RGB(texture_real, texture_reals, texture, color_1));
    value = rgb_select((place.flags & texture_flag_checkerboard) != 0u, field, value);
#endif
#if TRAIT_TEXTURES & textures_of_meshes
    value = rgb_select(is_of_mesh, of_mesh, value);
#endif
#if TRAIT_TEXTURES & textures_scaled
    value = rgb_mul(value, FIELD_RGB(texture_real, texture_reals, texture, scale));
#endif
    const real lowest = FIELD_OF(texture_real, texture_reals, texture, lowest);
    const real highest = FIELD_OF(texture_real, texture_reals, texture, highest);
    const real r = r_clamp(value.r, lowest, highest);
    const real g = r_clamp(r_after(value.g, r), lowest, highest);
    const real b = r_clamp(r_after(value.b, g), lowest, highest);
    return rgb3(r, g, b);
}

GRADUS_LIB_END
#endif
#endif
