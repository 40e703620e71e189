/* In which rows the gather points lie whose photons are sought: one after the other or, with GATHER_INDEXED, as
 * `gather_index` says; and where in the list their pairs are. */
#ifndef GRADUS_LIB_GATHER_ROW_H
#define GRADUS_LIB_GATHER_ROW_H

#if GATHER_INDEXED
#define GATHER_INDEX , __global const uint *gather_index
#define GATHER_ROW(place) gather_index[place]
#else
#define GATHER_INDEX
#define GATHER_ROW(place) (place)
#endif

/* The pairs of the gather point at `place`: places in the list, from `begin` on; and of them those in the window
 * [window_first, window_first + window_pairs), from `low` up to `high`. */
#define PAIRS_IN_WINDOW(place)                                                                                         \
    const uint begin = pair_chunk_first[(place) / PAIR_CHUNK] + pair_offset[place];                                    \
    const uint low = max(begin, window_first);                                                                         \
    const uint high = min(begin + pair_count[place], window_first + window_pairs);

#endif
