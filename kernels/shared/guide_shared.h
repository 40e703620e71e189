/* Sizes that the kernels of guide images and their host code agree on (solver/guide). */
#ifndef GRADUS_SHARED_GUIDE_SHARED_H
#define GRADUS_SHARED_GUIDE_SHARED_H

/* The feature filter looks so far in all four directions. */
#define GUIDE_RADIUS 4
#define GUIDE_WINDOW (2 * GUIDE_RADIUS + 1)

/* Planes of the caller's features: albedo, normal, depth. */
#define GUIDE_FEATURES 7

/* Planes of the images of both halves: the first's, the second's, their mean. */
#define GUIDE_FIRST 0
#define GUIDE_SECOND 3
#define GUIDE_MEAN 6
#define GUIDE_IMAGES 9

/* Planes that are smoothed for the filter: the variance of the mean by channel, its squared brightness, and whether
 * the pixel counts. */
#define GUIDE_VARIANCE 0
#define GUIDE_BRIGHTNESS 3
#define GUIDE_VALID 4
#define GUIDE_STATISTICS 5
/* Instead of the last two: how much a pixel's value is trusted. */
#define GUIDE_TRUST 3

/* Planes of weighted sums: of the first half, of the second, of the weights. */
#define GUIDE_WEIGHT 6
#define GUIDE_SUMS 7

/* Planes by which a guide is judged: what following it takes off, what it adds and the square of that; and whether the
 * pixel counts. */
#define GUIDE_GAIN 0
#define GUIDE_LOSS 1
#define GUIDE_SQUARE 2
#define GUIDE_MOMENTS 3
/* Planes of shares: weighted by whether the pixel counts, and that. */
#define GUIDE_SHARE 0
#define GUIDE_COUNTS 1
#define GUIDE_SHARES 2

/* Planes of what the image has lost: three channels, and the brightness that it is relative to. */
#define GUIDE_BRIGHT 3
#define GUIDE_LOST 4

#endif
