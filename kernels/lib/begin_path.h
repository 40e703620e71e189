/* How a path begins. */
#ifndef GRADUS_LIB_BEGIN_PATH_H
#define GRADUS_LIB_BEGIN_PATH_H
//! traits: TRAIT_REFRACTION
#include "kernels/shared/stage.h"

/* A path that has not met anything yet: its row of `path`. */
#if TRAIT_REFRACTION
#define BEGIN_ETA(row) AT(path, eta, row) = R(1);
#else
#define BEGIN_ETA(row)
#endif
#define BEGIN_PATH(row, path_slot, word_0, word_1)                                                                     \
    AT_UINT(path, slot, row) = path_slot;                                                                              \
    AT_UINT(path, key_0, row) = word_0;                                                                                \
    AT_UINT(path, key_1, row) = word_1;                                                                                \
    AT_UINT(path, depth, row) = 0u;                                                                                    \
    SET_RGB(path, throughput, row, rgb_gray(R(1)));                                                                    \
    AT(path, pdf, row) = R(0);                                                                                         \
    BEGIN_ETA(row)

#endif
