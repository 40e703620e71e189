/* Keeps PoCL's vectoriser on the work-items.
 *
 * LLVM packs like expressions of one work-item (the three channels of a Fresnel term, say) into short vectors before
 * it vectorises over work-items, and then no longer can: measured on PoCL 3.1, conductors ran ten times slower. It
 * cannot pack two expressions of which one depends on the other. */
#ifndef GRADUS_LIB_ORDERED_H
#define GRADUS_LIB_ORDERED_H
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* x itself, computed after y, which must be finite. Adding 0 y cannot be folded away: y might be infinite. */
GRADUS_FN real r_after(real x, real y) { return x + R(0) * y; }

/* n itself, computed after x, which must be finite: whole numbers and indices into one array are packed too. */
GRADUS_FN uint uint_after(uint n, real x) { return n + (uint)(int)(R(0) * x); }

/* v itself, computed after y, which must be finite. */
GRADUS_FN vec3 v3_after(vec3 v, real y) { return v3(r_after(v.x, y), r_after(v.y, y), r_after(v.z, y)); }

/* v itself, its components computed one after the other. */
GRADUS_FN vec3 v3_ordered(vec3 v) {
    v.y = r_after(v.y, v.x);
    v.z = r_after(v.z, v.y);
    return v;
}

GRADUS_LIB_END
#endif
