/* runs: where equal keys lie side by side in a table of sorted ones, and sums over the rows of each such run. Leaves
 * `run_key`, `run_begin` and `run_end` of each run, in ascending order, and how many there are in `run_count`.
 *
 * As in the partition, each work-item of runs_count and runs_list has a chunk of `chunk_rows` of the `rows` rows. */
#include "kernels/lib/compensated.h"
#include "kernels/shared/stage.h"

#define IS_FIRST(i) ((i) == 0u || sort_key[(i)-1u] != sort_key[i])

/* How many runs begin in each chunk. */
STAGE runs_count(uint count, uint rows, uint chunk_rows, __global const uint *sort_key, __global uint *run_place) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * chunk_rows;
    const uint end = min(begin + chunk_rows, rows);
    uint found = 0;
    for (uint i = begin; i < end; ++i)
        found += IS_FIRST(i) ? 1u : 0u;
    run_place[chunk] = found;
}

STAGE runs_scan(uint count, uint chunks, __global uint *run_place, __global uint *run_count) {
    if (work_item() >= count)
        return;
    uint sum = 0;
    for (uint chunk = 0; chunk < chunks; ++chunk) {
        const uint found = run_place[chunk];
        run_place[chunk] = sum;
        sum += found;
    }
    run_count[0] = sum;
}

/* Who finds where a run begins knows where the one before has ended. */
STAGE runs_list(uint count, uint rows, uint chunk_rows, __global const uint *sort_key, __global const uint *run_place,
                __global uint *run_key, __global uint *run_begin, __global uint *run_end) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * chunk_rows;
    const uint end = min(begin + chunk_rows, rows);
    uint run = run_place[chunk];
    for (uint i = begin; i < end; ++i)
        if (IS_FIRST(i)) {
            if (run > 0)
                run_end[run - 1u] = i;
            run_key[run] = sort_key[i];
            run_begin[run] = i;
            ++run;
        }
    if (end == rows)
        run_end[run - 1u] = rows;
}

/* Column `first_column` + p of `run_value`, p being the plane, summed over each run in the order of its rows. */
STAGE runs_sum(uint count, uint sum_rows, uint value_rows, uint first_column, __global const uint *sort_index,
               __global const uint *run_begin, __global const uint *run_end, __global const uint *run_count,
               __global const real *run_value, __global real *run_sum) {
    const size_t run = work_item();
    if (run >= count || run >= run_count[0])
        return;
    const size_t column = get_global_id(2);
    __global const real *value = run_value + (first_column + column) * value_rows;
    compensated s;
    s.sum = R(0);
    s.correction = R(0);
    for (uint i = run_begin[run]; i < run_end[run]; ++i)
        s = compensated_add(s, value[sort_index[i]]);
    run_sum[column * sum_rows + run] = s.sum + s.correction;
}
