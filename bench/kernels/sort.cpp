// The sort of runtime/wavefront, the sums over runs and the splats: wall nanoseconds a row, waiting for the device
// included, against std::stable_sort of pairs of key and row on one thread, and a triad of the 12 bytes a row that any
// sort reads and writes, whose nanoseconds are the device's alone. Keys are random; half of the splats are on a
// hundredth of the pixels.
#include "bench/kernels/interleaved.h"
#include "bench/kernels/measurements.h"
#include "bench/spread.h"
#include "runtime/seconds_since.h"
#include "runtime/wavefront/runs.h"
#include "runtime/wavefront/splats.h"
#include "tests/support/small_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <random>
#include <utility>

namespace gradus::bench {

namespace {

constexpr std::uint32_t side = 512, columns = 3;

template <class Work>
double seconds_of(Work work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return seconds_since(start);
}

class SortBench {
  public:
    SortBench(Device &device, std::uint32_t rows)
        : device_(device), rows_(rows), maker_(side, 1), session_(device, maker_.scene, {}, {}),
          sort_(session_, stages_, "sort", RowsOf::path), runs_(stages_, sort_, columns),
          splats_(session_, stages_, RowsOf::path, 1, Splats::Order::paths), triad_(device, 12.0 * rows) {
        TableList list;
        for (const TableList &some : {sort_.tables(), runs_.tables(), splats_.tables()})
            list.insert(list.end(), some.begin(), some.end());
        tables_.emplace(device, list, TableRows{rows, rows, side * side, side, 1}, Precision::single);
        stages_.build(session_, *tables_);
        sort_.attach(*tables_);
        runs_.attach(*tables_);
        splats_.attach(*tables_);
        (*tables_)["splat"].clear();
        std::uniform_int_distribution<std::uint32_t> anywhere(0, side * side - 1), spot(0, side * side / 100);
        fill("splat_pixel", [&] { return engine_() % 2 ? spot(engine_) : anywhere(engine_); });
        std::uniform_int_distribution<std::uint32_t> path(0, rows / 4);
        fill("splat_path", [&] { return path(engine_); });
    }

    nlohmann::json measure(int bits, int repeats) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs(rows_), copy;
        std::vector<std::uint32_t> keys(rows_);
        for (std::uint32_t row = 0; row < rows_; ++row) {
            keys[row] = std::uint32_t(engine_()) >> (32 - bits);
            pairs[row] = {keys[row], row};
        }
        const Buffer from(device_, "keys", keys.data(), keys.size() * sizeof(std::uint32_t));
        const std::uint32_t highest = (1u << (bits - 1)) - 2 + (1u << (bits - 1)); // highest + 1 takes no more bits
        std::map<std::string, std::function<double()>> functions;
        functions["sort"] = [&] {
            return seconds_of([&] {
                sort_.run(from, rows_, highest);
                finish(device_);
            });
        };
        functions["std"] = [&] {
            copy = pairs;
            return seconds_of(
                [&] { std::stable_sort(copy.begin(), copy.end(), [](auto a, auto b) { return a.first < b.first; }); });
        };
        functions["triad"] = [&] { return triad_.seconds(); };
        return report(fmt::format("sort, {} bits", bits), functions, repeats);
    }

    /// Of what measure() sorted last.
    nlohmann::json measure_runs(int repeats) {
        std::map<std::string, std::function<double()>> functions;
        functions["sort"] = [&] {
            return seconds_of([&] {
                runs_.find(rows_);
                finish(device_);
            });
        };
        nlohmann::json result = {{"find", report("runs", functions, repeats)}};
        functions["sort"] = [&] {
            return seconds_of([&] {
                runs_.sum((*tables_)["splat"], rows_, 0, columns);
                finish(device_);
            });
        };
        result["sum"] = report(fmt::format("sums of {} columns", columns), functions, repeats);
        return result;
    }

    nlohmann::json measure_splats(int repeats) {
        std::map<std::string, std::function<double()>> functions;
        functions["sort"] = [&] {
            return seconds_of([&] {
                splats_.add(rows_, rows_ / 4);
                finish(device_);
            });
        };
        return report("splats by path", functions, repeats);
    }

  private:
    template <class Make>
    void fill(const char *table, Make make) {
        const auto view = (*tables_)[table].map(Access::write);
        std::generate_n(view.template as<std::uint32_t>(), rows_, make);
    }

    nlohmann::json report(const std::string &name, const std::map<std::string, std::function<double()>> &functions,
                          int repeats) {
        for (const auto &[which, function] : functions)
            function();
        nlohmann::json row = {{"name", name}, {"rows", rows_}};
        for (const auto &[which, seconds] : run_interleaved(functions, repeats)) {
            row["seconds"][which] = spread(seconds);
            row["nanoseconds_a_row"][which] = 1e9 * median(seconds) / rows_;
        }
        const auto nanoseconds = [&](const char *which) {
            return functions.contains(which) ? fmt::format("{:.2f}", row["nanoseconds_a_row"][which].get<double>())
                                             : std::string("-");
        };
        fmt::print("  {:<22} {:>8} {:>9} {:>9} {:>7}\n", name, rows_, nanoseconds("sort"), nanoseconds("std"),
                   nanoseconds("triad"));
        return row;
    }

    Device &device_;
    std::uint32_t rows_;
    testing::SceneMaker maker_;
    Session session_;
    Stages stages_;
    Sort sort_;
    Runs runs_;
    Splats splats_;
    Triad triad_;
    std::optional<Tables> tables_;
    std::mt19937 engine_{3};
};

} // namespace

nlohmann::json measure_sort(const Settings &settings) {
    fmt::print("Sorting: ns a row\n  {:<22} {:>8} {:>9} {:>9} {:>7}\n", "", "rows", "here", "std", "triad");
    nlohmann::json rows = nlohmann::json::array();
    for (const int rows_bits : {16, 18, 20}) {
        if (settings.is_quick && rows_bits > 16)
            break;
        SortBench bench(settings.device, 1u << rows_bits);
        for (const int bits : {32, 24, 16})
            rows.push_back(bench.measure(bits, settings.repeats));
        rows.push_back(bench.measure_runs(settings.repeats));
        rows.push_back(bench.measure_splats(settings.repeats));
    }
    return rows;
}

} // namespace gradus::bench
