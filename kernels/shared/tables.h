/* The tables of the wavefront, declared once for host and device.
 *
 * A table is a structure of arrays: column c of row r is element c * capacity + r of one array of `real`. Columns of
 * whole numbers keep a uint in the first four bytes of their slot. Rows are dense: a stage that drops paths writes the
 * survivors side by side, so that every later access is contiguous (an access through an index column costs about three
 * times as much on PoCL).
 *
 * REAL(table, column, text) and UINT(table, column, text). */
#ifndef GRADUS_SHARED_TABLES_H
#define GRADUS_SHARED_TABLES_H
#include "kernels/shared/compat.h"

/* The segment that each path sends out next. Positions in world units; the direction has unit length. */
#define GRADUS_RAY_COLUMNS(REAL, UINT)                                                                                 \
    REAL(ray, origin_x, "where it starts, already moved off the surface")                                              \
    REAL(ray, origin_y, "")                                                                                            \
    REAL(ray, origin_z, "")                                                                                            \
    REAL(ray, direction_x, "unit vector")                                                                              \
    REAL(ray, direction_y, "")                                                                                         \
    REAL(ray, direction_z, "")                                                                                         \
    UINT(ray, primitive, "before tracing: ray_pending or ray_none; after: the primitive hit, ray_escaped, ray_none")

/* The connection of a path's vertex to a light point, from origin along direction to distance 1. */
#define GRADUS_SHADOW_COLUMNS(REAL, UINT)                                                                              \
    REAL(shadow, origin_x, "where it starts, already moved off the surface")                                           \
    REAL(shadow, origin_y, "")                                                                                         \
    REAL(shadow, origin_z, "")                                                                                         \
    REAL(shadow, direction_x, "to the light point, not normalised: the light is at parameter 1")                       \
    REAL(shadow, direction_y, "")                                                                                      \
    REAL(shadow, direction_z, "")                                                                                      \
    REAL(shadow, value_r, "what the path gains if nothing is in between")                                              \
    REAL(shadow, value_g, "")                                                                                          \
    REAL(shadow, value_b, "")                                                                                          \
    UINT(shadow, open, "before tracing: 1 asks for a trace, 0 does not; after: 1 if the light is seen")

/* The newest vertex of each path. Two of these tables alternate: `surface` reads the old one and writes the new. */
#define GRADUS_VERTEX_COLUMNS(REAL, UINT)                                                                              \
    UINT(vertex, slot, "the path's place in its pass: its row in `radiance`")                                          \
    UINT(vertex, key_0, "random numbers: hash of seed, pixel and sample")                                              \
    UINT(vertex, key_1, "")                                                                                            \
    UINT(vertex, depth, "edges of the path before this vertex, less one: 0 at what the camera sees")                   \
    REAL(vertex, throughput_r, "contribution over density of the path so far")                                         \
    REAL(vertex, throughput_g, "")                                                                                     \
    REAL(vertex, throughput_b, "")                                                                                     \
    REAL(vertex, pdf, "solid-angle density of the direction sent out; 0 for a Dirac one (light sampling cannot)")      \
    REAL(vertex, position_x, "")                                                                                       \
    REAL(vertex, position_y, "")                                                                                       \
    REAL(vertex, position_z, "")                                                                                       \
    REAL(vertex, offset, "how far a new ray starts off the surface, along the geometric normal")                       \
    REAL(vertex, wi_x, "unit vector to the vertex before, world frame")                                                \
    REAL(vertex, wi_y, "")                                                                                             \
    REAL(vertex, wi_z, "")                                                                                             \
    REAL(vertex, geometric_x, "geometric normal, unit, on the side that the material calls front")                     \
    REAL(vertex, geometric_y, "")                                                                                      \
    REAL(vertex, geometric_z, "")                                                                                      \
    UINT(vertex, material, "record of the material on this side")                                                      \
    REAL(vertex, shading_x,                                                                                            \
         "from here only with TRAIT_SHADING_NORMALS: shading normal, unit, on the side of geometric")                  \
    REAL(vertex, shading_y, "")                                                                                        \
    REAL(vertex, shading_z, "")                                                                                        \
    REAL(vertex, eta, "from here only with TRAIT_REFRACTION: product of index ratios so far, for Russian roulette")

/* The direction in which a rough surface's alpha_u is measured, only with TRAIT_ANISOTROPIC. */
#define GRADUS_TANGENT_COLUMNS(REAL, UINT)                                                                             \
    REAL(tangent, along_x, "dp/du, world frame, any length")                                                           \
    REAL(tangent, along_y, "")                                                                                         \
    REAL(tangent, along_z, "")

/* What each path of a pass has gathered, by slot. A pass has more paths than rows: new ones begin where others end. */
#define GRADUS_RADIANCE_COLUMNS(REAL, UINT)                                                                            \
    REAL(radiance, value_r, "")                                                                                        \
    REAL(radiance, value_g, "")                                                                                        \
    REAL(radiance, value_b, "")

/* First-hit features by slot, only with --aov. */
#define GRADUS_FEATURE_COLUMNS(REAL, UINT)                                                                             \
    REAL(feature, albedo_r, "")                                                                                        \
    REAL(feature, albedo_g, "")                                                                                        \
    REAL(feature, albedo_b, "")                                                                                        \
    REAL(feature, normal_x, "shading normal towards the camera, world frame")                                          \
    REAL(feature, normal_y, "")                                                                                        \
    REAL(feature, normal_z, "")                                                                                        \
    REAL(feature, depth, "distance from the camera")

/* Sums over the samples of each pixel of the crop. The sums are compensated (sum + correction is the value), so that
 * many samples lose nothing; they are added in the order of the samples, whatever the batches are. */
#define GRADUS_FILM_COLUMNS(REAL, UINT)                                                                                \
    REAL(film, sum_r, "")                                                                                              \
    REAL(film, sum_g, "")                                                                                              \
    REAL(film, sum_b, "")                                                                                              \
    REAL(film, correction_r, "")                                                                                       \
    REAL(film, correction_g, "")                                                                                       \
    REAL(film, correction_b, "")                                                                                       \
    UINT(film, rejected, "samples left out because they were NaN or infinite")

/* More sums, only with --aov. */
#define GRADUS_FEATURE_FILM_COLUMNS(REAL, UINT)                                                                        \
    REAL(feature_film, square_r, "sum of squares, for the variance")                                                   \
    REAL(feature_film, square_g, "")                                                                                   \
    REAL(feature_film, square_b, "")                                                                                   \
    REAL(feature_film, square_correction_r, "")                                                                        \
    REAL(feature_film, square_correction_g, "")                                                                        \
    REAL(feature_film, square_correction_b, "")                                                                        \
    REAL(feature_film, albedo_r, "sums of the columns of `feature`")                                                   \
    REAL(feature_film, albedo_g, "")                                                                                   \
    REAL(feature_film, albedo_b, "")                                                                                   \
    REAL(feature_film, normal_x, "")                                                                                   \
    REAL(feature_film, normal_y, "")                                                                                   \
    REAL(feature_film, normal_z, "")                                                                                   \
    REAL(feature_film, depth, "")

GRADUS_LIB_BEGIN

#define GRADUS_COLUMN_INDEX(table, column, text) table##_##column,
enum ray_column { GRADUS_RAY_COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) ray_columns };
enum shadow_column { GRADUS_SHADOW_COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) shadow_columns };
enum vertex_column { GRADUS_VERTEX_COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) vertex_columns };
enum tangent_column { GRADUS_TANGENT_COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) tangent_columns };
enum radiance_column { GRADUS_RADIANCE_COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) radiance_columns };
enum feature_column { GRADUS_FEATURE_COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) feature_columns };
enum film_column { GRADUS_FILM_COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) film_columns };
enum feature_film_column { GRADUS_FEATURE_FILM_COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) feature_film_columns };
#undef GRADUS_COLUMN_INDEX

/* Values of ray_primitive that are no primitive. */
#define ray_escaped 0xFFFFFFFFu /* traced, and nothing was hit */
#define ray_pending 0xFFFFFFFEu /* to be traced */
#define ray_none 0xFFFFFFFDu    /* the path has ended */
#define ray_first_special ray_none

/* The bin of a path that has ended: it is dropped. */
#define bin_none 0xFFFFFFFFu

GRADUS_LIB_END

/* Rows of each table: the name of the kernel argument that says so. */
#define CAPACITY_OF_ray capacity
#define CAPACITY_OF_shadow capacity
#define CAPACITY_OF_vertex capacity
#define CAPACITY_OF_tangent capacity
#define CAPACITY_OF_radiance slots
#define CAPACITY_OF_feature slots
#define CAPACITY_OF_film pixels
#define CAPACITY_OF_feature_film pixels

/* Element access: AT(ray, origin_x, row) is a real, AT_UINT(ray, primitive, row) a uint. The table's pointer has the
 * table's name; AT_IN and AT_UINT_IN are for a second table of the same columns: AT_IN(vertex_old, vertex, pdf, row).
 */
#define AT_IN(pointer, table, column, row) (((pointer) + (size_t)(table##_##column) * (size_t)CAPACITY_OF_##table)[row])
#define AT_UINT_IN(pointer, table, column, row)                                                                        \
    (*(GRADUS_GLOBAL uint *)((pointer) + (size_t)(table##_##column) * (size_t)CAPACITY_OF_##table + (row)))
#define AT(table, column, row) AT_IN(table, table, column, row)
#define AT_UINT(table, column, row) AT_UINT_IN(table, table, column, row)

/* Three columns at once, as vec3 or rgb; kernels/lib/vector.h must be included. */
#define AT_V3(table, column, row) v3(AT(table, column##_x, row), AT(table, column##_y, row), AT(table, column##_z, row))
#define AT_RGB(table, column, row)                                                                                     \
    rgb3(AT(table, column##_r, row), AT(table, column##_g, row), AT(table, column##_b, row))
#define SET_V3(table, column, row, value)                                                                              \
    AT(table, column##_x, row) = (value).x;                                                                            \
    AT(table, column##_y, row) = (value).y;                                                                            \
    AT(table, column##_z, row) = (value).z
#define SET_RGB(table, column, row, value)                                                                             \
    AT(table, column##_r, row) = (value).r;                                                                            \
    AT(table, column##_g, row) = (value).g;                                                                            \
    AT(table, column##_b, row) = (value).b

#endif
