// The double build against the float build, stage by stage on equal inputs: each launch of a render is made again by
// the double build on what the float tables hold, so that what differs afterwards is what this stage rounds.
#include "bench/kernels/captured_launch.h"
#include "methods/method.h"
#include "planning/make_method.h"
#include "runtime/io/load_scene.h"
#include "runtime/wavefront/table_layout.h"
#include "tests/support/test_name.h"
#include "tests/support/worse.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <set>

namespace gradus {
namespace {

using testing::worse;

using bench::CapturedBuffer;
using bench::CapturedLaunch;

/// Rows that may differ visibly: where rounding decides otherwise (which lobe, which light, roulette), and where a
/// value is the small difference of large ones (grazing angles, the tail of a narrow lobe).
constexpr double visible = 1e-3, allowed_fraction = 5e-3;
/// Half of all rows of a kernel are at least this near, some ten roundings of float. Both limits are for all launches
/// together: a single one may have ten rows, half of which happen to lie in the tail of a lobe, and the four offset
/// paths of a base path differ together.
constexpr double allowed_median = 2e-6;
/// Less than this is nothing: the tail of a narrow lobe goes below what float holds, and double still holds it.
constexpr double negligible = 1e-30;
/// Smaller values of these columns differ by the rounding of what is added to them. A point of a light in the plane of
/// which the vertex lies is seen at an angle that is rounding alone, and so is what arrives from there; the ends of a
/// short connection are rounded as those of a long one.
const std::map<std::string, double> floors = {{"event.arriving", 0.1},  {"event.inverse_light", 0.1},
                                              {"event.base", 0.1},      {"evaluation.value", 1e-3},
                                              {"evaluation.pdf", 1e-3}, {"link.direction", 0.01}};
/// Launches of each kernel.
constexpr std::uint32_t bounces = 5;

struct DoubleCase {
    const char *method, *scene;
};

void PrintTo(const DoubleCase &c, std::ostream *out) { *out << c.method << " " << c.scene; }

/// A table's content by column, all reals as double.
using Content = std::vector<std::vector<double>>;

Content columns_of(const CapturedBuffer &buffer, const std::vector<char> &bytes, std::size_t real) {
    Content content(buffer.is_uint.size(), std::vector<double>(buffer.rows));
    for (std::size_t c = 0; c < content.size(); ++c) {
        const bool is_uint = buffer.is_uint[c];
        const char *place = &bytes[c * buffer.rows * real];
        for (double &value : content[c]) {
            std::uint32_t number;
            float single;
            std::memcpy(&number, place, sizeof number);
            std::memcpy(&single, place, sizeof single);
            value = is_uint ? number : single;
            if (!is_uint && real == sizeof value)
                std::memcpy(&value, place, sizeof value);
            place += real;
        }
    }
    return content;
}

class DoubleBuild : public ::testing::TestWithParam<DoubleCase> {
  protected:
    void SetUp() override {
        scene = load_scene(fmt::format("{}/{}.xml", GRADUS_SCENES, GetParam().scene)).scene;
        scene.film.width = 48;
        scene.film.height = 36;
        scene.film.crop_width = scene.film.crop_height = 0;
        scene.settings.samples_per_pixel = 4;
        scene.settings.max_depth = 12;
        scene.settings.rr_depth = 2;
    }
    static Device &device() {
        static Device device;
        static const std::shared_ptr<void> compilers = keep_compilers(device); // kernels are built one by one
        return device;
    }

    static std::size_t number(const Launch &launch, const char *name) {
        const auto found = launch.arguments.find(name);
        return found == launch.arguments.end() ? 0 : std::get<std::uint32_t>(found->second.value);
    }

    void compare(const Launch &launch) {
        if (!launch.request.file.starts_with("kernels/stages/") || number(launch, "count") == 0 ||
            ++seen[launch.request.name] > bounces)
            return;
        CapturedLaunch captured(device(), launch);
        bench::Replay single = captured.replay(Precision::single), wide = captured.replay(Precision::double_);
        const std::vector<std::vector<char>> before = wide.contents();
        single.run();
        wide.run();
        const std::vector<std::vector<char>> a = single.contents(), b = wide.contents();
        const auto place_of = [&](const char *table) {
            const auto &all = captured.buffers();
            return std::size_t(
                std::find_if(all.begin(), all.end(),
                             [&](const CapturedBuffer &buffer) { return buffer.arguments.front() == table; }) -
                all.begin());
        };
        const auto read = [&](std::size_t i) { return columns_of(captured.buffers()[i], b[i], sizeof(double)); };
        const std::size_t prefix = place_of("prefix"), evaluation = place_of("evaluation");
        const Content base = prefix < a.size() ? read(prefix) : Content();
        const Content answers = evaluation < a.size() ? read(evaluation) : Content();
        const std::size_t slots = number(launch, "slots"), stride = number(launch, "stride"),
                          capacity = number(launch, "capacity");
        for (std::size_t i = 0; i < a.size(); ++i) {
            const CapturedBuffer &buffer = captured.buffers()[i];
            const std::string &table = buffer.arguments.front();
            // A difference is as large as what it is the difference of; whether to ask is a matter of what is gained.
            std::function<double(std::size_t)> scale_of = [](std::size_t) { return 0.0; }, gain_of;
            if (table == "difference" && !base.empty())
                scale_of = [&](std::size_t row) {
                    return std::max({base[0][row % slots], base[1][row % slots], base[2][row % slots]});
                };
            if ((table == "link" || table == "offset_ray") && !answers.empty())
                gain_of = [&, first_line = table == "link" ? 0 : 4](std::size_t row) {
                    const std::size_t line = first_line + row / stride, at = line * capacity + row % stride;
                    const double value = std::max({answers[0][at], answers[1][at], answers[2][at]});
                    return line < 4 ? value : answers[3][at];
                };
            const std::string name = launch.request.name + " -> " + buffer.arguments.front();
            if (buffer.is_real && buffer.rows == 0)
                EXPECT_FALSE(captured.is_written(i)) << name << " is no table";
            else if (!buffer.is_real)
                compare_numbers(launch, name, a[i], b[i]);
            else
                compare_table(name, buffer, a[i], b[i], before[i], scale_of, gain_of);
        }
        single.restore();
    }

    /// Whole numbers, by which rows are sorted.
    static void compare_numbers(const Launch &launch, const std::string &name, const std::vector<char> &a,
                                const std::vector<char> &b) {
        std::size_t other = 0;
        for (std::size_t at = 0; at < a.size(); at += sizeof(std::uint32_t))
            other += std::memcmp(&a[at], &b[at], sizeof(std::uint32_t)) != 0;
        const bool is_exact = launch.request.name.starts_with("partition");
        EXPECT_LE(other, is_exact ? 0 : launch.items / 1000 + 1) << name;
    }

    /// Compares the rows that one of them has written.
    void compare_table(const std::string &name, const CapturedBuffer &buffer, const std::vector<char> &a,
                       const std::vector<char> &b, const std::vector<char> &before,
                       const std::function<double(std::size_t)> &scale_of,
                       const std::function<double(std::size_t)> &gain_of) {
        const Content single = columns_of(buffer, a, sizeof(float)), wide = columns_of(buffer, b, sizeof(double)),
                      old = columns_of(buffer, before, sizeof(double));
        const std::vector<TableColumn> &columns = table_layout(buffer.arguments.front())->columns;
        const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
        const std::vector<Measure> measures = measures_of(buffer.arguments.front(), columns);
        std::vector<double> errors;
        for (std::size_t row = 0; row < buffer.rows; ++row) {
            bool is_written = false;
            for (std::size_t c = 0; c < single.size(); ++c)
                is_written = is_written || !same(single[c][row], old[c][row]) || !same(wide[c][row], old[c][row]);
            if (is_written)
                errors.push_back(row_error(columns, measures, single, wide, row, scale_of(row), gain_of));
        }
        std::vector<double> &total = figures[name];
        total.insert(total.end(), errors.begin(), errors.end());
    }

    /// What errors of a real column are relative to.
    struct Measure {
        std::vector<std::size_t> members; ///< columns of the same vector or colour, itself among them
        double floor = negligible;
        bool is_value = false, is_correction = false; ///< a correction: what the sums have rounded away
    };

    static std::vector<Measure> measures_of(const std::string &table, const std::vector<TableColumn> &columns) {
        const auto stem = [&](std::size_t i) { return columns[i].name.substr(0, columns[i].name.rfind('_')); };
        std::vector<Measure> measures(columns.size());
        for (std::size_t c = 0; c < columns.size(); ++c) {
            Measure &measure = measures[c];
            for (std::size_t i = 0; i < columns.size(); ++i)
                if (i == c || (!columns[i].is_uint && stem(i) == stem(c)))
                    measure.members.push_back(i);
            if (const auto floor = floors.find(table + "." + stem(c)); floor != floors.end())
                measure.floor = floor->second;
            measure.is_value = stem(c) == "value";
            measure.is_correction = columns[c].name.find("correction") != std::string::npos;
        }
        return measures;
    }

    /// The largest relative error of a row, vectors and colours by their largest member; 1 where a whole number
    /// differs.
    static double row_error(const std::vector<TableColumn> &columns, const std::vector<Measure> &measures,
                            const Content &a, const Content &b, std::size_t row, double value_scale,
                            const std::function<double(std::size_t)> &gain_of) {
        double error = 0;
        for (std::size_t c = 0; c < a.size(); ++c) {
            const double x = a[c][row], y = b[c][row];
            if (columns[c].is_uint) {
                error = worse(error, x == y || is_negligible(columns, c, a, b, row, gain_of) ? 0.0 : 1.0);
                continue;
            }
            if (measures[c].is_correction)
                continue;
            if (!std::isfinite(x) || !std::isfinite(y)) { // a column that nobody has written yet, or an error
                error = worse(error, std::isfinite(x) == std::isfinite(y) ? 0.0 : 1.0);
                continue;
            }
            double scale = std::max(measures[c].floor, measures[c].is_value ? value_scale : 0);
            for (const std::size_t i : measures[c].members)
                scale = std::max(scale, std::abs(b[i][row]));
            error = worse(error, std::min(1.0, std::abs(x - y) / scale));
        }
        return error;
    }

    /// A ray that only one of them asks for, for a gain of nothing.
    static bool is_negligible(const std::vector<TableColumn> &columns, std::size_t c, const Content &a,
                              const Content &b, std::size_t row, const std::function<double(std::size_t)> &gain_of) {
        if (columns[c].name != "open" && columns[c].name != "primitive")
            return false;
        if (gain_of)
            return gain_of(row) < negligible;
        double gain = 0;
        bool has_gain = false;
        for (std::size_t i = 0; i < a.size(); ++i)
            if (columns[i].name.starts_with("value_")) {
                has_gain = true;
                gain = std::max({gain, std::abs(a[i][row]), std::abs(b[i][row])});
            }
        return has_gain && gain < negligible;
    }

    void check_figures() {
        for (auto &[name, errors] : figures) {
            if (errors.empty())
                continue;
            std::sort(errors.begin(), errors.end());
            const auto at = [&](double part) { return errors[std::size_t(part * double(errors.size() - 1))]; };
            std::printf("  %-44s median %.1e  99 %% %.1e  99.9 %% %.1e  of %zu rows\n", name.c_str(), at(0.5), at(0.99),
                        at(0.999), errors.size());
            EXPECT_LE(at(0.5), allowed_median) << name;
            const auto far = errors.end() - std::upper_bound(errors.begin(), errors.end(), visible);
            EXPECT_LE(double(far), std::max(3.0, allowed_fraction * double(errors.size()))) << name;
        }
    }

    Scene scene;
    std::map<std::string, std::uint32_t> seen;
    std::map<std::string, std::vector<double>> figures;
};

TEST_P(DoubleBuild, AgreesWithTheFloatBuildInEveryStage) {
    if (!device().description().has_double)
        GTEST_SKIP() << device().description().name << " has no double precision";
    RenderOptions options;
    options.seed = 5;
    options.aov = true;
    observe_launches(device(), [this](const Launch &launch) { compare(launch); });
    const std::unique_ptr<Method> method = make_method(GetParam().method, device(), scene, options);
    while (method->render_batch()) {
    }
    observe_launches(device(), {});
    const Statistics statistics = method->statistics();
    EXPECT_EQ(statistics.non_finite, 0u);
    std::size_t stages = 0;
    for (const StageTime &stage : statistics.stages)
        if (stage.launches > 0) {
            EXPECT_GT(seen[stage.name], 0u) << stage.name;
            ++stages;
        }
    EXPECT_GE(stages, 9u);
    check_figures();
}

std::string name_of_case(const ::testing::TestParamInfo<DoubleCase> &info) {
    return testing::test_name(fmt::format("{}_{}", info.param.method, info.param.scene));
}

// All stages of pt are among those of gpt, but for a camera with a place in the pixel of its own.
INSTANTIATE_TEST_SUITE_P(Scenes, DoubleBuild,
                         ::testing::Values(DoubleCase{"pt", "cornell-box"}, DoubleCase{"gpt", "cornell-box"}),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(Full, DoubleBuild,
                         ::testing::Values(DoubleCase{"gpt", "materials"}, DoubleCase{"gpt", "plates"}), name_of_case);

} // namespace
} // namespace gradus
