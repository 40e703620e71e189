/* shade, as in shade.cl, of the surfaces of one class of materials (runtime/scene/material_class.h), whose textures it
 * reads itself: no stage `material` has been there. READS_NO_SURFACE is 1, and the class has neither blends nor maps.
 * The paths have no offset paths. */
//! traits: TRAIT_SPHERES TRAIT_TEXTURES TRAIT_TEXTURED_LIGHTS
#include "kernels/lib/hit_uv.h"
#include "kernels/lib/material_lookup.h"

#if TRAIT_SPHERES
#define SPHERE_PARAMETER , __global const real *sphere_axes
#define PLACE_ON_SPHERE(primitive, hit) hit_sphere_place(sphere_axes, spheres, unit, SPHERE_OF(primitive), hit)
#else
#define SPHERE_PARAMETER
#define PLACE_ON_SPHERE(primitive, hit) v3(R(0), R(0), R(1))
#endif
#if TRAIT_TEXTURED_LIGHTS
#define TEXTURE_BUFFERS /* LIGHT_TEXTURE_PARAMETERS has them */
#else
#define TEXTURE_BUFFERS                                                                                                \
    , __global const real *triangle_texcoords SPHERE_PARAMETER, __global const uint *textures,                         \
        __global const real *texture_reals, __global const uint *texels
#endif
#define MATERIAL_PARAMETERS                                                                                            \
    TEXTURE_BUFFERS, uint parameter_texture, __global const uint *material_textures,                                   \
        __global const uint *material_lookups
#define BITS_OF_MATERIAL texture_bits(TRAIT_TEXTURES, parameter_texture, textures, texture_reals, unit)
#define MATERIAL_AT(point, primitive, hit)                                                                             \
    material_looked_up(materials, (point).material,                                                                    \
                       hit_texture_point(triangle_texcoords, unit, triangle_count, primitive, hit,                     \
                                         PLACE_ON_SPHERE(primitive, hit)) LOOKUP_ARGUMENTS)

#include "kernels/stages/shade_vertex.h"
