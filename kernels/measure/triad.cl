/* The triad of McCalpin's STREAM, against which the other kernels' memory traffic is measured. */
#include "kernels/shared/stage.h"

STAGE triad(uint count, __global const real *b, __global const real *c, __global real *a) {
    const size_t i = work_item();
    if (i >= count)
        return;
    a[i] = b[i] + R(3) * c[i];
}
