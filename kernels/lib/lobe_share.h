/* How often a path takes the glossy one of two lobes. */
#ifndef GRADUS_LIB_LOBE_SHARE_H
#define GRADUS_LIB_LOBE_SHARE_H
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* The glossy lobe's part of all that both reflect, at this very point. */
GRADUS_FN real lobe_share(rgb glossy, rgb diffuse) {
    const real of_glossy = glossy.r + glossy.g + glossy.b, of_diffuse = diffuse.r + diffuse.g + diffuse.b;
    return of_glossy / r_max(of_glossy + of_diffuse, R(1e-20));
}

GRADUS_LIB_END
#endif
