/* shade: the surface that each path met, of one BSDF kind: next-event estimation, and the direction in which the path
 * goes on. Paths at places `first` on of `index` take rows `to` on of `path`, `ray` and `shadow`.
 *
 * The partition has brought the rows of a kind together, so the BSDF is inlined: its value towards the light point and
 * its sample cost no queue. Whoever stands elsewhere asks the service, `evaluate`.
 *
 * A path ends where the sample fails, its throughput is zero, it is as long as it may be, or Russian roulette says so.
 *
 * WITH_OFFSETS: the paths have offset paths that are not connected with them. Then the light sample is not weighted
 * yet, no roulette is played, black paths go on since their offset paths may not be black, and what these need to know
 * of the vertex is left in `vertex` and `event`. */
#include "kernels/lib/textured_material.h"

/* Where something is textured, the stage `material` has left the parameters in `surface`. */
#define MATERIAL_PARAMETERS SURFACE_ARGUMENT
#define BITS_OF_MATERIAL 0u
#define MATERIAL_AT(point, primitive, hit) HIT_MATERIAL((point).material, capacity, old)

#include "kernels/stages/shade_vertex.h"
