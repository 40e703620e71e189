/* The weight that a sample has of a pixel filter with negative lobes: WEIGHTED(x) after FILTER_WEIGHT(slot). */
#ifndef GRADUS_LIB_FILTER_WEIGHT_H
#define GRADUS_LIB_FILTER_WEIGHT_H
//! traits: TRAIT_FILTER_SIGNED

#if TRAIT_FILTER_SIGNED
#define FILTER_WEIGHT(slot) const real filter_weight = AT(filtered, weight, slot);
#define WEIGHTED(x) ((x)*filter_weight)
#else
#define FILTER_WEIGHT(slot)
#define WEIGHTED(x) (x)
#endif

#endif
