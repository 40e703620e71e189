/* How textures lie in device memory, for host and device.
 *
 * `texels` holds the words of all pictures as files store them (Bitmap in runtime/scene/texture.h), `textures` a record
 * of whole numbers for each texture, `texture_reals` one of reals. `material_lookups` has
 * TRAIT_LOOKUPS numbers for each material record: the textures that the material has, each once. `material_textures`
 * has textured_parameters numbers for each: which of these stands for the parameter, or texture_none.
 *
 * TRAIT_TEXTURED has a bit for each parameter of GRADUS_TEXTURED_PARAMETERS that some material has as a texture,
 * TRAIT_TEXTURES one for each of the features below that some such texture has, TRAIT_BLEND_TEXTURES those of weights
 * of blends, TRAIT_NORMAL_TEXTURES those of normal maps and bump maps; TRAIT_BLEND_LEVELS a bit for each depth of
 * nesting at which a weight is a texture, TRAIT_TEXTURED_NORMALS one for each of textured_normals_.... */
#ifndef GRADUS_SHARED_TEXTURE_H
#define GRADUS_SHARED_TEXTURE_H
//! traits: TRAIT_MATERIAL TRAIT_TEXTURED_LIGHTS
#include "kernels/shared/bsdf_list.h"
#include "kernels/shared/compat.h"

/* Whether there are textures at all; kernels/lib/texture_lookup.h is for those. */
#define HAS_TEXTURES (TRAIT_MATERIAL || TRAIT_TEXTURED_LIGHTS)

/* TRAIT_TEXTURED_LIGHTS: what lights have textures. A projector counts though its picture be one colour. */
#define textured_lights_of_surfaces 1
#define textured_lights_spots 2
#define textured_lights_projectors 4
#define textured_lights_pictures 6 /* spots or projectors */

#if TRAIT_MATERIAL || TRAIT_TEXTURED_LIGHTS || !defined(__OPENCL_VERSION__)

#define GRADUS_TEXTURE_FIELDS(FIELD)                                                                                   \
    FIELD(texture, flags, "bits of texture_flag_...")                                                                  \
    FIELD(texture, offset, "its first word of `texels`")                                                               \
    FIELD(texture, width, "in texels; 1 by 1 where it is no picture")                                                  \
    FIELD(texture, height, "")                                                                                         \
    FIELD(texture, first, "of a mesh attribute the first triangle, or shared vertex, of the scene that has it")        \
    FIELD(texture, count, "and how many follow, up to the last")

#define GRADUS_TEXTURE_REAL_FIELDS(FIELD)                                                                              \
    FIELD(texture_real, u_of_u, "the map of the surface's (u, v) to the texture's")                                    \
    FIELD(texture_real, u_of_v, "")                                                                                    \
    FIELD(texture_real, u_of_1, "")                                                                                    \
    FIELD(texture_real, v_of_u, "")                                                                                    \
    FIELD(texture_real, v_of_v, "")                                                                                    \
    FIELD(texture_real, v_of_1, "")                                                                                    \
    FIELD(texture_real, lowest, "the result is clamped to these")                                                      \
    FIELD(texture_real, highest, "")                                                                                   \
    FIELD(texture_real, scale_r, "factor on what is looked up")                                                        \
    FIELD(texture_real, scale_g, "")                                                                                   \
    FIELD(texture_real, scale_b, "")                                                                                   \
    FIELD(texture_real, color_0_r, "of a checkerboard")                                                                \
    FIELD(texture_real, color_0_g, "")                                                                                 \
    FIELD(texture_real, color_0_b, "")                                                                                 \
    FIELD(texture_real, color_1_r, "")                                                                                 \
    FIELD(texture_real, color_1_g, "")                                                                                 \
    FIELD(texture_real, color_1_b, "")

/* By light, and one for the black light behind them. */
#define GRADUS_LIGHT_TEXTURE_FIELDS(FIELD)                                                                             \
    FIELD(light_texture, texture, "what its value is times, or texture_absent")                                        \
    FIELD(light_texture, triangle, "of the scene, of a light that is one; else 0")                                     \
    FIELD(light_texture, sphere, "the same")
/* Also by light: what in a direction d adds to u and v of a picture, after division by the cosine to the light's axis
 * and before 1/2: unit vectors over the picture's width and height at distance 1. */
#define GRADUS_PICTURE_FIELDS(FIELD)                                                                                   \
    FIELD(picture, along_u_x, "")                                                                                      \
    FIELD(picture, along_u_y, "")                                                                                      \
    FIELD(picture, along_u_z, "")                                                                                      \
    FIELD(picture, along_v_x, "")                                                                                      \
    FIELD(picture, along_v_y, "")                                                                                      \
    FIELD(picture, along_v_z, "")

/* By material record: of which others it is a blend. The weight is in `blend_weights`, by record. */
#define GRADUS_BLEND_FIELDS(FIELD)                                                                                     \
    FIELD(blend, first, "record of the first; blend_none where this is no blend")                                      \
    FIELD(blend, second, "")                                                                                           \
    FIELD(blend, weight_texture, "or texture_absent")

/* By material record: where its normal comes from, bits of normal_map_... and the texture. What a bump map's texture is
 * times, in lengths, is in `bump_scales`, by record. */
#define GRADUS_NORMAL_MAP_FIELDS(FIELD)                                                                                \
    FIELD(normal_map, flags, "0 where no texture turns the normal")                                                    \
    FIELD(normal_map, texture, "")

/* (u, v) at the three vertices of a triangle, and the axes of a sphere. */
#define GRADUS_TRIANGLE_TEXCOORDS_FIELDS(FIELD)                                                                        \
    FIELD(texcoords, u_0, "")                                                                                          \
    FIELD(texcoords, v_0, "")                                                                                          \
    FIELD(texcoords, u_1, "")                                                                                          \
    FIELD(texcoords, v_1, "")                                                                                          \
    FIELD(texcoords, u_2, "")                                                                                          \
    FIELD(texcoords, v_2, "")
#define GRADUS_SPHERE_AXES_FIELDS(FIELD)                                                                               \
    FIELD(sphere_axes, first_x, "")                                                                                    \
    FIELD(sphere_axes, first_y, "")                                                                                    \
    FIELD(sphere_axes, first_z, "")                                                                                    \
    FIELD(sphere_axes, second_x, "")                                                                                   \
    FIELD(sphere_axes, second_y, "")                                                                                   \
    FIELD(sphere_axes, second_z, "")                                                                                   \
    FIELD(sphere_axes, third_x, "the poles")                                                                           \
    FIELD(sphere_axes, third_y, "")                                                                                    \
    FIELD(sphere_axes, third_z, "")

/* texture_flags: the lowest two bits are the format (Bitmap::Format), bits 4 and 5 how it wraps along u
 * (Texture::Wrap), 8 and 9 along v. */
#define texture_format(flags) ((flags)&3u)
#define texture_format_byte 0u
#define texture_format_word 1u
#define texture_format_half 2u
#define texture_format_real 3u
#define texture_flag_color 4u
#define texture_flag_nearest 8u
#define texture_wrap(flags) (((flags) >> 4) & 3u)
#define texture_flags_along_v(flags) ((flags) >> 4) /* for texture_wrap() */
#define texture_wrap_repeat 0u
#define texture_wrap_mirror 1u
#define texture_flag_checkerboard 64u
#define texture_flag_srgb 128u
#define texture_flag_attribute 1024u /* of a mesh: below */
#define texture_flag_by_face 2048u
#define texture_flag_by_vertex 4096u /* of vertices that triangles share, with TRAIT_INDEXED */

/* The lowest three go with a vertex (kernels/lib/mapped_normal.h). */
#define normal_map_there 1u   /* a texture turns the normal */
#define normal_map_turns 2u   /* it is turned over where it would be seen from behind */
#define normal_map_shadows 4u /* light that grazes is dimmed */
#define normal_map_of_vertex 7u
#define normal_map_is_bump 8u
#define normal_map_is_outside 16u   /* of what makes the material two-sided */
#define normal_map_on_two_sided 32u /* with a vertex alone: the other side is seen from behind */

/* Bits of TRAIT_TEXTURED_NORMALS. */
#define textured_normals_given 1
#define textured_normals_bump 2

#define texture_none 0xFFFFFFFFu
/* A bit beside the number of another texture of the same use: where there is none one is looked up all the same, since
 * all rows look up one, and what it is worth is not taken. Which one the asker may choose. */
#define texture_absent 0x80000000u
#define texture_is_absent(number) (((number)&texture_absent) != 0u)
#define texture_present(number) ((number) & ~texture_absent)
#define blend_none 0xFFFFFFFFu

/* Bits of TRAIT_TEXTURES. */
#define textures_of_bytes 1
#define textures_of_words 2
#define textures_of_halves 4
#define textures_of_reals 8
#define textures_in_color 16
#define textures_in_gray 32
#define textures_nearest 64
#define textures_bilinear 128
#define textures_wrapped_otherwise 256 /* than by repeating */
#define textures_mapped 512            /* by to_uv */
#define textures_scaled 1024
#define textures_checkerboards 2048
#define textures_turned 4096     /* to_uv mixes u and v */
#define textures_bounded 8192    /* what is looked up may be brought into bounds, or these are not 0 and 1 */
#define textures_of_srgb 16384   /* bytes that are sRGB: `texels` begins with what each of them stands for */
#define textures_of_meshes 32768 /* mesh attributes */
#define texture_srgb_words 256u
/* Above these bits how many textures there are, where these are few, else 0 (kernels/lib/texture_lookup.h). */
#define textures_with_count(features, count) ((features) | (count) << 24)
#define textures_counted(features) ((uint)(features) >> 24)

/* A mesh attribute is three records of one or three reals for each triangle, or one by face, or one for each vertex
 * that triangles share, in `texels` too. */

GRADUS_LIB_BEGIN

#define GRADUS_TEXTURE_INDEX(record, field, text) record##_##field,
enum texture_field { GRADUS_TEXTURE_FIELDS(GRADUS_TEXTURE_INDEX) texture_stride };
enum texture_real_field { GRADUS_TEXTURE_REAL_FIELDS(GRADUS_TEXTURE_INDEX) texture_real_stride };
enum light_texture_field { GRADUS_LIGHT_TEXTURE_FIELDS(GRADUS_TEXTURE_INDEX) light_texture_stride };
enum picture_field { GRADUS_PICTURE_FIELDS(GRADUS_TEXTURE_INDEX) picture_stride };
enum blend_field { GRADUS_BLEND_FIELDS(GRADUS_TEXTURE_INDEX) blend_stride };
enum normal_map_field { GRADUS_NORMAL_MAP_FIELDS(GRADUS_TEXTURE_INDEX) normal_map_stride };
enum texcoords_field { GRADUS_TRIANGLE_TEXCOORDS_FIELDS(GRADUS_TEXTURE_INDEX) texcoords_stride };
enum sphere_axes_field { GRADUS_SPHERE_AXES_FIELDS(GRADUS_TEXTURE_INDEX) sphere_axes_stride };
#undef GRADUS_TEXTURE_INDEX

/* The parameters of materials, numbered. */
#define GRADUS_PARAMETER_INDEX(with, name, value, text) parameter_##name,
enum material_parameter {
    GRADUS_TEXTURED_PARAMETERS(GRADUS_PARAMETER_INDEX, GRADUS_PARAMETER_INDEX, ) textured_parameters
};
#undef GRADUS_PARAMETER_INDEX
/* Whether a mask, as TRAIT_TEXTURED is one, has a parameter. */
#define HAS_PARAMETER(mask, name) ((((mask) >> parameter_##name) & 1) != 0)

GRADUS_LIB_END

#endif
#endif
