/* How a scene lies in device memory: records of reals, one after the other, in the order of these lists.
 *
 * Primitives are numbered triangles first, then spheres. Random access into a record touches one or two cache
 * lines, which is why these are records and not columns. Materials: kernels/shared/material.h.
 *
 * TRAIT_INDEXED, of scenes with many triangles, is how many numbers a vertex has, and 0 where each triangle has records
 * of its own. With it `triangles` begins with the numbers of each triangle's three vertices, of 32 bits. Records of
 * vertices follow: position, normal (zero where the mesh has none) if any mesh has normals, (u, v) if anybody reads
 * them. They are numbered by their place, counted from the beginning of `triangles` in lengths of such records. Other
 * arguments that bear the names of tables of triangles are the same memory, which who has one of them need not know
 * another for. So are those that bear the names of tables of primitives: for each primitive the place of a record of
 * its surface, and these records behind them. */
#ifndef GRADUS_SHARED_SCENE_RECORDS_H
#define GRADUS_SHARED_SCENE_RECORDS_H
//! traits: TRAIT_INDEXED
#include "kernels/shared/compat.h"

#define GRADUS_TRIANGLE_FIELDS(FIELD)                                                                                  \
    FIELD(triangle, p0_x, "first vertex")                                                                              \
    FIELD(triangle, p0_y, "")                                                                                          \
    FIELD(triangle, p0_z, "")                                                                                          \
    FIELD(triangle, e1_x, "second vertex minus first")                                                                 \
    FIELD(triangle, e1_y, "")                                                                                          \
    FIELD(triangle, e1_z, "")                                                                                          \
    FIELD(triangle, e2_x, "third vertex minus first")                                                                  \
    FIELD(triangle, e2_y, "")                                                                                          \
    FIELD(triangle, e2_z, "")                                                                                          \
    FIELD(triangle, offset, "what its shape adds to how far rays start off")                                           \
    FIELD(triangle, padding_0, "to 48 bytes in float")                                                                 \
    FIELD(triangle, padding_1, "")

/* Shading normals at the three vertices of a triangle, only with TRAIT_SHADING_NORMALS. */
#define GRADUS_TRIANGLE_NORMALS_FIELDS(FIELD)                                                                          \
    FIELD(normals, n0_x, "")                                                                                           \
    FIELD(normals, n0_y, "")                                                                                           \
    FIELD(normals, n0_z, "")                                                                                           \
    FIELD(normals, n1_x, "")                                                                                           \
    FIELD(normals, n1_y, "")                                                                                           \
    FIELD(normals, n1_z, "")                                                                                           \
    FIELD(normals, n2_x, "")                                                                                           \
    FIELD(normals, n2_y, "")                                                                                           \
    FIELD(normals, n2_z, "")

/* dp/du of a triangle, only with TRAIT_ANISOTROPIC. */
#define GRADUS_TRIANGLE_TANGENT_FIELDS(FIELD)                                                                          \
    FIELD(triangle_tangent, along_x, "")                                                                               \
    FIELD(triangle_tangent, along_y, "")                                                                               \
    FIELD(triangle_tangent, along_z, "")

/* What the primitives of a shape share, only with TRAIT_INDEXED. */
#define GRADUS_SURFACE_FIELDS(FIELD)                                                                                   \
    FIELD(surface_of, material, "what primitive_material has by primitive without that trait")                         \
    FIELD(surface_of, bin, "the same of primitive_bin")                                                                \
    FIELD(surface_of, back_bin, "the same of primitive_back_bin")                                                      \
    FIELD(surface_of, lag, "how far the numbers of its lights are behind those of its primitives, or no_light")

/* Where an instance of a group stands, only with TRAIT_INSTANCES: behind the vertices in `triangles`. The first is that
 * of whatever is in no group, and leaves all where it is. */
#define GRADUS_INSTANCE_FIELDS(FIELD)                                                                                  \
    FIELD(instance, x_x, "where the group's x axis goes")                                                              \
    FIELD(instance, x_y, "")                                                                                           \
    FIELD(instance, x_z, "")                                                                                           \
    FIELD(instance, y_x, "")                                                                                           \
    FIELD(instance, y_y, "")                                                                                           \
    FIELD(instance, y_z, "")                                                                                           \
    FIELD(instance, z_x, "")                                                                                           \
    FIELD(instance, z_y, "")                                                                                           \
    FIELD(instance, z_z, "")                                                                                           \
    FIELD(instance, origin_x, "where its origin goes")                                                                 \
    FIELD(instance, origin_y, "")                                                                                      \
    FIELD(instance, origin_z, "")                                                                                      \
    FIELD(instance, facing, "-1: the map mirrors; 1: it does not")                                                     \
    FIELD(instance, rounding_x, "how far rounding in the map may move points of the group, along world axes")          \
    FIELD(instance, rounding_y, "")                                                                                    \
    FIELD(instance, rounding_z, "")

#define GRADUS_SPHERE_FIELDS(FIELD)                                                                                    \
    FIELD(sphere, center_x, "")                                                                                        \
    FIELD(sphere, center_y, "")                                                                                        \
    FIELD(sphere, center_z, "")                                                                                        \
    FIELD(sphere, radius, "below 0 where it is of the far side alone (Sphere::Side)")                                  \
    FIELD(sphere, facing, "1: the normal points out; -1: to the center")                                               \
    FIELD(sphere, offset, "what its size adds to how far rays start off")                                              \
    FIELD(sphere, pole_x, "its own z axis, unit: with TRAIT_ANISOTROPIC dp/du goes around it")                         \
    FIELD(sphere, pole_y, "")                                                                                          \
    FIELD(sphere, pole_z, "")

/* A light is one emitting triangle or sphere, a point, a spot, a direction or the environment, constant or a map. Which
 * members of p and the edges mean what is said by kind: triangle: p0, e1, e2; sphere: center, radius in e1_x, facing in
 * e1_y; point: position; directional: the unit vector towards the light; spot: position, unit axis, and in e2_x to e2_z
 * the cutoff in turns, one over the turns from the beam to it, and 1 - its cosine; projector: position, unit axis;
 * environment map: its x, y and z axes in world space. */
#define GRADUS_LIGHT_FIELDS(FIELD)                                                                                     \
    FIELD(light, alias_threshold, "a draw below it keeps this light, above it takes its alias")                        \
    FIELD(light, probability, "with which the light is chosen, by power; with a tree, once its leaf is reached")       \
    FIELD(light, value_r, "radiance, intensity or irradiance; of a map, what its numbers are times")                   \
    FIELD(light, value_g, "")                                                                                          \
    FIELD(light, value_b, "")                                                                                          \
    FIELD(light, p_x, "")                                                                                              \
    FIELD(light, p_y, "")                                                                                              \
    FIELD(light, p_z, "")                                                                                              \
    FIELD(light, e1_x, "")                                                                                             \
    FIELD(light, e1_y, "")                                                                                             \
    FIELD(light, e1_z, "")                                                                                             \
    FIELD(light, e2_x, "")                                                                                             \
    FIELD(light, e2_y, "")                                                                                             \
    FIELD(light, e2_z, "")                                                                                             \
    FIELD(light, inverse_area, "triangles and spheres; for the density of hits; of a map, its scale (environment.h)")  \
    FIELD(light, offset, "of the triangle or sphere; of a point, how far off it rays begin and end")

/* How light paths choose among the lights. */
#define GRADUS_EMISSION_FIELDS(FIELD)                                                                                  \
    FIELD(emission, alias_threshold, "a draw below it keeps this light, above it takes its alias")                     \
    FIELD(emission, probability, "with which light paths begin at the light: half by power, half shared by emitters")

#define GRADUS_CAMERA_FIELDS(FIELD)                                                                                    \
    FIELD(camera, origin_x, "")                                                                                        \
    FIELD(camera, origin_y, "")                                                                                        \
    FIELD(camera, origin_z, "")                                                                                        \
    FIELD(camera, corner_x, "direction, not normalised, through the top left corner of the full film")                 \
    FIELD(camera, corner_y, "")                                                                                        \
    FIELD(camera, corner_z, "")                                                                                        \
    FIELD(camera, right_x, "change of that direction by one pixel to the right")                                       \
    FIELD(camera, right_y, "")                                                                                         \
    FIELD(camera, right_z, "")                                                                                         \
    FIELD(camera, down_x, "change of that direction by one pixel down")                                                \
    FIELD(camera, down_y, "")                                                                                          \
    FIELD(camera, down_z, "")                                                                                          \
    FIELD(camera, forward_x, "unit vector")                                                                            \
    FIELD(camera, forward_y, "")                                                                                       \
    FIELD(camera, forward_z, "")                                                                                       \
    FIELD(camera, near_clip, "along forward: nothing nearer is seen")                                                  \
    FIELD(camera, far_clip, "nothing farther is seen")                                                                 \
    FIELD(camera, step_right_x, "orthographic: change of the ray's origin by one pixel to the right")                  \
    FIELD(camera, step_right_y, "")                                                                                    \
    FIELD(camera, step_right_z, "")                                                                                    \
    FIELD(camera, step_down_x, "by one pixel down")                                                                    \
    FIELD(camera, step_down_y, "")                                                                                     \
    FIELD(camera, step_down_z, "")                                                                                     \
    FIELD(camera, lens_left_x, "thin lens: its radius to the left of the image")                                       \
    FIELD(camera, lens_left_y, "")                                                                                     \
    FIELD(camera, lens_left_z, "")                                                                                     \
    FIELD(camera, lens_up_x, "its radius upwards")                                                                     \
    FIELD(camera, lens_up_y, "")                                                                                       \
    FIELD(camera, lens_up_z, "")                                                                                       \
    FIELD(camera, inverse_focus, "one over the distance of the plane of focus along forward")

/* Where a mesh has no (u, v), corners of its triangles have those of the unit triangle, (0, 0), (1, 0) and (0, 1). In
 * place of the first 0 is this, which is as good: so they tell no direction of dp/du. */
#define unit_first_u 0x1p-100f

GRADUS_LIB_BEGIN

#define GRADUS_RECORD_INDEX(record, field, text) record##_##field,
enum triangle_field { GRADUS_TRIANGLE_FIELDS(GRADUS_RECORD_INDEX) triangle_stride };
enum normals_field { GRADUS_TRIANGLE_NORMALS_FIELDS(GRADUS_RECORD_INDEX) normals_stride };
enum triangle_tangent_field { GRADUS_TRIANGLE_TANGENT_FIELDS(GRADUS_RECORD_INDEX) triangle_tangent_stride };
enum surface_of_field { GRADUS_SURFACE_FIELDS(GRADUS_RECORD_INDEX) surface_of_stride };
enum instance_field { GRADUS_INSTANCE_FIELDS(GRADUS_RECORD_INDEX) instance_stride };
enum sphere_field { GRADUS_SPHERE_FIELDS(GRADUS_RECORD_INDEX) sphere_stride };
enum light_field { GRADUS_LIGHT_FIELDS(GRADUS_RECORD_INDEX) light_stride };
enum emission_field { GRADUS_EMISSION_FIELDS(GRADUS_RECORD_INDEX) emission_stride };
enum camera_field { GRADUS_CAMERA_FIELDS(GRADUS_RECORD_INDEX) camera_stride };
#undef GRADUS_RECORD_INDEX

enum light_kind {
    light_kind_triangle,
    light_kind_sphere,
    light_kind_point,
    light_kind_directional,
    light_kind_constant,
    light_kind_environment,
    light_kind_spot,
    light_kind_projector
};

/* primitive_light of a primitive that does not emit. */
#define no_light 0xFFFFFFFFu

/* primitive_material is a material record with this bit set where the material is the same from both sides, or has
 * another record for its back. */
#define material_two_sided 0x80000000u
#define material_record(value) ((value) & ~material_two_sided)

/* Members of a record: FIELD_OF(light, lights, 3, value_r). `unit` is an argument of each kernel and always 1: a
 * compiler that cannot know this does not join the loads of neighbouring fields into short vectors, which would stop
 * PoCL from vectorising over work-items. The place of the record is a signed number of 32 bits, which all fields share:
 * gathers take such ones as they are. */
#define FIELD_OF(record, array, index, field)                                                                          \
    ((array) + record##_##field * (size_t)unit)[(int)((uint)(index) * (uint)record##_stride)]
#define FIELD_V3(record, array, index, field)                                                                          \
    v3(FIELD_OF(record, array, index, field##_x), FIELD_OF(record, array, index, field##_y),                           \
       FIELD_OF(record, array, index, field##_z))
#define FIELD_RGB(record, array, index, field)                                                                         \
    rgb3(FIELD_OF(record, array, index, field##_r), FIELD_OF(record, array, index, field##_g),                         \
         FIELD_OF(record, array, index, field##_b))

/* By primitive: the field of its surface, from the argument that bears the name of its column. */
#if TRAIT_INDEXED
#define OF_PRIMITIVE(column, field, primitive) (column)[(int)((column)[primitive] + (uint)surface_of_##field)]
#define LIGHT_OF_PRIMITIVE(column, primitive) light_behind(OF_PRIMITIVE(column, lag, primitive), primitive)
GRADUS_FN uint light_behind(uint lag, uint primitive) { return lag == no_light ? no_light : primitive - lag; }
#else
#define OF_PRIMITIVE(column, field, primitive) (column)[primitive]
#define LIGHT_OF_PRIMITIVE(column, primitive) (column)[primitive]
#endif

GRADUS_LIB_END
#endif
