/* What paths from the camera draw, of a dimension: by their key, or with TRAIT_STRATIFIED evenly over the samples of a
 * pixel, where the first word of the key is the pixel's and the second one the sample's number. */
#ifndef GRADUS_LIB_PATH_DRAW_H
#define GRADUS_LIB_PATH_DRAW_H
//! traits: TRAIT_STRATIFIED
#include "kernels/lib/stratified.h"

#if TRAIT_STRATIFIED
#define PATH_DRAW(key_0, key_1, dimension) stratified_draw(key_0, key_1, dimension)
#else
#define PATH_DRAW(key_0, key_1, dimension) random_draw(key_0, key_1, dimension)
#endif

#endif
