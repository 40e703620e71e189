/* What the shifts of photons ask of the vertices of light paths (kernels/stages/photon_*.cl): records in no order of
 * their own, each of which knows the one before. They are accessed at random, so these are records and not columns. */
#ifndef GRADUS_SHARED_LIGHT_VERTEX_H
#define GRADUS_SHARED_LIGHT_VERTEX_H
//! traits: TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC TRAIT_TEXTURED TRAIT_TEXTURED_NORMALS
//! traits: TRAIT_MIXED_LOBES
#include "kernels/shared/scene_records.h"

#define GRADUS_LIGHT_VERTEX_FIELDS(FIELD)                                                                              \
    FIELD(light_vertex, position_x, "")                                                                                \
    FIELD(light_vertex, position_y, "")                                                                                \
    FIELD(light_vertex, position_z, "")                                                                                \
    FIELD(light_vertex, geometric_x,                                                                                   \
          "geometric normal, unit, on the side that the material calls front; of a light at infinity its direction")   \
    FIELD(light_vertex, geometric_y, "")                                                                               \
    FIELD(light_vertex, geometric_z, "")                                                                               \
    FIELD(light_vertex, wi_x, "unit vector to the vertex before, world frame")                                         \
    FIELD(light_vertex, wi_y, "")                                                                                      \
    FIELD(light_vertex, wi_z, "")                                                                                      \
    FIELD(light_vertex, power_r, "flux that arrives, as a photon's; of a beam light_emission.value")                   \
    FIELD(light_vertex, power_g, "")                                                                                   \
    FIELD(light_vertex, power_b, "")                                                                                   \
    FIELD(light_vertex, offset, "how far a new ray starts off the surface; of a light chain_start_at_infinity or 0")   \
    FIELD(light_vertex, pdf,                                                                                           \
          "of the direction in which the path goes on, by solid angle; a specular one's probability; 1 at infinity")   \
    FIELD(light_vertex, survival, "probability with which Russian roulette let it")                                    \
    FIELD(light_vertex, shading_x, "only with TRAIT_SHADING_NORMALS or TRAIT_ANISOTROPIC: on the side of geometric")   \
    FIELD(light_vertex, shading_y, "")                                                                                 \
    FIELD(light_vertex, shading_z, "")                                                                                 \
    FIELD(light_vertex, along_x, "only with TRAIT_ANISOTROPIC: dp/du, any length")                                     \
    FIELD(light_vertex, along_y, "")                                                                                   \
    FIELD(light_vertex, along_z, "")

/* The whole numbers of these records, in a table of their own. */
#define GRADUS_LIGHT_VERTEX_MARKS(FIELD)                                                                               \
    FIELD(light_vertex_mark, material, "record of the material on this side, or light_vertex_on_surface...")           \
    FIELD(light_vertex_mark, primitive, "of a light its number")                                                       \
    FIELD(light_vertex_mark, before, "the record of the vertex before; light_vertex_none for the light itself")        \
    FIELD(light_vertex_mark, mirrors, "only with TRAIT_MIXED_LOBES: whether the path goes on so")

GRADUS_LIB_BEGIN

#define GRADUS_RECORD_INDEX(record, field, text) record##_##field,
enum light_vertex_field { GRADUS_LIGHT_VERTEX_FIELDS(GRADUS_RECORD_INDEX) light_vertex_stride };
enum light_vertex_mark_field { GRADUS_LIGHT_VERTEX_MARKS(GRADUS_RECORD_INDEX) light_vertex_mark_stride };
#undef GRADUS_RECORD_INDEX

/* Where the last fields are not needed, a record is a cache line; the host makes room for all. */
#if defined(__OPENCL_VERSION__) && !TRAIT_SHADING_NORMALS && !TRAIT_ANISOTROPIC
#define light_vertex_stride 16
#endif

#define light_vertex_none 0xFFFFFFFFu

/* Materials of vertices on lights, which have no record: light that leaves a surface, a point, comes from infinity,
 * or a point whose beam is of another power in each direction (kernels/lib/light_beam.h). */
#define light_vertex_on_surface 0xFFFFFFFEu
#define light_vertex_at_point 0xFFFFFFFDu
#define light_vertex_at_infinity 0xFFFFFFFCu
#define light_vertex_of_beam 0xFFFFFFFBu
#define light_vertex_is_light(material) ((material) >= light_vertex_of_beam)

/* Whether a path goes on by the mirror of a material that scatters as well: no walk moves such a vertex, and the value
 * of its BSDF says nothing of the mirror. */
#if TRAIT_MIXED_LOBES
#define LIGHT_VERTEX_MIRRORS(record) (FIELD_OF(light_vertex_mark, light_vertex_marks, record, mirrors) != 0u)
#else
#define LIGHT_VERTEX_MIRRORS(record) 0
#endif

GRADUS_LIB_END

/* What textures are worth at a vertex: records of textured_columns numbers (kernels/lib/textured_material.h), in a
 * table that only scenes with textures have. */
#define LIGHT_VERTICES_HAVE_TEXTURES (TRAIT_TEXTURED || TRAIT_TEXTURED_NORMALS)
#if LIGHT_VERTICES_HAVE_TEXTURES
#define LIGHT_VERTEX_TEXTURES_ARGUMENT , __global const real *light_vertex_textures
#define LIGHT_VERTEX_TEXTURES , light_vertex_textures
#else
#define LIGHT_VERTEX_TEXTURES_ARGUMENT
#define LIGHT_VERTEX_TEXTURES
#endif

#define SET_FIELD_V3(record, array, index, field, value)                                                               \
    FIELD_OF(record, array, index, field##_x) = (value).x;                                                             \
    FIELD_OF(record, array, index, field##_y) = (value).y;                                                             \
    FIELD_OF(record, array, index, field##_z) = (value).z

#endif
