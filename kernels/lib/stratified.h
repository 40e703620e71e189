/* Random numbers of the samples of a pixel that fill their range evenly, whenever one stops: Sobol's first two
 * dimensions (Sobol 1967), scrambled as Owen does (Owen 1995), by hashes (Laine and Karras 2011; Burley 2020).
 *
 * The samples 0 to 2^m - 1 of a pixel have one number in each interval of length 2^-m, and a pair of them one point in
 * each of the elementary rectangles of that area (Owen's (0, m, 2)-nets); each number alone is uniform, and pixels,
 * dimensions and the pairs of one draw are independent of each other, by which they are scrambled and by the order in
 * which they go through the sequence. So a mean of n samples is unbiased, and its variance falls faster than 1 / n
 * where what is sampled is not all noise: an edge in a pixel, reflection or refraction, a point of a light. */
#ifndef GRADUS_LIB_STRATIFIED_H
#define GRADUS_LIB_STRATIFIED_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/random.h"

GRADUS_LIB_BEGIN

/* PoCL's compiler is clang, whose function for it takes a quarter of the instructions on AVX-512; others that begin
 * with clang need not know what it becomes. */
GRADUS_FN uint reversed_bits(uint x) {
#ifdef GRADUS_OF_POCL
    return __builtin_bitreverse32(x);
#else
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0F0F0F0Fu) | ((x & 0x0F0F0F0Fu) << 4);
    x = ((x >> 8) & 0x00FF00FFu) | ((x & 0x00FF00FFu) << 8);
    return (x >> 16) | (x << 16);
#endif
}

/* A permutation in which a bit is turned over as those below it and the seed say, and by no others: addition and
 * multiplication carry upwards only. The even multipliers are digits of pi, made to be 2 modulo 4 so that each bit
 * matters to the next. With the bits reversed it is Owen's scrambling. */
GRADUS_FN uint turned_by_lower_bits(uint x, uint seed) {
    x += seed;
    x ^= x * 0x243F6A8Au;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x85A308D2u;
    x += seed * 0x13198A2Fu;
    x ^= x * 0x03707346u;
    return x;
}

/* Sobol's second dimension of a number: sum over k of binomial(k, j) bit k modulo 2 for bit j (Pascal's matrix, Lucas'
 * theorem), from the lowest on; as the first one is, these are digits from the point on. */
GRADUS_FN uint sobol_second(uint number) {
    number ^= (number >> 1) & 0x55555555u;
    number ^= (number >> 2) & 0x33333333u;
    number ^= (number >> 4) & 0x0F0F0F0Fu;
    number ^= (number >> 8) & 0x00FF00FFu;
    return number ^ (number >> 16);
}

/* The draw of sample `number` of a pixel: pairs (a, b) and (c, d). `key`: a hash of pixel and seed. */
GRADUS_FN random4 stratified_draw(uint key, uint number, uint dimension) {
    const uint reversed = reversed_bits(number);
    const random_bits first = random_hash(key, dimension, 0u, 0x73747261u);
    const random_bits second = random_hash(first.w, dimension, 1u, 0x73747261u);
    /* In which order: scrambled numbers of samples, so that 2^m of them are others of the sequence that form a net. */
    const uint in_first = reversed_bits(turned_by_lower_bits(reversed, first.x));
    random4 u;
    u.a = random_unit(reversed_bits(turned_by_lower_bits(in_first, first.y)));
    u.b = random_unit(reversed_bits(turned_by_lower_bits(sobol_second(uint_after(in_first, u.a)), first.z)));
    const uint in_second = reversed_bits(turned_by_lower_bits(uint_after(reversed, u.b), second.x));
    u.c = random_unit(reversed_bits(turned_by_lower_bits(in_second, second.y)));
    u.d = random_unit(reversed_bits(turned_by_lower_bits(sobol_second(uint_after(in_second, u.c)), second.z)));
    return u;
}

GRADUS_LIB_END
#endif
