/* The specular and glossy vertices that a photon came by: its light path back to the first vertex that keeps photons.
 */
#ifndef GRADUS_LIB_PHOTON_CHAIN_H
#define GRADUS_LIB_PHOTON_CHAIN_H
#include "kernels/shared/light_vertex.h"

typedef struct {
    uint start; /* record of the vertex that stays */
    uint inner; /* how many there are; 0 where there are too many, or a material that scatters as well mirrored */
    GRADUS_NOT_IN_REGISTERS
} photon_chain;

/* last: the record of a photon's last vertex. `chain_bin`: what leaving_bin has for materials that chains go over. */
GRADUS_FN photon_chain photon_chain_of(GRADUS_GLOBAL const uint *light_vertex_marks,
                                       GRADUS_GLOBAL const uint *leaving_bin, uint chain_bin, uint most, uint unit,
                                       uint last) {
    photon_chain chain;
    chain.start = last;
    chain.inner = 0u;
    uint found = 0u;
    for (uint k = 0; k <= most; ++k) {
        const uint material = FIELD_OF(light_vertex_mark, light_vertex_marks, chain.start, material);
        const int is_of_chain = !light_vertex_is_light(material) &&
                                leaving_bin[light_vertex_is_light(material) ? 0u : material] == chain_bin;
        if (!is_of_chain) {
            chain.inner = LIGHT_VERTEX_MIRRORS(chain.start) ? 0u : found;
            break;
        }
        ++found;
        chain.start = FIELD_OF(light_vertex_mark, light_vertex_marks, chain.start, before);
    }
    return chain;
}

#endif
