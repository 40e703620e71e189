#include "runtime/wavefront/splats.h"

#include "kernels/shared/tables.h"

namespace gradus {

using namespace lib_float;

Splats::Splats(Session &session, Stages &stages, RowsOf rows_of, std::uint32_t multiple, Order order)
    : session_(session), rows_of_(rows_of), multiple_(multiple), order_(order),
      sort_(session, stages, "splat_sorted", rows_of, multiple),
      splat_(stages.add({.name = "splat", .strict = true, .numbers = {"splat_rows"}})) {}

TableList Splats::tables() const {
    TableList list = sort_.tables();
    list.push_back({.name = "splat", .rows = rows_of_, .multiple = multiple_, .columns = splat_columns});
    list.push_back({.name = "splat_pixel", .rows = rows_of_, .multiple = multiple_, .is_uint = true});
    list.push_back({.name = "splat_path",
                    .rows = rows_of_,
                    .multiple = multiple_,
                    .columns = order_ == Order::paths ? 1u : 0u,
                    .is_uint = true});
    list.push_back({.name = "splat_film", .rows = RowsOf::pixel, .columns = film_columns, .is_cleared = true});
    return list;
}

void Splats::attach(Tables &tables) {
    tables_ = &tables;
    sort_.attach(tables);
}

void Splats::add(std::uint32_t count, std::uint32_t highest_path) {
    const std::uint32_t last_pixel = session_.pixels() - 1;
    if (order_ == Order::paths) {
        sort_.run((*tables_)["splat_path"], count, highest_path);
        sort_.again((*tables_)["splat_pixel"], count, last_pixel);
    } else {
        sort_.run((*tables_)["splat_pixel"], count, last_pixel);
    }
    splat_.run(count, {{"splat_rows", static_cast<std::uint32_t>(tables_->rows().of(rows_of_)) * multiple_}});
}

} // namespace gradus
