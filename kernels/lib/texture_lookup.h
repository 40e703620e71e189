/* The value of a texture at a point of a surface; texture_value() of runtime/scene/texture.h is the same in double.
 *
 * `features` are those that the textures asked for have (kernels/shared/texture.h), a compile-time constant wherever it
 * is passed, and `first` is the first of them where they are few. All of them are computed for each row and one taken;
 * but a texel is the same one to three words to all formats, so that these differ in arithmetic alone. */
#ifndef GRADUS_LIB_TEXTURE_LOOKUP_H
#define GRADUS_LIB_TEXTURE_LOOKUP_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"
#include "kernels/shared/texture.h"

#if HAS_TEXTURES || !defined(__OPENCL_VERSION__)
GRADUS_LIB_BEGIN

#ifdef __OPENCL_VERSION__
#define TEXTURES_UNROLLED _Pragma("unroll")
#else
#define TEXTURES_UNROLLED
#endif

#define TEXTURES_HAVE(feature) ((features & (feature)) != 0)

/* Where a coordinate lies in [0, 1]; 0 for what is no finite number. */
GRADUS_FN real texture_wrapped(int features, real s, uint flags) {
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
GRADUS_FN uint texture_texel(int features, int i, uint size, uint flags) {
    const int repeats = !TEXTURES_HAVE(textures_wrapped_otherwise) || texture_wrap(flags) == texture_wrap_repeat;
    const uint inside = r_min((uint)i, size - 1u);
    return i < 0 ? (repeats ? size - 1u : 0u) : inside;
}

/* The one after that, texel `before`. */
GRADUS_FN uint texture_next_texel(int features, int i, uint before, uint size, uint flags) {
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

/* What 8 or 16 bits, or a float's, stand for, linear. Computed after `before` (kernels/lib/ordered.h). */
GRADUS_FN real texture_value_of(int features, GRADUS_GLOBAL const uint *texels, uint bits, uint flags, real before) {
    const uint code = uint_after(bits, before);
    const uint format = texture_format(flags);
    real value = R(0);
    if (TEXTURES_HAVE(textures_of_bytes | textures_of_words)) {
        const int are_words =
            !TEXTURES_HAVE(textures_of_bytes) || (TEXTURES_HAVE(textures_of_words) && format == texture_format_word);
        value = (real)(int)(code & 0xFFFFu) * (are_words ? R(1) / R(65535) : R(1) / R(255));
    }
    if (TEXTURES_HAVE(textures_of_srgb)) {
        const real linear = as_float(texels[(int)(code & 0xFFu)]); /* texture_srgb_words of them lie there */
        value = (flags & texture_flag_srgb) != 0u ? linear : value;
    }
    if (TEXTURES_HAVE(textures_of_halves)) {
        const real half_precise = texture_half(code & 0xFFFFu);
        value = format == texture_format_half ? half_precise : value;
    }
    if (TEXTURES_HAVE(textures_of_reals)) {
        const real whole = as_float(code);
        value = format == texture_format_real ? whole : value;
    }
    return value;
}

typedef struct {
    uint flags, offset;
    GRADUS_NOT_IN_REGISTERS
} texture_place;

/* Texel `number` of a picture, linear, computed after `before`. */
GRADUS_FN rgb texture_fetch(int features, GRADUS_GLOBAL const uint *texels, texture_place place, uint number,
                            real before) {
    const uint flags = place.flags, format = texture_format(flags);
    const int is_color =
        !TEXTURES_HAVE(textures_in_gray) || (TEXTURES_HAVE(textures_in_color) && (flags & texture_flag_color) != 0u);
    const int has_bytes = TEXTURES_HAVE(textures_of_bytes), has_reals = TEXTURES_HAVE(textures_of_reals);
    const int has_pairs = TEXTURES_HAVE(textures_of_words | textures_of_halves);
    const int of_bytes = has_bytes & (format == texture_format_byte);
    const int of_reals = has_reals & (format == texture_format_real);
    const int of_pairs = has_pairs & !of_bytes & !of_reals;
    /* How many words a texel of colour has, and how many texels of gray, as a power of two, a word. */
    const uint words = of_bytes ? 1u : of_pairs ? 2u : 3u, shared = of_bytes ? 2u : of_pairs ? 1u : 0u;
    const uint at = place.offset + (is_color ? number * words : number >> shared);
    const uint first = texels[(int)uint_after(at, before)];
    const int has_more = TEXTURES_HAVE(textures_in_color) & (has_pairs | has_reals);
    const uint second = has_more ? texels[at + ((is_color & !of_bytes) ? 1u : 0u)] : first;
    const uint third = has_more & has_reals ? texels[at + ((is_color & of_reals) ? 2u : 0u)] : second;
    /* Of gray the texel's place in its word. */
    const uint shift = is_color ? 0u : of_bytes ? 8u * (number & 3u) : of_pairs ? 16u * (number & 1u) : 0u;
    const uint mask = of_bytes ? 0xFFu : of_pairs ? 0xFFFFu : 0xFFFFFFFFu;
    const real r = texture_value_of(features, texels, (first >> shift) & mask, flags, R(0));
    if (!TEXTURES_HAVE(textures_in_color))
        return rgb_gray(r);
    const uint code_g = of_bytes ? first >> 8 : of_pairs ? first >> 16 : second;
    const uint code_b = of_bytes ? first >> 16 : of_pairs ? second : third;
    const real g = texture_value_of(features, texels, code_g & mask, flags, r);
    const real b = texture_value_of(features, texels, code_b & mask, flags, g);
    return rgb3(r, is_color ? g : r, is_color ? b : r);
}

/* One after the other (kernels/lib/ordered.h): a + share (b - a). */
GRADUS_FN rgb texture_between(int features, rgb a, rgb b, real share) {
    const real r = a.r + share * (b.r - a.r);
    if (!TEXTURES_HAVE(textures_in_color))
        return rgb_gray(r);
    const real g = a.g + r_after(share, r) * (b.g - a.g);
    const real blue = a.b + r_after(share, g) * (b.b - a.b);
    return rgb3(r, g, blue);
}

/* The texture of that number, or the asker's first where it says that there is none. */
GRADUS_FN uint texture_or_first(uint number, uint first) { return texture_is_absent(number) ? first : number; }

/* A field of a texture's record. Where these are few, those from `first` on, all are loaded once for all work-items and
 * chosen from, in a sum of which all terms but one are 0; a single one needs no choice. */
GRADUS_FN uint texture_number_of(int features, uint first, GRADUS_GLOBAL const uint *textures, uint texture,
                                 size_t field) {
    if (textures_counted(features) == 0u)
        return (textures + field)[(int)(texture * (uint)texture_stride)];
    if (textures_counted(features) == 1u)
        return textures[(size_t)first * texture_stride + field];
    uint number = 0u;
    TEXTURES_UNROLLED
    for (uint n = 0; n < textures_counted(features); ++n)
        number |= (0u - (uint)(texture == first + n)) & textures[(size_t)(first + n) * texture_stride + field];
    return number;
}
GRADUS_FN real texture_real_of(int features, uint first, GRADUS_GLOBAL const real *texture_reals, uint texture,
                               size_t field) {
    if (textures_counted(features) == 0u)
        return (texture_reals + field)[(int)(texture * (uint)texture_real_stride)];
    if (textures_counted(features) == 1u)
        return texture_reals[(size_t)first * texture_real_stride + field];
    real number = R(0);
    TEXTURES_UNROLLED
    for (uint n = 0; n < textures_counted(features); ++n)
        number +=
            (texture == first + n ? R(1) : R(0)) * texture_reals[(size_t)(first + n) * texture_real_stride + field];
    return number;
}
/* Something made of all fields of few textures that are read, for HAS_ROW (kernels/shared/stage.h). */
GRADUS_FN uint texture_bits(int features, uint first, GRADUS_GLOBAL const uint *textures,
                            GRADUS_GLOBAL const real *texture_reals, uint unit) {
    uint bits = 0u;
    TEXTURES_UNROLLED
    for (uint n = 0; n < textures_counted(features); ++n) {
#define NUMBER_BITS(field) bits |= textures[(size_t)(first + n) * texture_stride + texture_##field * (size_t)unit];
#define REAL_BITS(field)                                                                                               \
    bits |= as_uint(                                                                                                   \
        (float)texture_reals[(size_t)(first + n) * texture_real_stride + texture_real_##field * (size_t)unit]);
#define RGB_BITS(field) REAL_BITS(field##_r) REAL_BITS(field##_g) REAL_BITS(field##_b)
        NUMBER_BITS(flags)
        NUMBER_BITS(offset)
        if (TEXTURES_HAVE(textures_mapped)) {
            REAL_BITS(u_of_u)
            REAL_BITS(u_of_1)
            REAL_BITS(v_of_v)
            REAL_BITS(v_of_1)
        }
        if (TEXTURES_HAVE(textures_turned)) {
            REAL_BITS(u_of_v)
            REAL_BITS(v_of_u)
        }
        if (TEXTURES_HAVE(textures_bilinear | textures_nearest)) {
            NUMBER_BITS(width)
            NUMBER_BITS(height)
        }
        if (TEXTURES_HAVE(textures_of_meshes)) {
            NUMBER_BITS(first)
            NUMBER_BITS(count)
        }
        if (TEXTURES_HAVE(textures_checkerboards)) {
            RGB_BITS(color_0)
            RGB_BITS(color_1)
        }
        if (TEXTURES_HAVE(textures_scaled)) {
            RGB_BITS(scale)
        }
        if (TEXTURES_HAVE(textures_bounded)) {
            REAL_BITS(lowest)
            REAL_BITS(highest)
        }
#undef NUMBER_BITS
#undef REAL_BITS
#undef RGB_BITS
    }
    return bits;
}
#define TEXTURE_NUMBER(field) texture_number_of(features, first, textures, texture, texture_##field *(size_t)unit)
#define TEXTURE_REAL(field) texture_real_of(features, first, texture_reals, texture, texture_real_##field *(size_t)unit)
#define TEXTURE_RGB(field) rgb3(TEXTURE_REAL(field##_r), TEXTURE_REAL(field##_g), TEXTURE_REAL(field##_b))

/* Where a texture is looked up. What `features` do not ask for costs nothing. */
typedef struct {
    real u, v;
    uint triangle;      /* of the scene; 0 on spheres */
    real second, third; /* barycentric weights of its second and third vertex */
#if TRAIT_INDEXED || !defined(__OPENCL_VERSION__)
    uint corner_0, corner_1, corner_2; /* its vertices, of scenes that have them by index */
#endif
    GRADUS_NOT_IN_REGISTERS
} texture_point;

typedef struct {
    uint corner_0, corner_1, corner_2;
    GRADUS_NOT_IN_REGISTERS
} texture_corners;

/* A channel of a mesh attribute, whose numbers at the corners are there. The gathers come one after the other
 * (kernels/lib/ordered.h), after `before`. */
GRADUS_FN real texture_of_corners(GRADUS_GLOBAL const uint *texels, int is_this, texture_corners at, uint channel,
                                  texture_point point, real before) {
    /* Words that are none of an attribute may be no number, which must not come into an index. */
    const real word_a = as_float(texels[uint_after(at.corner_0 + channel, before)]);
    const real a = is_this ? word_a : R(0);
    const real word_b = as_float(texels[uint_after(at.corner_1 + channel, a)]);
    const real b = is_this ? word_b : R(0);
    const real word_c = as_float(texels[uint_after(at.corner_2 + channel, b)]);
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
    texture_corners at;
    at.corner_0 = is_this ? offset + triangle * (is_by_face ? channels : 3u * channels) : 0u;
    at.corner_1 = at.corner_0 + corner;
    at.corner_2 = at.corner_1 + corner;
#if TRAIT_INDEXED || !defined(__OPENCL_VERSION__)
    const int is_by_vertex = is_this & ((flags & texture_flag_by_vertex) != 0u);
    const uint vertex_0 = offset + channels * r_min(point.corner_0 - first, count - 1u);
    const uint vertex_1 = offset + channels * r_min(point.corner_1 - first, count - 1u);
    const uint vertex_2 = offset + channels * r_min(point.corner_2 - first, count - 1u);
    at.corner_0 = is_by_vertex ? vertex_0 : at.corner_0;
    at.corner_1 = is_by_vertex ? vertex_1 : at.corner_1;
    at.corner_2 = is_by_vertex ? vertex_2 : at.corner_2;
#endif
    const real r = texture_of_corners(texels, is_this, at, 0u, point, R(0));
    const real g = texture_of_corners(texels, is_this, at, step, point, r);
    const real b = texture_of_corners(texels, is_this, at, 2u * step, point, g);
    return rgb3(r, g, b);
}

GRADUS_FN rgb texture_lookup(int features, uint first, GRADUS_GLOBAL const uint *textures,
                             GRADUS_GLOBAL const real *texture_reals, GRADUS_GLOBAL const uint *texels, uint unit,
                             uint texture, texture_point point) {
    const real u = point.u, v = point.v;
    texture_place place;
    place.flags = TEXTURE_NUMBER(flags);
    place.offset = TEXTURE_NUMBER(offset);
    real s = u, t = v;
    if (TEXTURES_HAVE(textures_mapped)) {
        const real along_u = TEXTURE_REAL(u_of_u) * u, along_v = TEXTURE_REAL(v_of_v) * r_after(v, along_u);
        const int is_turned = TEXTURES_HAVE(textures_turned);
        s = (is_turned ? along_u + TEXTURE_REAL(u_of_v) * v : along_u) + TEXTURE_REAL(u_of_1);
        t = (is_turned ? TEXTURE_REAL(v_of_u) * r_after(u, s) + along_v : along_v) + TEXTURE_REAL(v_of_1);
    }
    rgb value = rgb_gray(R(0));
    if (TEXTURES_HAVE(textures_bilinear | textures_nearest)) {
        const uint width = TEXTURE_NUMBER(width), height = TEXTURE_NUMBER(height);
        const int is_nearest = !TEXTURES_HAVE(textures_bilinear) ||
                               (TEXTURES_HAVE(textures_nearest) && (place.flags & texture_flag_nearest) != 0u);
        const real x = texture_wrapped(features, s, place.flags) * (real)(int)width;
        const uint flags_down = texture_flags_along_v(place.flags);
        const real y = texture_wrapped(features, r_after(t, x), flags_down) * (real)(int)height;
        const real to_left = is_nearest ? x : x - R(0.5), to_top = is_nearest ? y : y - R(0.5);
        const real left = r_floor(to_left), top = r_floor(to_top);
        /* Nearest: what is at the very edge belongs to the texel before it, which is what texture_texel() says. */
        const uint x_0 = texture_texel(features, (int)left, width, place.flags);
        const uint y_0 = texture_texel(features, (int)top, height, flags_down);
        value = texture_fetch(features, texels, place, y_0 * width + x_0, R(0));
        if (TEXTURES_HAVE(textures_bilinear)) {
            const uint next_x = texture_next_texel(features, (int)left, x_0, width, place.flags);
            const uint next_y = texture_next_texel(features, (int)top, y_0, height, flags_down);
            const uint x_1 = is_nearest ? x_0 : next_x, y_1 = is_nearest ? y_0 : next_y;
            const rgb right = texture_fetch(features, texels, place, y_0 * width + x_1, value.b);
            const rgb below = texture_fetch(features, texels, place, y_1 * width + x_0, right.b);
            const rgb opposite = texture_fetch(features, texels, place, y_1 * width + x_1, below.b);
            const real x_share = is_nearest ? R(0) : to_left - left, y_share = is_nearest ? R(0) : to_top - top;
            const rgb upper = texture_between(features, value, right, x_share);
            const rgb lower = texture_between(features, below, opposite, r_after(x_share, upper.b));
            value = texture_between(features, upper, lower, r_after(y_share, lower.b));
        }
    }
    if (TEXTURES_HAVE(textures_checkerboards)) {
        const real across = r_clamp(s - r_floor(s), R(0), R(1)), down = r_after(t, across);
        const int is_across = across > R(0.5), is_down = down - r_floor(down) > R(0.5);
        const rgb field = rgb_select(is_across == is_down, TEXTURE_RGB(color_0), TEXTURE_RGB(color_1));
        value = rgb_select((place.flags & texture_flag_checkerboard) != 0u, field, value);
    }
    if (TEXTURES_HAVE(textures_of_meshes)) {
        const rgb of_mesh =
            texture_of_mesh(texels, place.flags, place.offset, TEXTURE_NUMBER(first), TEXTURE_NUMBER(count), point);
        value = rgb_select((place.flags & texture_flag_attribute) != 0u, of_mesh, value);
    }
    if (TEXTURES_HAVE(textures_scaled))
        value = rgb_mul(value, TEXTURE_RGB(scale));
    const real lowest = TEXTURES_HAVE(textures_bounded) ? TEXTURE_REAL(lowest) : R(0);
    const real highest = TEXTURES_HAVE(textures_bounded) ? TEXTURE_REAL(highest) : R(1);
    const real r = r_clamp(value.r, lowest, highest);
    if (!TEXTURES_HAVE(textures_in_color | textures_checkerboards | textures_scaled))
        return rgb_gray(r);
    const real g = r_clamp(r_after(value.g, r), lowest, highest);
    const real b = r_clamp(r_after(value.b, g), lowest, highest);
    return rgb3(r, g, b);
}

GRADUS_LIB_END
#endif
#endif
