/* Random numbers from counters: a hash of (seed, pixel, sample) gives each path a key, a hash of (key, dimension)
 * gives its numbers. No state is kept, so neither batches nor threads can change a number.
 *
 * The hash is PCG4D of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020. */
#ifndef GRADUS_LIB_RANDOM_H
#define GRADUS_LIB_RANDOM_H
#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

typedef struct {
    uint x, y, z, w;
    GRADUS_NOT_IN_REGISTERS
} random_bits;

GRADUS_FN random_bits random_hash(uint x, uint y, uint z, uint w) {
    random_bits v;
    v.x = x * 1664525u + 1013904223u;
    v.y = y * 1664525u + 1013904223u;
    v.z = z * 1664525u + 1013904223u;
    v.w = w * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v.x ^= v.x >> 16;
    v.y ^= v.y >> 16;
    v.z ^= v.z >> 16;
    v.w ^= v.w >> 16;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

/* The key of a path: its first two words. The sample counter has 64 bits, the pixel 32, the seed 64. */
GRADUS_FN random_bits random_key(uint seed_low, uint seed_high, uint pixel, uint sample_low, uint sample_high) {
    const random_bits outer = random_hash(seed_low, seed_high, sample_high, 0x67726164u);
    return random_hash(outer.x ^ pixel, outer.y ^ sample_low, outer.z, outer.w);
}

/* Four independent numbers in [0, 1): multiples of 2^-24, which float holds exactly. */
typedef struct {
    real a, b, c, d;
    GRADUS_NOT_IN_REGISTERS
} random4;

GRADUS_FN real random_unit(uint bits) { return (real)(bits >> 8) * R(1.0 / 16777216.0); }

GRADUS_FN random4 random_draw(uint key_0, uint key_1, uint dimension) {
    const random_bits bits = random_hash(key_0, key_1, dimension, 0x73757321u);
    random4 u;
    u.a = random_unit(bits.x);
    u.b = random_unit(bits.y);
    u.c = random_unit(bits.z);
    u.d = random_unit(bits.w);
    return u;
}

/* Light paths are numbered as samples of this pixel, which is none. */
#define random_pixel_of_lights 0xFFFFFFFEu

/* Dimensions of a path: the camera draws once, then each vertex twice. A light path connects to no light, so what
 * connections would draw at its first vertex is free for its beginning. */
#define random_dimension_camera 0u
#define random_dimension_emission 0u
#define random_dimension_leaving 1u
#define random_dimension_light(depth) (1u + 2u * (depth))
#define random_dimension_scatter(depth) (2u + 2u * (depth))
/* Which part of a blend a path meets at a vertex: far from the others, and not by the highest bits alone, which the
 * hash does not spread. */
#define random_dimension_blend(depth) (0x2545F491u + (depth))
/* Which of the normals that a map may have a light path takes. */
#define random_dimension_normal(depth) (0x6A09E667u + (depth))

GRADUS_LIB_END
#endif
