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
#include "kernels/shared/walk_tables.h"

/* The segment that each path sends out next. Positions in world units; the direction has unit length. */
#define GRADUS_RAY_COLUMNS(REAL, UINT)                                                                                 \
    REAL(ray, origin_x, "where it starts, already moved off the surface")                                              \
    REAL(ray, origin_y, "")                                                                                            \
    REAL(ray, origin_z, "")                                                                                            \
    REAL(ray, direction_x, "unit vector")                                                                              \
    REAL(ray, direction_y, "")                                                                                         \
    REAL(ray, direction_z, "")                                                                                         \
    UINT(ray, primitive, "before tracing: ray_pending or ray_none; after: the primitive hit, ray_escaped, ray_none")   \
    UINT(ray, instance, "only with TRAIT_INSTANCES: record of the instance that was hit, if anything was")             \
    UINT(ray, opacity, "only with TRAIT_OPACITY: share of the rays that meet what was hit there, in ray_opacity_one")

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

/* The state of each path. Two of these tables and two of `ray` alternate: `shade` reads the old row of a path and
 * writes the new one. */
#define GRADUS_PATH_COLUMNS(REAL, UINT)                                                                                \
    UINT(path, slot, "its place in its pass: its row in `radiance`")                                                   \
    UINT(path, key_0, "random numbers: hash of seed, pixel and sample")                                                \
    UINT(path, key_1, "")                                                                                              \
    UINT(path, depth, "edges so far, the one in `ray` not counted: 0 for the camera's own ray")                        \
    REAL(path, throughput_r, "contribution over density, the direction in `ray` included")                             \
    REAL(path, throughput_g, "")                                                                                       \
    REAL(path, throughput_b, "")                                                                                       \
    REAL(path, pdf, "solid-angle density of the direction in `ray`; 0 for a specular one (light sampling cannot)")     \
    REAL(path, eta, "only with TRAIT_REFRACTION: product of index ratios so far, for Russian roulette")                \
    UINT(path, receiver, "only with TRAIT_LIGHT_TREE: normal of the vertex that it left, as light_normal_bits()")

/* A surface as a path meets it, whichever path: what the columns of any table of vertices are. */
#define GRADUS_SURFACE_VERTEX_COLUMNS(table, REAL, UINT)                                                               \
    UINT(table, kind, "its BSDF kind with kind_is_...; kind_none where nothing was hit")                               \
    UINT(table, material, "record of the material on this side")                                                       \
    REAL(table, position_x, "")                                                                                        \
    REAL(table, position_y, "")                                                                                        \
    REAL(table, position_z, "")                                                                                        \
    REAL(table, offset, "how far a new ray starts off the surface, along the geometric normal")                        \
    REAL(table, wi_x, "unit vector to the vertex before, world frame")                                                 \
    REAL(table, wi_y, "")                                                                                              \
    REAL(table, wi_z, "")                                                                                              \
    REAL(table, geometric_x, "geometric normal, unit, on the side that the material calls front")                      \
    REAL(table, geometric_y, "")                                                                                       \
    REAL(table, geometric_z, "")                                                                                       \
    REAL(table, shading_x, "only with TRAIT_SHADING_NORMALS or TRAIT_ANISOTROPIC: unit, on the side of geometric")     \
    REAL(table, shading_y, "")                                                                                         \
    REAL(table, shading_z, "")                                                                                         \
    REAL(table, along_x,                                                                                               \
         "only with TRAIT_ANISOTROPIC: dp/du, any length, where a rough surface's alpha_u is measured")                \
    REAL(table, along_y, "")                                                                                           \
    REAL(table, along_z, "")

/* What each path of a pass has gathered, by slot. A pass has more paths than rows: new ones begin where others end. */
#define GRADUS_RADIANCE_COLUMNS(REAL, UINT)                                                                            \
    REAL(radiance, value_r, "")                                                                                        \
    REAL(radiance, value_g, "")                                                                                        \
    REAL(radiance, value_b, "")

/* Features by slot (kernels/lib/seen_features.h), only with TRAIT_AOV. */
#define GRADUS_FEATURE_COLUMNS(REAL, UINT)                                                                             \
    REAL(feature, albedo_r, "")                                                                                        \
    REAL(feature, albedo_g, "")                                                                                        \
    REAL(feature, albedo_b, "")                                                                                        \
    REAL(feature, normal_x, "shading normal towards the camera, world frame")                                          \
    REAL(feature, normal_y, "")                                                                                        \
    REAL(feature, normal_z, "")                                                                                        \
    REAL(feature, depth, "length of the way from the camera; negative where mirrors and glass alone were met")         \
    REAL(feature, weight, "how many paths it counts as")

/* One sample of each pixel, all of one frame: only with filters by which samples count for the pixels around too
 * (kernels/lib/filter_frame.h). The features only with TRAIT_AOV. */
#define GRADUS_FRAME_COLUMNS(REAL, UINT)                                                                               \
    REAL(frame, value_r, "")                                                                                           \
    REAL(frame, value_g, "")                                                                                           \
    REAL(frame, value_b, "")                                                                                           \
    REAL(frame, albedo_r, "columns of `feature`, times the weight")                                                    \
    REAL(frame, albedo_g, "")                                                                                          \
    REAL(frame, albedo_b, "")                                                                                          \
    REAL(frame, normal_x, "")                                                                                          \
    REAL(frame, normal_y, "")                                                                                          \
    REAL(frame, normal_z, "")                                                                                          \
    REAL(frame, depth, "")

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

/* More sums, only with --aov; the deviations not with replicates, whose spread tells the variance (sample_number.h). */
#define GRADUS_FEATURE_FILM_COLUMNS(REAL, UINT)                                                                        \
    REAL(feature_film, albedo_r, "means of the columns of `feature`")                                                  \
    REAL(feature_film, albedo_g, "")                                                                                   \
    REAL(feature_film, albedo_b, "")                                                                                   \
    REAL(feature_film, normal_x, "")                                                                                   \
    REAL(feature_film, normal_y, "")                                                                                   \
    REAL(feature_film, normal_z, "")                                                                                   \
    REAL(feature_film, depth, "")                                                                                      \
    REAL(feature_film, deviation_r, "sums of squared deviations from the mean, for the variance")                      \
    REAL(feature_film, deviation_g, "")                                                                                \
    REAL(feature_film, deviation_b, "")

/* What paths add to pixels that are not their own. The pixel is in a table of uints of its own, by which they are
 * sorted. The sums are those of `film`, in a table `splat_film` of the same columns. */
#define GRADUS_SPLAT_COLUMNS(REAL, UINT)                                                                               \
    REAL(splat, value_r, "")                                                                                           \
    REAL(splat, value_g, "")                                                                                           \
    REAL(splat, value_b, "")

/* Light paths (methods/photons/light_paths.h). The state of each; two of these tables alternate. */
#define GRADUS_LIGHT_PATH_COLUMNS(REAL, UINT)                                                                          \
    UINT(light_path, slot, "its place in its pass")                                                                    \
    UINT(light_path, key_0, "random numbers: hash of seed and the light path's number")                                \
    UINT(light_path, key_1, "")                                                                                        \
    UINT(light_path, depth, "edges so far, the one in `ray` not counted: 0 for the ray that leaves the light")         \
    UINT(light_path, stored, "photons that it has left so far")                                                        \
    REAL(light_path, power_r, "flux along the ray if there were this light path alone, W")                             \
    REAL(light_path, power_g, "")                                                                                      \
    REAL(light_path, power_b, "")                                                                                      \
    REAL(light_path, start, "the largest of its three fluxes where it began, for Russian roulette")                    \
    UINT(light_path, vertex, "only with TRAIT_LIGHT_VERTICES: record of its newest vertex (light_vertex.h)")

/* A photon: where a light path met a surface, whichever table it is in. */
#define GRADUS_PHOTON_COLUMNS_OF(table, REAL, UINT)                                                                    \
    REAL(table, position_x, "")                                                                                        \
    REAL(table, position_y, "")                                                                                        \
    REAL(table, position_z, "")                                                                                        \
    REAL(table, wi_x, "unit vector to the vertex before, world frame")                                                 \
    REAL(table, wi_y, "")                                                                                              \
    REAL(table, wi_z, "")                                                                                              \
    REAL(table, power_r, "flux that arrives if there were this light path alone, W; shared out among all of them")     \
    REAL(table, power_g, "")                                                                                           \
    REAL(table, power_b, "")                                                                                           \
    REAL(table, normal_x, "geometric normal, unit, on the side that the material calls front")                         \
    REAL(table, normal_y, "")                                                                                          \
    REAL(table, normal_z, "")                                                                                          \
    UINT(table, depth, "edges from the light: 1 for what arrives directly")                                            \
    UINT(table, before, "only with TRAIT_LIGHT_VERTICES: record of the vertex that it came from (light_vertex.h)")

/* All photons of a pass as they came, which goes by the batch. Table `photon_order` has their rows by light path and
 * along each, which does not. Rows that it does not have are of no photons. */
#define GRADUS_PHOTON_COLUMNS(REAL, UINT) GRADUS_PHOTON_COLUMNS_OF(photon, REAL, UINT)

/* Where they belong. */
#define GRADUS_PHOTON_ORIGIN_COLUMNS(REAL, UINT)                                                                       \
    UINT(photon_origin, slot, "number of the light path among those traced with it")                                   \
    UINT(photon_origin, ordinal, "photons that it left before this one; photon_none where this is none itself")

/* The photons of `photon`, cell by cell of a grid. */
#define GRADUS_PHOTON_SORTED_COLUMNS(REAL, UINT) GRADUS_PHOTON_COLUMNS_OF(photon_sorted, REAL, UINT)

/* Where camera paths ended at a surface that is rough enough: photons near it are gathered there. */
#define GRADUS_GATHER_COLUMNS(REAL, UINT)                                                                              \
    UINT(gather, slot, "of its path: the row in `radiance`")                                                           \
    UINT(gather, deepest, "edges that a photon's light path may have")                                                 \
    REAL(gather, radius, "photons are gathered from so far")                                                           \
    REAL(gather, throughput_r, "of the camera path, contribution over density")                                        \
    REAL(gather, throughput_g, "")                                                                                     \
    REAL(gather, throughput_b, "")                                                                                     \
    REAL(gather, sum_r, "of the photons' f power, so far")                                                             \
    REAL(gather, sum_g, "")                                                                                            \
    REAL(gather, sum_b, "")                                                                                            \
    GRADUS_SURFACE_VERTEX_COLUMNS(gather, REAL, UINT)

/* Of the photons' f power, those within the inner half of the disc's area. */
#define GRADUS_GATHER_INNER_COLUMNS(REAL, UINT)                                                                        \
    REAL(gather_inner, value_r, "")                                                                                    \
    REAL(gather_inner, value_g, "")                                                                                    \
    REAL(gather_inner, value_b, "")

/* By slot: what the radius adds to the radiance of this pass. */
#define GRADUS_SLOT_BIAS_COLUMNS(REAL, UINT)                                                                           \
    REAL(slot_bias, value_r, "")                                                                                       \
    REAL(slot_bias, value_g, "")                                                                                       \
    REAL(slot_bias, value_b, "")

/* By pixel, of even passes before odd ones: the sum over passes of what the radius adds to the radiance. */
#define GRADUS_RADIUS_BIAS_COLUMNS(REAL, UINT)                                                                         \
    REAL(radius_bias, value_r, "")                                                                                     \
    REAL(radius_bias, value_g, "")                                                                                     \
    REAL(radius_bias, value_b, "")

/* What a pair of gather point and photon is worth: f power. The pair itself is in `pair_gather` and `pair_photon`. */
#define GRADUS_PAIR_VALUE_COLUMNS(REAL, UINT)                                                                          \
    REAL(pair_value, value_r, "")                                                                                      \
    REAL(pair_value, value_g, "")                                                                                      \
    REAL(pair_value, value_b, "")

/* Gradient-domain photon mapping only: gather points are in rows of slots, those of base paths in plane 0, those of
 * their offset paths j in plane j + 1, strip_pixels rows apart. Their radius is 0 where a path has left none, and
 * gather_absent where there is no neighbour. */

/* Offset less base of each pair, weighted: that of offset j of pair i in row j * pair_rows + i. Without flux_scale. */
#define GRADUS_PAIR_DIFFERENCE_COLUMNS(REAL, UINT)                                                                     \
    REAL(pair_difference, value_r, "")                                                                                 \
    REAL(pair_difference, value_g, "")                                                                                 \
    REAL(pair_difference, value_b, "")

/* Photons on their way to offset gather points: those in `moved_index`, in its order. */
#define GRADUS_MOVED_COLUMNS(REAL, UINT)                                                                               \
    REAL(moved, origin_x, "of the offset photon's last ray")                                                           \
    REAL(moved, origin_y, "")                                                                                          \
    REAL(moved, origin_z, "")                                                                                          \
    REAL(moved, direction_x, "unit vector")                                                                            \
    REAL(moved, direction_y, "")                                                                                       \
    REAL(moved, direction_z, "")                                                                                       \
    UINT(moved, primitive, "as in `ray`")                                                                              \
    REAL(moved, power_r, "of the offset photon over the base's density, times the Jacobian")                           \
    REAL(moved, power_g, "")                                                                                           \
    REAL(moved, power_b, "")                                                                                           \
    REAL(moved, ratio, "of both densities, times the Jacobian")

/* Of photons at the end of chains, whether they are what their gather point's plane sees from above: a segment from
 * origin along direction to distance 1. Row of the chain. */
#define GRADUS_MOVED_LINK_COLUMNS(REAL, UINT)                                                                          \
    REAL(moved_link, origin_x, "")                                                                                     \
    REAL(moved_link, origin_y, "")                                                                                     \
    REAL(moved_link, origin_z, "")                                                                                     \
    REAL(moved_link, direction_x, "not normalised")                                                                    \
    REAL(moved_link, direction_y, "")                                                                                  \
    REAL(moved_link, direction_z, "")                                                                                  \
    UINT(moved_link, open, "before tracing: 1 asks for a trace, 0 does not; after: 1 if nothing is in between")

/* Gradient-domain path tracing only, from here on. A base path has four offset paths, j = 0 to 3: through the pixel to
 * the right, left, below and above (gradient_neighbour in kernels/lib/gradient.h). Tables of offset paths have the
 * offset j of row r at row j * capacity + r. */

/* What the camera sees through each pixel of a strip and of the rows beside it: where base and offset paths begin. */
#define GRADUS_PRIMARY_COLUMNS(REAL, UINT)                                                                             \
    UINT(primary, key_0, "random numbers of the pixel's path")                                                         \
    UINT(primary, key_1, "")                                                                                           \
    UINT(primary, primitive, "the primitive, or ray_escaped")                                                          \
    REAL(primary, direction_x, "of the camera's ray, unit vector")                                                     \
    REAL(primary, direction_y, "")                                                                                     \
    REAL(primary, direction_z, "")                                                                                     \
    REAL(primary, origin_x, "of the ray; these three only where the camera's rays have several")                       \
    REAL(primary, origin_y, "")                                                                                        \
    REAL(primary, origin_z, "")                                                                                        \
    UINT(primary, instance, "only with TRAIT_INSTANCES: as in `ray`")
#define GRADUS_PRIMARY_VERTEX_COLUMNS(REAL, UINT) GRADUS_SURFACE_VERTEX_COLUMNS(primary_vertex, REAL, UINT)

/* The newest vertex of a base path while it has offset paths of its own. */
#define GRADUS_VERTEX_COLUMNS(REAL, UINT) GRADUS_SURFACE_VERTEX_COLUMNS(vertex, REAL, UINT)

/* What the base path did there, for its offset paths to do alike. */
#define GRADUS_EVENT_COLUMNS(REAL, UINT)                                                                               \
    REAL(event, pdf, "of the direction sampled: by solid angle, or the probability of a specular one")                 \
    REAL(event, weight_r, "f |cos| over that density")                                                                 \
    REAL(event, weight_g, "")                                                                                          \
    REAL(event, weight_b, "")                                                                                          \
    REAL(event, to_light_x, "unit vector to the light point sampled")                                                  \
    REAL(event, to_light_y, "")                                                                                        \
    REAL(event, to_light_z, "")                                                                                        \
    REAL(event, arriving_r, "what arrives from there over the light's density")                                        \
    REAL(event, arriving_g, "")                                                                                        \
    REAL(event, arriving_b, "")                                                                                        \
    REAL(event, inverse_light_pdf, "1 over that density by solid angle; 0 where BSDF sampling cannot find the light")  \
    REAL(event, base_bsdf, "density with which BSDF sampling finds the light point, over light sampling's")            \
    REAL(event, inverse_survival,                                                                                      \
         "only with TRAIT_APART, from `join` on: 1 over the chance of surviving its roulette")                         \
    UINT(event, light, "only with TRAIT_LIGHT_TREE: the light sampled")                                                \
    REAL(event, light_path, "with it: probability of the tree's way to its leaf")

/* With TRAIT_APART, the vertices of offset paths that are not connected, beyond the first. */
#define GRADUS_OFFSET_VERTEX_COLUMNS(REAL, UINT) GRADUS_SURFACE_VERTEX_COLUMNS(offset_vertex, REAL, UINT)

/* Either of both, as an argument: a vertex of an offset path's own. */
#define GRADUS_OWN_VERTEX_COLUMNS(REAL, UINT) GRADUS_SURFACE_VERTEX_COLUMNS(own_vertex, REAL, UINT)

/* With TRAIT_APART, the rays by which they go on: as in `ray`, row j * stride + r, stride being the rows with offset
 * paths of their own. */
#define GRADUS_OFFSET_RAY_COLUMNS(REAL, UINT)                                                                          \
    REAL(offset_ray, origin_x, "")                                                                                     \
    REAL(offset_ray, origin_y, "")                                                                                     \
    REAL(offset_ray, origin_z, "")                                                                                     \
    REAL(offset_ray, direction_x, "")                                                                                  \
    REAL(offset_ray, direction_y, "")                                                                                  \
    REAL(offset_ray, direction_z, "")                                                                                  \
    UINT(offset_ray, primitive, "")                                                                                    \
    UINT(offset_ray, instance, "only with TRAIT_INSTANCES")

/* Rays that are traced, as an argument: those of any table of rays. */
#define GRADUS_TRACED_COLUMNS(REAL, UINT)                                                                              \
    REAL(traced, origin_x, "as in `ray`")                                                                              \
    REAL(traced, origin_y, "")                                                                                         \
    REAL(traced, origin_z, "")                                                                                         \
    REAL(traced, direction_x, "")                                                                                      \
    REAL(traced, direction_y, "")                                                                                      \
    REAL(traced, direction_z, "")                                                                                      \
    UINT(traced, primitive, "")                                                                                        \
    UINT(traced, instance, "only with TRAIT_INSTANCES")

/* The state of offset paths. All values are over the density of the base path. Two of these tables alternate. */
#define GRADUS_OFFSET_COLUMNS(REAL, UINT)                                                                              \
    REAL(offset, value_r, "contribution so far, times the Jacobian of the shift")                                      \
    REAL(offset, value_g, "")                                                                                          \
    REAL(offset, value_b, "")                                                                                          \
    REAL(offset, ratio, "density times the Jacobian over the base's; shift_failed or shift_absent")                    \
    REAL(offset, wi_x, "unit vector from the newest vertex to the offset path's vertex before, world frame")           \
    REAL(offset, wi_y, "")                                                                                             \
    REAL(offset, wi_z, "")                                                                                             \
    UINT(offset, state, "from here only with TRAIT_APART: one of connection_state")                                    \
    REAL(offset, pdf, "where it is not connected: density of its last direction, by solid angle; 0 for a specular one")

/* How offset paths that are not connected go on, until it is known what their rays and segments meet. */
#define GRADUS_SHIFT_COLUMNS(REAL, UINT)                                                                               \
    REAL(shift, light_jacobian, "of the connection to the light point, by solid angle at both vertices")               \
    REAL(shift, light_density,                                                                                         \
         "of light sampling there, times the Jacobian, over the base path's; then offset_ratio, of those that "        \
         "step by themselves before the step")                                                                         \
    REAL(shift, jacobian, "of the step to the next vertex; 0 where it cannot be made")                                 \
    UINT(shift, outcome, "one of GRADUS_SHIFT_OUTCOMES: which step it is, or why there is none")                       \
    UINT(shift, receiver, "only with TRAIT_LIGHT_TREE: normal of the vertex that it left, as light_normal_bits()")

/* What a light with a picture sends towards offset vertices, which is not of the base path's colour: beside `shift`,
 * row by row. */
#define GRADUS_SHOWN_COLUMNS(REAL, UINT)                                                                               \
    REAL(shown, arriving_r, "in the place of event_arriving, before the Jacobian")                                     \
    REAL(shown, arriving_g, "")                                                                                        \
    REAL(shown, arriving_b, "")

/* Requests to the BSDF service `evaluate`, and its answers in their place. Row line * capacity + r: lines 0 to 3 are
 * the light connections of offset paths, 4 to 7 their steps. */
#define GRADUS_EVALUATION_COLUMNS(REAL, UINT)                                                                          \
    REAL(evaluation, value_r, "wo.x, world frame, unit; then f |cos| (of a specular event the factor times its pdf)")  \
    REAL(evaluation, value_g, "wo.y; as r")                                                                            \
    REAL(evaluation, value_b, "wo.z; as r")                                                                            \
    REAL(evaluation, pdf, "density of wo by solid angle, or the probability of a specular event")

/* Segments that offset paths ask about, from origin along direction to distance 1: row line * stride + r. */
#define GRADUS_LINK_COLUMNS(REAL, UINT)                                                                                \
    REAL(link, origin_x, "")                                                                                           \
    REAL(link, origin_y, "")                                                                                           \
    REAL(link, origin_z, "")                                                                                           \
    REAL(link, direction_x, "not normalised")                                                                          \
    REAL(link, direction_y, "")                                                                                        \
    REAL(link, direction_z, "")                                                                                        \
    UINT(link, open, "before tracing: 1 asks for a trace, 0 does not; after: 1 if nothing is in between")

/* The base path by slot: what it gathered before its offset paths merged with it, and its throughput there. */
#define GRADUS_PREFIX_COLUMNS(REAL, UINT)                                                                              \
    REAL(prefix, value_r, "")                                                                                          \
    REAL(prefix, value_g, "")                                                                                          \
    REAL(prefix, value_b, "")                                                                                          \
    REAL(prefix, throughput_r, "contribution over density")                                                            \
    REAL(prefix, throughput_g, "")                                                                                     \
    REAL(prefix, throughput_b, "")

/* Offset less base, by slot: offset j of slot s is row j * slots + s. */
#define GRADUS_DIFFERENCE_COLUMNS(REAL, UINT)                                                                          \
    REAL(difference, value_r, "weighted difference gathered before the paths merged; at last, the whole")              \
    REAL(difference, value_g, "")                                                                                      \
    REAL(difference, value_b, "")                                                                                      \
    REAL(difference, throughput_r, "of the offset path where they merged, over the base's density")                    \
    REAL(difference, throughput_g, "")                                                                                 \
    REAL(difference, throughput_b, "")                                                                                 \
    REAL(difference, ratio, "as in `offset`")

/* Differences of offset 2 in the last row of a strip, which the next strip finishes: by column of the image. */
#define GRADUS_CARRY_COLUMNS(REAL, UINT)                                                                               \
    REAL(carry, value_r, "")                                                                                           \
    REAL(carry, value_g, "")                                                                                           \
    REAL(carry, value_b, "")

/* As `frame` has samples: those without what the camera sees of lights, and differences. */
#define GRADUS_GRADIENT_FRAME_COLUMNS(REAL, UINT)                                                                      \
    REAL(gradient_frame, primal_r, "")                                                                                 \
    REAL(gradient_frame, primal_g, "")                                                                                 \
    REAL(gradient_frame, primal_b, "")                                                                                 \
    REAL(gradient_frame, right_r, "I(x + 1, y) - I(x, y)")                                                             \
    REAL(gradient_frame, right_g, "")                                                                                  \
    REAL(gradient_frame, right_b, "")                                                                                  \
    REAL(gradient_frame, above_r, "I(x, y) - I(x, y - 1)")                                                             \
    REAL(gradient_frame, above_g, "")                                                                                  \
    REAL(gradient_frame, above_b, "")

/* Sums over the samples of each pixel, compensated as in `film`, and sums of squares for the variances. */
#define GRADUS_GRADIENT_FILM_COLUMNS(REAL, UINT)                                                                       \
    REAL(gradient_film, primal_r, "without what the camera sees of lights")                                            \
    REAL(gradient_film, primal_g, "")                                                                                  \
    REAL(gradient_film, primal_b, "")                                                                                  \
    REAL(gradient_film, dx_r, "I(x + 1, y) - I(x, y); 0 in the last column")                                           \
    REAL(gradient_film, dx_g, "")                                                                                      \
    REAL(gradient_film, dx_b, "")                                                                                      \
    REAL(gradient_film, dy_r, "I(x, y + 1) - I(x, y); 0 in the last row")                                              \
    REAL(gradient_film, dy_g, "")                                                                                      \
    REAL(gradient_film, dy_b, "")                                                                                      \
    REAL(gradient_film, correction_first, "corrections of these nine")                                                 \
    REAL(gradient_film, correction_1, "")                                                                              \
    REAL(gradient_film, correction_2, "")                                                                              \
    REAL(gradient_film, correction_3, "")                                                                              \
    REAL(gradient_film, correction_4, "")                                                                              \
    REAL(gradient_film, correction_5, "")                                                                              \
    REAL(gradient_film, correction_6, "")                                                                              \
    REAL(gradient_film, correction_7, "")                                                                              \
    REAL(gradient_film, correction_8, "")                                                                              \
    REAL(gradient_film, deviation_first, "sums of squared deviations from their means")                                \
    REAL(gradient_film, deviation_1, "")                                                                               \
    REAL(gradient_film, deviation_2, "")                                                                               \
    REAL(gradient_film, deviation_3, "")                                                                               \
    REAL(gradient_film, deviation_4, "")                                                                               \
    REAL(gradient_film, deviation_5, "")                                                                               \
    REAL(gradient_film, deviation_6, "")                                                                               \
    REAL(gradient_film, deviation_7, "")                                                                               \
    REAL(gradient_film, deviation_8, "")

/* All of these: TABLE(name, columns). */
#define GRADUS_TABLES(TABLE)                                                                                           \
    TABLE(ray, GRADUS_RAY_COLUMNS)                                                                                     \
    TABLE(traced, GRADUS_TRACED_COLUMNS)                                                                               \
    TABLE(shadow, GRADUS_SHADOW_COLUMNS)                                                                               \
    TABLE(path, GRADUS_PATH_COLUMNS)                                                                                   \
    TABLE(radiance, GRADUS_RADIANCE_COLUMNS)                                                                           \
    TABLE(frame, GRADUS_FRAME_COLUMNS)                                                                                 \
    TABLE(feature, GRADUS_FEATURE_COLUMNS)                                                                             \
    TABLE(film, GRADUS_FILM_COLUMNS)                                                                                   \
    TABLE(feature_film, GRADUS_FEATURE_FILM_COLUMNS)                                                                   \
    TABLE(light_path, GRADUS_LIGHT_PATH_COLUMNS)                                                                       \
    TABLE(photon, GRADUS_PHOTON_COLUMNS)                                                                               \
    TABLE(photon_origin, GRADUS_PHOTON_ORIGIN_COLUMNS)                                                                 \
    TABLE(photon_sorted, GRADUS_PHOTON_SORTED_COLUMNS)                                                                 \
    TABLE(gather, GRADUS_GATHER_COLUMNS)                                                                               \
    TABLE(gather_inner, GRADUS_GATHER_INNER_COLUMNS)                                                                   \
    TABLE(slot_bias, GRADUS_SLOT_BIAS_COLUMNS)                                                                         \
    TABLE(radius_bias, GRADUS_RADIUS_BIAS_COLUMNS)                                                                     \
    TABLE(pair_value, GRADUS_PAIR_VALUE_COLUMNS)                                                                       \
    TABLE(pair_difference, GRADUS_PAIR_DIFFERENCE_COLUMNS)                                                             \
    TABLE(moved, GRADUS_MOVED_COLUMNS)                                                                                 \
    TABLE(moved_link, GRADUS_MOVED_LINK_COLUMNS)                                                                       \
    TABLE(primary, GRADUS_PRIMARY_COLUMNS)                                                                             \
    TABLE(primary_vertex, GRADUS_PRIMARY_VERTEX_COLUMNS)                                                               \
    TABLE(vertex, GRADUS_VERTEX_COLUMNS)                                                                               \
    TABLE(event, GRADUS_EVENT_COLUMNS)                                                                                 \
    TABLE(offset_vertex, GRADUS_OFFSET_VERTEX_COLUMNS)                                                                 \
    TABLE(own_vertex, GRADUS_OWN_VERTEX_COLUMNS)                                                                       \
    TABLE(offset_ray, GRADUS_OFFSET_RAY_COLUMNS)                                                                       \
    TABLE(offset, GRADUS_OFFSET_COLUMNS)                                                                               \
    TABLE(shift, GRADUS_SHIFT_COLUMNS)                                                                                 \
    TABLE(shown, GRADUS_SHOWN_COLUMNS)                                                                                 \
    TABLE(evaluation, GRADUS_EVALUATION_COLUMNS)                                                                       \
    TABLE(link, GRADUS_LINK_COLUMNS)                                                                                   \
    TABLE(prefix, GRADUS_PREFIX_COLUMNS)                                                                               \
    TABLE(difference, GRADUS_DIFFERENCE_COLUMNS)                                                                       \
    TABLE(carry, GRADUS_CARRY_COLUMNS)                                                                                 \
    TABLE(gradient_frame, GRADUS_GRADIENT_FRAME_COLUMNS)                                                               \
    TABLE(gradient_film, GRADUS_GRADIENT_FILM_COLUMNS)                                                                 \
    GRADUS_WALK_TABLES(TABLE)

GRADUS_LIB_BEGIN

#define GRADUS_COLUMN_INDEX(table, column, text) table##_##column,
#define GRADUS_COLUMN_ENUM(table, COLUMNS)                                                                             \
    enum table##_column{COLUMNS(GRADUS_COLUMN_INDEX, GRADUS_COLUMN_INDEX) table##_columns};
GRADUS_TABLES(GRADUS_COLUMN_ENUM)
GRADUS_COLUMN_ENUM(splat, GRADUS_SPLAT_COLUMNS) /* its rows are its writer's */
#undef GRADUS_COLUMN_ENUM
#undef GRADUS_COLUMN_INDEX

/* Frames that gradient_accumulate adds at once. */
#define accumulated_frames 4u

/* A splat_pixel that is none: the row is left out. */
#define splat_none 0xFFFFFFFFu

/* A gather_radius that says that there is no neighbour. */
#define gather_absent R(-1)

/* A photon_origin_ordinal that is none: the row is left out. */
#define photon_none 0xFFFFFFFFu

/* By material record: material_gathers, where camera paths look for photons; material_keeps, where light paths leave
 * them, which of a blend's parts is said alike. */
#define gathers_nowhere 0u  /* too smooth */
#define gathers_in_front 1u /* what arrives from behind is absorbed */
#define gathers_around 2u   /* on both sides */

/* ray_opacity where all rays meet the surface. */
#define ray_opacity_one 0x80000000u

/* Values of ray_primitive that are no primitive. */
#define ray_escaped 0xFFFFFFFFu    /* traced, and nothing was hit */
#define ray_pending 0xFFFFFFFEu    /* to be traced */
#define ray_none 0xFFFFFFFDu       /* the path has ended */
#define ray_unhindered 0xFFFFFFFCu /* to be traced from the camera, past surfaces that emit: TRAIT_HIDE_EMITTERS */
#define ray_first_special ray_unhindered

/* The bin of a path that has ended: it is dropped. */
#define bin_none 0xFFFFFFFFu

/* What `kind` holds beside the number of the BSDF kind. */
#define kind_number(kind) ((kind)&0xFFu)
#define kind_is_rough 0x100u /* offset paths reconnect here */
#define kind_is_dirac 0x200u
#define kind_is_mixed 0x2000u /* a Dirac lobe beside rough ones; the bits between are of chain events */
#define kind_none 0u          /* nothing was hit; diffuse is the kind of number 0, and it is rough */

/* offset_state: how an offset path stands to its base path at its newest vertex. */
#define connection_none 0u /* not connected: at a vertex of its own, to which it came by the half vector */
#define connection_none_rough                                                                                          \
    1u /* the same, from a rough vertex as the base path: it may not end where it could reconnect */
#define connection_recent 2u /* recently connected: at the base path's vertex, which it comes to from another side */
#define connection_full 3u   /* connected: the same vertex from the same side; all that follows is shared */

/* offsets_state, of a base path's row: where its offset paths will be at its next vertex. */
#define offsets_connected 0u /* all at its own, or they failed */
#define offsets_alike 1u     /* some at vertices of their own, all of the base's BSDF kind */
#define offsets_mixed 2u     /* some of other kinds */
#define offsets_place(state) ((state)&3u)
#define offsets_meet_light 4u /* beside that: some of them met a surface that emits */

/* Ratios below zero: the offset path failed, so that the base path counts for itself; or there is no neighbour. */
#define shift_failed(reason) (R(-1) - R(0.0625) * (real)(reason))
#define shift_absent R(-2)
/* From which on it is shift_failed, from which on shift_absent. */
#define shift_first_failed R(0)
#define shift_first_absent R(-1.75)

/* shift_outcome holds these beside the outcome: where base and offset vertex are rough; where the paths can only end.
 */
#define shift_both_rough 0x100u
#define shift_ends 0x200u
#define shift_outcome_of(outcome) ((outcome)&0xFFu)

/* What became of an attempt to take an offset path further. OUTCOME(name, what is said of it); the failures come after
 * outcome_half_vector, and are the reasons of shift_failed. */
#define GRADUS_SHIFT_OUTCOMES(OUTCOME)                                                                                 \
    OUTCOME(reconnected, "with the base path's next vertex")                                                           \
    OUTCOME(half_vector, "copied, with a vertex of its own")                                                           \
    OUTCOME(failed_at_once, "the neighbour sees nothing")                                                              \
    OUTCOME(failed_kinds, "one vertex is Dirac, the other is not")                                                     \
    OUTCOME(failed_side, "the next vertex would be seen from its other side, or grazing")                              \
    OUTCOME(failed_copy, "no direction has this half vector")                                                          \
    OUTCOME(failed_hidden, "the reconnection is blocked")                                                              \
    OUTCOME(failed_nothing, "the offset ray meets nothing, or something where the base path does not")                 \
    OUTCOME(failed_back, "the shift back would reconnect")

#define GRADUS_OUTCOME_INDEX(name, text) outcome_##name,
enum shift_outcome_number { GRADUS_SHIFT_OUTCOMES(GRADUS_OUTCOME_INDEX) shift_outcomes };
#undef GRADUS_OUTCOME_INDEX

#define GRADUS_OUTCOME_INDEX(name, text) walk_##name,
enum walk_outcome_number { GRADUS_WALK_OUTCOMES(GRADUS_OUTCOME_INDEX) walk_outcomes };
#undef GRADUS_OUTCOME_INDEX

GRADUS_LIB_END

/* Rows of each table: the name of the kernel argument that says so. */
#define ROWS_OF_ray capacity
#define ROWS_OF_traced traced_rows
#define ROWS_OF_shadow capacity
#define ROWS_OF_path capacity
#define ROWS_OF_radiance slots
#define ROWS_OF_frame pixels
#define ROWS_OF_feature slots
#define ROWS_OF_film pixels
#define ROWS_OF_feature_film pixels
#define ROWS_OF_splat splat_rows
#define ROWS_OF_light_path capacity
#define ROWS_OF_photon photon_rows
#define ROWS_OF_photon_origin photon_rows
#define ROWS_OF_photon_sorted photon_rows
#define ROWS_OF_gather gather_rows
#define ROWS_OF_gather_inner gather_rows
#define ROWS_OF_slot_bias slots
#define ROWS_OF_radius_bias (2u * pixels)
#define ROWS_OF_pair_value pair_rows
#define ROWS_OF_pair_difference (4u * pair_rows)
#define ROWS_OF_moved (4u * pair_rows)
#define ROWS_OF_moved_link capacity
#define ROWS_OF_primary slots
#define ROWS_OF_primary_vertex slots
#define ROWS_OF_vertex capacity
#define ROWS_OF_event capacity
#define ROWS_OF_offset_vertex (4u * capacity)
#define ROWS_OF_own_vertex own_rows
#define ROWS_OF_offset_ray (4u * capacity)
#define ROWS_OF_offset (4u * capacity)
#define ROWS_OF_shift (4u * capacity)
#define ROWS_OF_shown (4u * capacity)
#define ROWS_OF_evaluation (8u * capacity)
#define ROWS_OF_link (8u * capacity)
#define ROWS_OF_prefix slots
#define ROWS_OF_difference (4u * slots)
#define ROWS_OF_carry crop_width
#define ROWS_OF_gradient_frame pixels
#define ROWS_OF_gradient_film pixels

/* Element access: AT(ray, origin_x, row) is a real, AT_UINT(ray, primitive, row) a uint. The table's pointer has the
 * table's name; AT_IN and AT_UINT_IN are for a second table of the same columns: AT_IN(vertex_old, vertex, pdf, row).
 */
#define AT_IN(pointer, table, column, row) (((pointer) + (size_t)(table##_##column) * (size_t)ROWS_OF_##table)[row])
#define AT_UINT_IN(pointer, table, column, row)                                                                        \
    (*(GRADUS_GLOBAL uint *)((pointer) + (size_t)(table##_##column) * (size_t)ROWS_OF_##table + (row)))
#define AT(table, column, row) AT_IN(table, table, column, row)
#define AT_UINT(table, column, row) AT_UINT_IN(table, table, column, row)

/* Rows that a table or an index names. Signed, for processors gather sixteen elements at once by numbers of 32 bits,
 * and by signed ones alone; by 64 bits eight. No table has 2^31 rows. */
#define AT_ROW_IN(pointer, table, column, row) ((int)AT_UINT_IN(pointer, table, column, row))
#define AT_ROW(table, column, row) AT_ROW_IN(table, table, column, row)
#define AT_INDEX(place) ((int)index[place])

/* Three columns at once, as vec3 or rgb; kernels/lib/vector.h must be included. */
#define AT_V3_IN(pointer, table, column, row)                                                                          \
    v3(AT_IN(pointer, table, column##_x, row), AT_IN(pointer, table, column##_y, row),                                 \
       AT_IN(pointer, table, column##_z, row))
#define AT_V3(table, column, row) AT_V3_IN(table, table, column, row)
#define AT_RGB_IN(pointer, table, column, row)                                                                         \
    rgb3(AT_IN(pointer, table, column##_r, row), AT_IN(pointer, table, column##_g, row),                               \
         AT_IN(pointer, table, column##_b, row))
#define AT_RGB(table, column, row) AT_RGB_IN(table, table, column, row)
#define SET_V3(table, column, row, value)                                                                              \
    AT(table, column##_x, row) = (value).x;                                                                            \
    AT(table, column##_y, row) = (value).y;                                                                            \
    AT(table, column##_z, row) = (value).z
#define SET_RGB(table, column, row, value)                                                                             \
    AT(table, column##_r, row) = (value).r;                                                                            \
    AT(table, column##_g, row) = (value).g;                                                                            \
    AT(table, column##_b, row) = (value).b
#define SET_RGB_IN(pointer, table, column, row, value)                                                                 \
    AT_IN(pointer, table, column##_r, row) = (value).r;                                                                \
    AT_IN(pointer, table, column##_g, row) = (value).g;                                                                \
    AT_IN(pointer, table, column##_b, row) = (value).b
#define SCALE_RGB(table, column, row, factor)                                                                          \
    AT(table, column##_r, row) *= (factor);                                                                            \
    AT(table, column##_g, row) *= (factor);                                                                            \
    AT(table, column##_b, row) *= (factor)
#define ADD_RGB(table, column, row, value)                                                                             \
    AT(table, column##_r, row) += (value).r;                                                                           \
    AT(table, column##_g, row) += (value).g;                                                                           \
    AT(table, column##_b, row) += (value).b

#endif
