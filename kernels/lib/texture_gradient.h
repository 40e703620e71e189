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
GRADUS_FN real texture_sense(int features, real s, uint flags) {
    const real twice = s - R(2) * r_floor(R(0.5) * s);
    const int is_mirrored = TEXTURES_HAVE(textures_wrapped_otherwise) && texture_wrap(flags) == texture_wrap_mirror;
    return is_mirrored && twice > R(1) ? R(-1) : R(1);
}

/* A texel's luminance, of which texture_lookup() would give the colour: scaled, not clamped. Computed after `before`
 * (kernels/lib/ordered.h). */
GRADUS_FN real texture_luminance(int features, GRADUS_GLOBAL const uint *texels, texture_place place, rgb scale,
                                 uint number, real before) {
    return rgb_luminance(rgb_mul(texture_fetch(features, texels, place, number, before), scale));
}

/* `features` as in texture_lookup(). */
GRADUS_FN texture_slope texture_gradient(int features, uint first, GRADUS_GLOBAL const uint *textures,
                                         GRADUS_GLOBAL const real *texture_reals, GRADUS_GLOBAL const uint *texels,
                                         uint unit, uint texture, real u, real v) {
    texture_slope slope;
    slope.u = R(0);
    slope.v = R(0);
    if (TEXTURES_HAVE(textures_bilinear)) {
        texture_place place;
        place.flags = TEXTURE_NUMBER(flags);
        place.offset = TEXTURE_NUMBER(offset);
        const uint width = TEXTURE_NUMBER(width), height = TEXTURE_NUMBER(height);
        const int is_mapped = TEXTURES_HAVE(textures_mapped), is_turned = TEXTURES_HAVE(textures_turned);
        const real u_of_u = is_mapped ? TEXTURE_REAL(u_of_u) : R(1), v_of_v = is_mapped ? TEXTURE_REAL(v_of_v) : R(1);
        const real u_of_v = is_turned ? TEXTURE_REAL(u_of_v) : R(0), v_of_u = is_turned ? TEXTURE_REAL(v_of_u) : R(0);
        const real u_of_1 = is_mapped ? TEXTURE_REAL(u_of_1) : R(0), v_of_1 = is_mapped ? TEXTURE_REAL(v_of_1) : R(0);
        const rgb scale = TEXTURES_HAVE(textures_scaled) ? TEXTURE_RGB(scale) : rgb_gray(R(1));
        const real s = u_of_u * u + u_of_v * v + u_of_1;
        const real t = v_of_u * u + v_of_v * v + r_after(v_of_1, s);
        const uint flags_down = texture_flags_along_v(place.flags);
        const real to_left = texture_wrapped(features, s, place.flags) * (real)(int)width - R(0.5);
        const real to_top = texture_wrapped(features, r_after(t, to_left), flags_down) * (real)(int)height - R(0.5);
        const real left = r_floor(to_left), top = r_floor(to_top);
        const uint x_0 = texture_texel(features, (int)left, width, place.flags);
        const uint y_0 = texture_texel(features, (int)top, height, flags_down);
        const uint x_1 = texture_next_texel(features, (int)left, x_0, width, place.flags);
        const uint y_1 = texture_next_texel(features, (int)top, y_0, height, flags_down);
        const real here = texture_luminance(features, texels, place, scale, y_0 * width + x_0, R(0));
        const real right = texture_luminance(features, texels, place, scale, y_0 * width + x_1, here);
        const real below = texture_luminance(features, texels, place, scale, y_1 * width + x_0, right);
        const real opposite = texture_luminance(features, texels, place, scale, y_1 * width + x_1, below);
        const real x_share = to_left - left, y_share = to_top - top;
        const int is_flat = (place.flags & (texture_flag_nearest | texture_flag_checkerboard)) != 0u;
        const real across = (right - here) + y_share * ((opposite - below) - (right - here));
        const real down = (below - here) + x_share * ((opposite - right) - (below - here));
        const real by_s = is_flat ? R(0) : across * texture_sense(features, s, place.flags) * (real)(int)width;
        const real by_t =
            is_flat ? R(0) : down * texture_sense(features, r_after(t, by_s), flags_down) * (real)(int)height;
        slope.u = by_s * u_of_u + by_t * v_of_u;
        slope.v = by_s * u_of_v + by_t * v_of_v;
    }
    return slope;
}

GRADUS_LIB_END
#endif
