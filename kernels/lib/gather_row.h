/* In which rows the gather points lie whose photons are sought: one after the other or, with GATHER_INDEXED, as
 * `gather_index` says. */
#ifndef GRADUS_LIB_GATHER_ROW_H
#define GRADUS_LIB_GATHER_ROW_H

#if GATHER_INDEXED
#define GATHER_INDEX , __global const uint *gather_index
#define GATHER_ROW(place) gather_index[place]
#else
#define GATHER_INDEX
#define GATHER_ROW(place) (place)
#endif

#endif
