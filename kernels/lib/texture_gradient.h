/* How the value of a texture changes with (u, v): within a texel, of a bilinear picture, as that is interpolated there;
 * everything else is flat. */
#ifndef GRADUS_LIB_TEXTURE_GRADIENT_H
#define GRADUS_LIB_TEXTURE_GRADIENT_H
#include "kernels/lib/texture_lookup.h"

GRADUS_LIB_BEGIN

typedef struct {
    real u, v; /* d/du and d/dv of the luminance */
    GRADUS_NOT_IN_REGISTERS
} texture_slope;

/* 1, or -1 where mirroring turns a coordinate over. */
GRADUS_FN real texture_sense(real s, uint flags) {
    const real twice = s - R(2) * r_floor(R(0.5) * s);
    const int is_mirrored = TEXTURES_HAVE(textures_wrapped_otherwise) && texture_wrap(flags) == texture_wrap_mirror;
    return is_mirrored && twice > R(1) ? R(-1) : R(1);
}

/* A texel's luminance, of which texture_lookup() would give the colour: scaled, not clamped. */
GRADUS_FN real texture_luminance(GRADUS_GLOBAL const uint *texels, GRADUS_GLOBAL const real *texture_decode,
                                 texture_place place, rgb scale, uint number) {
    return rgb_luminance(rgb_mul(texture_fetch(texels, texture_decode, place, number), scale));
}

GRADUS_FN texture_slope texture_gradient(GRADUS_GLOBAL const uint *textures, GRADUS_GLOBAL const real *texture_reals,
                                         GRADUS_GLOBAL const uint *texels, GRADUS_GLOBAL const real *texture_decode,
                                         uint unit, uint texture, real u, real v) {
    texture_slope slope;
    slope.u = R(0);
    slope.v = R(0);
    (void)textures, (void)texture_reals, (void)texels, (void)texture_decode, (void)unit, (void)texture, (void)u,
        (void)v;
#if TRAIT_TEXTURES & textures_bilinear
    texture_place place;
    place.flags = FIELD_OF(texture, textures, texture, flags);
    place.offset = FIELD_OF(texture, textures, texture, offset);
    const uint width = FIELD_OF(texture, textures, texture, width);
    const uint height = FIELD_OF(texture, textures, texture, height);
    const real u_of_u = FIELD_OF(texture_real, texture_reals, texture, u_of_u);
    const real u_of_v = FIELD_OF(texture_real, texture_reals, texture, u_of_v);
    const real v_of_u = FIELD_OF(texture_real, texture_reals, texture, v_of_u);
    const real v_of_v = FIELD_OF(texture_real, texture_reals, texture, v_of_v);
    const rgb scale = FIELD_RGB(texture_real, texture_reals, texture, scale);
    const real s = u_of_u * u + u_of_v * v + FIELD_OF(texture_real, texture_reals, texture, u_of_1);
    const real t = v_of_u * u + v_of_v * v + r_after(FIELD_OF(texture_real, texture_reals, texture, v_of_1), s);
    const uint flags_down = texture_flags_along_v(place.flags);
    const real to_left = texture_wrapped(s, place.flags) * (real)(int)width - R(0.5);
    const real to_top = texture_wrapped(r_after(t, to_left), flags_down) * (real)(int)height - R(0.5);
    const real left = r_floor(to_left), top = r_floor(to_top);
    const uint x_0 = texture_texel((int)left, width, place.flags);
    const uint y_0 = texture_texel((int)top, height, flags_down);
    const uint x_1 = texture_next_texel((int)left, x_0, width, place.flags);
    const uint y_1 = texture_next_texel((int)top, y_0, height, flags_down);
    const real here = texture_luminance(texels, texture_decode, place, scale, y_0 * width + x_0);
    const real right = texture_luminance(texels, texture_decode, place, scale, texture_after(y_0 * width + x_1, here));
    const real below = texture_luminance(texels, texture_decode, place, scale, texture_after(y_1 * width + x_0, right));
    const real opposite =
        texture_luminance(texels, texture_decode, place, scale, texture_after(y_1 * width + x_1, below));
    const real x_share = to_left - left, y_share = to_top - top;
    const int is_flat = (place.flags & (texture_flag_nearest | texture_flag_checkerboard)) != 0u;
    const real across = (right - here) + y_share * ((opposite - below) - (right - here));
    const real down = (below - here) + x_share * ((opposite - right) - (below - here));
    const real by_s = is_flat ? R(0) : across * texture_sense(s, place.flags) * (real)(int)width;
    const real by_t = is_flat ? R(0) : down * texture_sense(r_after(t, by_s), flags_down) * (real)(int)height;
    slope.u = by_s * u_of_u + by_t * v_of_u;
    slope.v = by_s * u_of_v + by_t * v_of_v;
#endif
    return slope;
}

GRADUS_LIB_END
#endif
