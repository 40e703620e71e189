/* The tables of manifold walks (runtime/wavefront/manifold_walk.h): columns alone, for kernels/shared/tables.h.
 *
 * A chain has a fixed start y_b, `inner` vertices y_b+1 ... y_s-1 that are not rough, and an end y_s, which is to move
 * to its target. Where it starts at infinity the rays from there stay parallel, and y_b is where the chain's own
 * crosses a plane before the scene, across them. Vertex k = 0 ... inner - 1 of chain r is row k * chain_rows + r of the
 * tables of vertices. */
#ifndef GRADUS_SHARED_WALK_TABLES_H
#define GRADUS_SHARED_WALK_TABLES_H

#define chain_start_at_infinity R(-1)

/* What is asked: a chain a row. */
#define GRADUS_CHAIN_COLUMNS(REAL, UINT)                                                                               \
    REAL(chain, start_x, "y_b, which stays; world units, as all positions")                                            \
    REAL(chain, start_y, "")                                                                                           \
    REAL(chain, start_z, "")                                                                                           \
    REAL(chain, start_normal_x,                                                                                        \
         "geometric normal there, unit, either side; zero on no surface; at infinity direction")                       \
    REAL(chain, start_normal_y, "")                                                                                    \
    REAL(chain, start_normal_z, "")                                                                                    \
    REAL(chain, start_offset, "how far rays start off the surface there; 0 on none; or chain_start_at_infinity")       \
    REAL(chain, end_x, "y_s, where the chain ends now")                                                                \
    REAL(chain, end_y, "")                                                                                             \
    REAL(chain, end_z, "")                                                                                             \
    REAL(chain, end_normal_x, "geometric normal there, unit, either side")                                             \
    REAL(chain, end_normal_y, "")                                                                                      \
    REAL(chain, end_normal_z, "")                                                                                      \
    REAL(chain, target_x, "where it is to end")                                                                        \
    REAL(chain, target_y, "")                                                                                          \
    REAL(chain, target_z, "")                                                                                          \
    REAL(chain, target_normal_x, "geometric normal there, unit, either side")                                          \
    REAL(chain, target_normal_y, "")                                                                                   \
    REAL(chain, target_normal_z, "")                                                                                   \
    REAL(chain, target_offset, "how far rays start off the surface there")                                             \
    UINT(chain, inner, "vertices between start and end; 0: nothing is asked")

#define GRADUS_CHAIN_VERTEX_COLUMNS(REAL, UINT)                                                                        \
    REAL(chain_vertex, position_x, "")                                                                                 \
    REAL(chain_vertex, position_y, "")                                                                                 \
    REAL(chain_vertex, position_z, "")                                                                                 \
    UINT(chain_vertex, primitive, "which it lies on")                                                                  \
    UINT(chain_vertex, record, "only with TRAIT_BLENDS: of the material, of a blend that of the part that was met")

/* What is answered: a chain a row. */
#define GRADUS_WALKED_COLUMNS(REAL, UINT)                                                                              \
    UINT(walked, outcome, "one of GRADUS_WALK_OUTCOMES; what follows holds for walk_arrived alone")                    \
    UINT(walked, steps, "steps tried: those that were taken and those that were halved")                               \
    REAL(walked, base_spread, "|dy_s / d omega_b| of the chain as asked, all half vectors held: see chain_spread.h")   \
    REAL(walked, base_turn, "its product over glossy vertices of |d omega_o / d m|, 1 where all are specular")         \
    REAL(walked, spread, "the same of the new chain, at its target")                                                   \
    REAL(walked, turn, "")
/* Its vertices, as its rays meet them; wi is towards the vertex before. */
#define GRADUS_WALKED_VERTEX_COLUMNS(REAL, UINT)                                                                       \
    UINT(walked_vertex, primitive, "which it lies on")                                                                 \
    GRADUS_SURFACE_VERTEX_COLUMNS(walked_vertex, REAL, UINT)

/* From here on, what walks keep for themselves. What a vertex of the chain did, which its new one does too. */
#define GRADUS_CHAIN_EVENT_COLUMNS(REAL, UINT)                                                                         \
    REAL(chain_event, half_x, "microfacet normal in the vertex's own frame, on the normal's side; 0 where specular")   \
    REAL(chain_event, half_y, "")                                                                                      \
    UINT(chain_event, kind, "its BSDF kind with kind_is_rough, kind_is_dirac; and event_...")                          \
    UINT(chain_event, whole, "only with TRAIT_BLENDS: record of the whole material, which may be a blend")

/* A walk that goes on. Rows are dense, the longest chains first. Two of these tables alternate. */
#define GRADUS_WALK_COLUMNS(REAL, UINT)                                                                                \
    UINT(walk, chain, "whose row it is")                                                                               \
    UINT(walk, steps, "tried so far")                                                                                  \
    UINT(walk, outcome, "why the last step was not taken, or walk_unfinished")                                         \
    REAL(walk, first_x, "y_b+1 as it stands")                                                                          \
    REAL(walk, first_y, "")                                                                                            \
    REAL(walk, first_z, "")                                                                                            \
    REAL(walk, move_x, "of y_b+1 in its tangent plane: the whole step to the target")                                  \
    REAL(walk, move_y, "")                                                                                             \
    REAL(walk, move_z, "")                                                                                             \
    REAL(walk, share, "of that step, in (0, 1]")                                                                       \
    REAL(walk, miss, "square of the end's distance from the target; infinite before the first step")

/* The ray of each walk: as in `ray`. */
#define GRADUS_WALK_RAY_COLUMNS(REAL, UINT)                                                                            \
    REAL(walk_ray, origin_x, "moved off the surface, for the tracer")                                                  \
    REAL(walk_ray, origin_y, "")                                                                                       \
    REAL(walk_ray, origin_z, "")                                                                                       \
    REAL(walk_ray, direction_x, "unit vector")                                                                         \
    REAL(walk_ray, direction_y, "")                                                                                    \
    REAL(walk_ray, direction_z, "")                                                                                    \
    UINT(walk_ray, primitive, "as ray_primitive; ray_none once the step has failed")

/* What a ray knows of its neighbours, for two turns of the first direction (kernels/lib/ray_differential.h). */
#define GRADUS_WALK_BEAM_COLUMNS(REAL, UINT)                                                                           \
    REAL(walk_beam, from_x, "the vertex that the ray comes from, on its surface")                                      \
    REAL(walk_beam, from_y, "")                                                                                        \
    REAL(walk_beam, from_z, "")                                                                                        \
    REAL(walk_beam, turn, "product over glossy vertices of |d omega_o / d m|")                                         \
    UINT(walk_beam, outcome, "why the step fails, or walk_unfinished")                                                 \
    REAL(walk_beam, position_s_x, "change of `from` with the first turn")                                              \
    REAL(walk_beam, position_s_y, "")                                                                                  \
    REAL(walk_beam, position_s_z, "")                                                                                  \
    REAL(walk_beam, position_t_x, "with the second one")                                                               \
    REAL(walk_beam, position_t_y, "")                                                                                  \
    REAL(walk_beam, position_t_z, "")                                                                                  \
    REAL(walk_beam, direction_s_x, "change of the direction")                                                          \
    REAL(walk_beam, direction_s_y, "")                                                                                 \
    REAL(walk_beam, direction_s_z, "")                                                                                 \
    REAL(walk_beam, direction_t_x, "")                                                                                 \
    REAL(walk_beam, direction_t_y, "")                                                                                 \
    REAL(walk_beam, direction_t_z, "")                                                                                 \
    REAL(walk_beam, first_x, "the first vertex of this step")                                                          \
    REAL(walk_beam, first_y, "")                                                                                       \
    REAL(walk_beam, first_z, "")                                                                                       \
    REAL(walk_beam, first_s_x, "its changes")                                                                          \
    REAL(walk_beam, first_s_y, "")                                                                                     \
    REAL(walk_beam, first_s_z, "")                                                                                     \
    REAL(walk_beam, first_t_x, "")                                                                                     \
    REAL(walk_beam, first_t_y, "")                                                                                     \
    REAL(walk_beam, first_t_z, "")

/* The last segment of a chain that has arrived, from origin along direction to distance 1. */
#define GRADUS_WALK_LINK_COLUMNS(REAL, UINT)                                                                           \
    REAL(walk_link, origin_x, "")                                                                                      \
    REAL(walk_link, origin_y, "")                                                                                      \
    REAL(walk_link, origin_z, "")                                                                                      \
    REAL(walk_link, direction_x, "not normalised")                                                                     \
    REAL(walk_link, direction_y, "")                                                                                   \
    REAL(walk_link, direction_z, "")                                                                                   \
    UINT(walk_link, open, "before tracing: 1 asks for a trace, 0 does not; after: 1 if nothing is in between")

#define GRADUS_WALK_TABLES(TABLE)                                                                                      \
    TABLE(chain, GRADUS_CHAIN_COLUMNS)                                                                                 \
    TABLE(chain_vertex, GRADUS_CHAIN_VERTEX_COLUMNS)                                                                   \
    TABLE(walked, GRADUS_WALKED_COLUMNS)                                                                               \
    TABLE(walked_vertex, GRADUS_WALKED_VERTEX_COLUMNS)                                                                 \
    TABLE(chain_event, GRADUS_CHAIN_EVENT_COLUMNS)                                                                     \
    TABLE(walk, GRADUS_WALK_COLUMNS)                                                                                   \
    TABLE(walk_ray, GRADUS_WALK_RAY_COLUMNS)                                                                           \
    TABLE(walk_beam, GRADUS_WALK_BEAM_COLUMNS)                                                                         \
    TABLE(walk_link, GRADUS_WALK_LINK_COLUMNS)

/* Rows, by the names of kernels' arguments. */
#define ROWS_OF_chain chain_rows
#define ROWS_OF_chain_vertex chain_vertices
#define ROWS_OF_walked chain_rows
#define ROWS_OF_walked_vertex chain_vertices
#define ROWS_OF_chain_event chain_vertices
#define ROWS_OF_walk chain_rows
#define ROWS_OF_walk_ray chain_rows
#define ROWS_OF_walk_beam chain_rows
#define ROWS_OF_walk_link chain_rows

/* What chain_event_kind holds beside the kind. */
#define event_reflects 0x400u /* it mirrors; else it refracts, or lets pass */
#define event_behind 0x800u   /* it is met from behind its normal */
#define event_unknown 0x1000u /* its half vector is not known */
#define event_kind_mask 0x3FFu

/* What becomes of a walk. OUTCOME(name, what is said of it). Where the steps run out, it is why the last one was not
 * taken. */
#define GRADUS_WALK_OUTCOMES(OUTCOME)                                                                                  \
    OUTCOME(none, "nothing was asked")                                                                                 \
    OUTCOME(arrived, "ends at its target")                                                                             \
    OUTCOME(unfinished, "the steps ran out while it still came nearer")                                                \
    OUTCOME(diverged, "a step led no nearer")                                                                          \
    OUTCOME(nothing, "a ray met nothing, or its last one not the plane")                                               \
    OUTCOME(kinds, "a ray met another BSDF kind")                                                                      \
    OUTCOME(event, "no direction has this half vector: total reflection, another side, grazing")                       \
    OUTCOME(base, "the chain as asked cannot be followed, or has no derivative")                                       \
    OUTCOME(hidden, "the last segment is blocked")                                                                     \
    OUTCOME(back, "the walk back does not come back")

#endif
