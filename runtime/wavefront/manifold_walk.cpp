#include "runtime/wavefront/manifold_walk.h"

#include "kernels/shared/tables.h"
#include "runtime/wavefront/segments.h"

#include <array>
#include <stdexcept>

namespace gradus {

using namespace lib_float;

namespace {

/// What rounding does to the positions that a walk computes, over what it does to those that rays have met
/// (kernels/lib/ray_start.h).
constexpr double rounding_in_float = 1, rounding_in_double = 0x1p-29;

const std::vector<std::string> chain_numbers = {"chain_rows", "chain_vertices"};

std::vector<std::string> numbers_and(std::vector<std::string> more) {
    more.insert(more.end(), chain_numbers.begin(), chain_numbers.end());
    return more;
}

StageDeclaration walk_stage(const std::string &name, const char *file, const char *entry,
                            std::vector<std::string> numbers,
                            std::vector<std::pair<std::string, std::string>> tables = {}) {
    return {.name = "walk " + name,
            .file = file,
            .entry = entry,
            .numbers = numbers_and(std::move(numbers)),
            .tables = std::move(tables)};
}

StageDeclaration follow_stage(bool lands) {
    std::vector<std::string> numbers = {"first_row", "k", "replays"};
    if (lands)
        numbers.insert(numbers.end(), {"most_vertices", "most_steps"});
    StageDeclaration stage =
        walk_stage(lands ? "land" : "follow", "walk_follow", lands ? "walk_land" : "walk_follow", std::move(numbers));
    stage.definitions = {{"LANDS", lands ? "1" : "0"}};
    return stage;
}

StageDeclaration back_stage(const char *name, const char *entry, const WalkSettings &settings) {
    StageDeclaration stage = walk_stage(name, "walk_back", entry, {});
    stage.is_wanted = settings.comes_back;
    return stage;
}

} // namespace

/// The tables of the walk there, or of the walk back.
struct ManifoldWalk::Side {
    const char *chain, *vertex, *walked, *walked_vertex;
};

ManifoldWalk::ManifoldWalk(Session &session, Stages &stages, const WalkSettings &settings)
    : session_(session), settings_(settings),
      events_(stages.add(walk_stage("events", "walk_events", "walk_events", {}))),
      queue_(stages.add(walk_stage("queue", "walk_queue", "walk_queue", {"most_vertices"}))),
      aim_(stages.add(walk_stage("aim", "walk_aim", "walk_aim", {}, {{"walk_old", "walk_next"}}))),
      follow_(stages.add(follow_stage(false))), land_(stages.add(follow_stage(true))),
      partition_(session, stages, "walk partition", "walk_"),
      link_(stages.add(walk_stage("link", "walk_link", "walk_link", {}))),
      seen_(stages.add(walk_stage("seen", "walk_link", "walk_seen", {}))),
      turn_(stages.add(back_stage("turn", "walk_turn", settings))),
      turn_vertices_(stages.add(back_stage("turn vertices", "walk_turn_vertices", settings))),
      return_(stages.add(back_stage("return", "walk_return", settings))),
      count_(stages.add(walk_stage("count", "walk_count", "walk_count", {"rows"}))) {
    if (settings.most_vertices == 0 || settings.most_vertices > partition_chunk)
        throw std::logic_error("chains of walks have between 1 and 256 vertices");
    session.reals["walk_tolerance"] = settings.tolerance;
    session.reals["walk_back_tolerance"] = settings.back_tolerance;
    session.reals["walk_rounding"] =
        session.options.precision == Precision::double_ ? rounding_in_double : rounding_in_float;
#define GRADUS_OUTCOME_COUNT(name, text) counts_[#name] = 0;
    GRADUS_WALK_OUTCOMES(GRADUS_OUTCOME_COUNT)
#undef GRADUS_OUTCOME_COUNT
    counts_.erase("none");
    counts_["steps"] = 0;
}

TableList ManifoldWalk::tables() const {
    const std::uint32_t not_needed = session_.vertex_columns_not_needed();
    const auto of = [&](const char *name, std::uint32_t columns, std::uint32_t vertices = 1) -> TableDeclaration {
        return {.name = name, .rows = RowsOf::chain, .multiple = vertices, .columns = columns, .is_cleared = true};
    };
    const auto of_uints = [&](const char *name) -> TableDeclaration {
        return {.name = name, .rows = RowsOf::chain, .is_uint = true};
    };
    const std::uint32_t most = settings_.most_vertices;
    TableList list = {of("chain", chain_columns),
                      of("chain_vertex", chain_vertex_columns, most),
                      of("chain_event", chain_event_columns, most),
                      of("walked", walked_columns),
                      of("walked_vertex", walked_vertex_columns - not_needed, most),
                      of("walk", walk_columns),
                      of("walk_next", walk_columns),
                      of("walk_ray", walk_ray_columns),
                      of("walk_beam", walk_beam_columns),
                      of("walk_link", walk_link_columns)};
    if (settings_.comes_back)
        for (const TableDeclaration &table :
             {of("back_chain", chain_columns), of("back_chain_vertex", chain_vertex_columns, most),
              of("back_walked", walked_columns), of("back_walked_vertex", walked_vertex_columns - not_needed, most)})
            list.push_back(table);
    for (const char *name : {"walk_bin", "walk_index"})
        list.push_back(of_uints(name));
    // Enough, and cleared for oclgrind, which takes some of it for never written.
    list.push_back(
        {.name = "walk_chunk_offset", .rows = RowsOf::chain, .columns = most, .is_uint = true, .is_cleared = true});
    const TableList of_partition = partition_.tables(most);
    list.insert(list.end(), of_partition.begin(), of_partition.end());
    list.push_back({.name = "walk_found", .rows = RowsOf::one, .columns = walk_outcomes + 1, .is_uint = true});
    return list;
}

void ManifoldWalk::attach(Tables &tables) {
    tables_ = &tables;
    partition_.attach(tables);
    chain_rows_ = tables.rows().chains;
}

void ManifoldWalk::run(std::uint32_t count) {
    if (count > chain_rows_)
        throw std::logic_error("more chains than walks have room for");
    if (count == 0)
        return;
    const LaunchNumbers rows = {{"chain_rows", chain_rows_}, {"chain_vertices", chain_vertices()}};
    walk({"chain", "chain_vertex", "walked", "walked_vertex"}, count);
    link_.run(count, rows);
    const TraceCounts traced = session_.segments.trace(
        {}, {&(*tables_)["walk_link"], chain_rows_, count, walk_link_origin_x, walk_link_direction_x, walk_link_open});
    session_.rays["walk"] += traced.shadow;
    seen_.run(count, rows);
    if (settings_.comes_back) {
        turn_.run(count, rows);
        turn_vertices_.run_planes(0, count, settings_.most_vertices, rows);
        walk({"back_chain", "back_chain_vertex", "back_walked", "back_walked_vertex"}, count);
        return_.run(count, rows);
    }
    add_counts(count);
}

void ManifoldWalk::add_counts(std::uint32_t count) {
    count_.run(walk_outcomes + 1, {{"rows", count}, {"chain_rows", chain_rows_}});
    std::array<std::uint32_t, walk_outcomes + 1> found{};
    (*tables_)["walk_found"].read(found.data(), sizeof found);
#define GRADUS_OUTCOME_COUNT(name, text)                                                                               \
    if (walk_##name != walk_none)                                                                                      \
        counts_[#name] += found[walk_##name];
    GRADUS_WALK_OUTCOMES(GRADUS_OUTCOME_COUNT)
#undef GRADUS_OUTCOME_COUNT
    counts_["steps"] += found[walk_outcomes];
}

void ManifoldWalk::bind(const Side &side) {
    for (Stage *stage : {&events_, &queue_, &aim_, &follow_, &land_}) {
        stage->bind("chain", (*tables_)[side.chain]);
        stage->bind("chain_vertex", (*tables_)[side.vertex]);
        stage->bind("walked", (*tables_)[side.walked]);
        stage->bind("walked_vertex", (*tables_)[side.walked_vertex]);
    }
}

/// Walks of one direction: their answers are in side.walked and side.walked_vertex.
void ManifoldWalk::walk(const Side &side, std::uint32_t count) {
    const std::uint32_t most = settings_.most_vertices;
    bind(side);
    const Buffer *newest = &(*tables_)["walk"], *oldest = &(*tables_)["walk_next"];
    events_.run_planes(0, count, most, {{"chain_rows", chain_rows_}, {"chain_vertices", chain_vertices()}});
    queue_.bind("walk", *newest);
    queue_.run(count, {{"chain_rows", chain_rows_}, {"chain_vertices", chain_vertices()}, {"most_vertices", most}});
    std::vector<std::uint32_t> longer = sort(count);
    // The step of number 0 follows the chain as it is, on the primitives that it lies on.
    for (std::uint32_t step = 0; step <= settings_.steps && longer[0] > 0; ++step) {
        std::swap(newest, oldest);
        aim_.bind("walk", *newest);
        aim_.bind("walk_old", *oldest);
        follow_.bind("walk", *newest);
        land_.bind("walk", *newest);
        aim_.run(longer[0], {{"chain_rows", chain_rows_}});
        for (std::uint32_t k = 0; k < most && longer[k] > 0; ++k) {
            if (step > 0)
                trace(longer[k]);
            follow_.run(longer[k + 1], {{"first_row", 0},
                                        {"k", k},
                                        {"replays", step == 0},
                                        {"chain_rows", chain_rows_},
                                        {"chain_vertices", chain_vertices()}});
            land_.run(longer[k] - longer[k + 1], {{"first_row", longer[k + 1]},
                                                  {"k", k},
                                                  {"replays", step == 0},
                                                  {"most_vertices", most},
                                                  {"most_steps", settings_.steps},
                                                  {"chain_rows", chain_rows_},
                                                  {"chain_vertices", chain_vertices()}});
        }
        longer = sort(longer[0]);
    }
}

/// Sorts the walks that go on: `longer[k]` of them have chains of more than k vertices, and those come first.
std::vector<std::uint32_t> ManifoldWalk::sort(std::uint32_t rows) {
    const std::vector<std::uint32_t> ranges = partition_.run(rows, settings_.most_vertices);
    return {ranges.rbegin(), ranges.rend()};
}

void ManifoldWalk::trace(std::uint32_t rows) {
    session_.ask_to_go_on();
    SegmentTable rays{&(*tables_)["walk_ray"], chain_rows_,          rows,
                      walk_ray_origin_x,       walk_ray_direction_x, walk_ray_primitive};
    // A walk back traces the chain that is there again, and what that has met or passed by chance is decided. Where
    // there is such a surface on either way, none leads back or forth.
    rays.without_chance = true;
    session_.rays["walk"] += session_.segments.trace(rays, {}).extension;
}

} // namespace gradus
