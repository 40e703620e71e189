#include "bench/kernels/table_layout.h"

#include "kernels/shared/tables.h"

#include <map>

namespace gradus::bench {

namespace {

#define GRADUS_BENCH_REAL(table, column, text) false,
#define GRADUS_BENCH_UINT(table, column, text) true,
#define GRADUS_BENCH_COLUMNS(list)                                                                                     \
    { list(GRADUS_BENCH_REAL, GRADUS_BENCH_UINT) }

const std::map<std::string, TableLayout> layouts = {
    {"ray", {"capacity", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_RAY_COLUMNS)}},
    {"shadow", {"capacity", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_SHADOW_COLUMNS)}},
    {"vertex", {"capacity", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_VERTEX_COLUMNS)}},
    {"vertex_old", {"capacity", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_VERTEX_COLUMNS)}},
    {"tangent", {"capacity", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_TANGENT_COLUMNS)}},
    {"radiance", {"slots", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_RADIANCE_COLUMNS)}},
    {"direct", {"slots", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_RADIANCE_COLUMNS)}},
    {"feature", {"slots", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_FEATURE_COLUMNS)}},
    {"film", {"pixels", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_FILM_COLUMNS)}},
    {"feature_film", {"pixels", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_FEATURE_FILM_COLUMNS)}},
    {"primary", {"slots", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_PRIMARY_COLUMNS)}},
    {"shifted", {"capacity", 4, 4, GRADUS_BENCH_COLUMNS(GRADUS_SHIFTED_COLUMNS)}},
    {"shifted_old", {"capacity", 4, 4, GRADUS_BENCH_COLUMNS(GRADUS_SHIFTED_COLUMNS)}},
    {"offset_vertex", {"capacity", 4, 4, GRADUS_BENCH_COLUMNS(GRADUS_OFFSET_VERTEX_COLUMNS)}},
    {"offset_ray", {"capacity", 4, 4, GRADUS_BENCH_COLUMNS(GRADUS_OFFSET_RAY_COLUMNS)}},
    {"gain", {"capacity", 4, 4, GRADUS_BENCH_COLUMNS(GRADUS_GAIN_COLUMNS)}},
    {"link", {"capacity", 8, 4, GRADUS_BENCH_COLUMNS(GRADUS_LINK_COLUMNS)}},
    {"prefix", {"slots", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_PREFIX_COLUMNS)}},
    {"difference", {"slots", 4, 4, GRADUS_BENCH_COLUMNS(GRADUS_DIFFERENCE_COLUMNS)}},
    {"gradient_film", {"pixels", 1, 1, GRADUS_BENCH_COLUMNS(GRADUS_GRADIENT_FILM_COLUMNS)}},
};

} // namespace

const TableLayout *table_layout(const std::string &argument) {
    const auto found = layouts.find(argument);
    return found == layouts.end() ? nullptr : &found->second;
}

} // namespace gradus::bench
