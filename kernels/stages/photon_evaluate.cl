/* photon_evaluate: what pairs of a gather point of one BSDF kind and a photon are worth: f power, f without its
 * cosine. */
#include "kernels/lib/photon_value.h"
#include "kernels/lib/textured_material.h"

STAGE photon_evaluate(uint count, uint unit, uint gather_rows, uint photon_rows, uint pair_rows,
                      __global const uint *pair_gather, __global const uint *pair_photon, __global const real *gather,
                      __global const real *photon_sorted, __global const real *materials, __global real *pair_value) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const int row = (int)pair_gather[i], from = (int)pair_photon[i];
    const material m = VERTEX_MATERIAL(gather, row);
    const rgb value = PHOTON_VALUE(row, m, AT_V3(photon_sorted, wi, from), AT_V3(photon_sorted, normal, from),
                                   AT_RGB(photon_sorted, power, from));
    SET_RGB(pair_value, value, i, value);
}
