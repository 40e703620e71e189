// The double build against the float build, stage by stage on equal inputs: before each stage the double tables are
// set to what the float tables hold, so that what differs afterwards is what this stage rounds.
#include "runtime/io/load_scene.h"
#include "runtime/stages/trace_stage.h"
#include "tests/portability/wavefront.h"
#include "tests/support/test_name.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gradus {
namespace {

using namespace testing;

/// Rows that may differ visibly: where rounding decides otherwise (which lobe, which light, roulette), and where a
/// value is the small difference of large ones (grazing angles, the tail of a narrow lobe).
constexpr double visible = 1e-3, allowed_fraction = 5e-3;
/// Half of all rows are at least this near, some ten roundings of float.
constexpr double allowed_median = 2e-6;
/// Less than this is nothing: the tail of a narrow lobe goes below what float holds, and double still holds it.
constexpr double negligible = 1e-30;
constexpr std::uint32_t bounces = 5;

class DoubleBuild : public ::testing::TestWithParam<const char *> {
  protected:
    void SetUp() override {
        scene = load_scene(std::string(GRADUS_SCENES) + "/" + GetParam() + ".xml").scene;
        scene.film.width = 48;
        scene.film.height = 36;
        scene.film.crop_width = scene.film.crop_height = 0;
        scene.settings.samples_per_pixel = 4;
        TraitMap traits = scene_traits(scene);
        traits["TRAIT_AOV"] = 1;
        traits["TRAIT_SHARED_JITTER"] = 0;
        traits["STRATEGY"] = 0;
        scene_tables = make_scene_tables(scene, traits);
        single = std::make_unique<Wavefront>(device(), scene, traits, scene_tables, Precision::single);
        double_ = std::make_unique<Wavefront>(device(), scene, traits, scene_tables, Precision::double_);
    }
    static Device &device() {
        static Device device;
        return device;
    }

    template <class Visit>
    void for_each_table(Visit visit) {
        BatchTables &s = *single->tables, &d = *double_->tables;
        visit("ray", s.ray, d.ray, ray_table);
        visit("shadow", s.shadow, d.shadow, shadow_table);
        visit("vertex", single->newest(), double_->newest(), vertex_table);
        visit("tangent", s.tangent, d.tangent, tangent_table);
        visit("radiance", s.radiance, d.radiance, radiance_table);
        visit("feature", s.feature, d.feature, feature_table);
    }
    void synchronise() {
        for_each_table([&](const char *, const Buffer &s, const Buffer &d, const std::vector<Column> &columns) {
            double_->write(d, columns, single->read(s, columns));
        });
    }

    /// Compares rows [first, first + count) of the named tables.
    void compare(const std::string &stage, const std::vector<std::string> &names, std::uint32_t first,
                 std::uint32_t count) {
        for_each_table([&](const char *name, const Buffer &s, const Buffer &d, const std::vector<Column> &columns) {
            if (std::find(names.begin(), names.end(), name) == names.end() || count == 0)
                return;
            const Content a = single->read(s, columns), b = double_->read(d, columns);
            std::vector<double> errors;
            for (std::size_t row = first; row < first + count; ++row)
                errors.push_back(row_error(columns, a, b, row));
            std::sort(errors.begin(), errors.end());
            const auto at = [&](double part) { return errors[std::size_t(part * double(errors.size() - 1))]; };
            const auto far = errors.end() - std::upper_bound(errors.begin(), errors.end(), visible);
            std::vector<double> &total = figures[stage + " -> " + name];
            total.insert(total.end(), errors.begin(), errors.end());
            EXPECT_LE(at(0.5), allowed_median) << stage << " -> " << name;
            EXPECT_LE(double(far), std::max(3.0, allowed_fraction * double(count)))
                << stage << " -> " << name << ": rows of " << count;
        });
    }

    /// The largest relative error of a row, vectors and colours by their largest member; 1 where a whole number
    /// differs.
    static double row_error(const std::vector<Column> &columns, const Content &a, const Content &b, std::size_t row) {
        double error = 0;
        for (std::size_t c = 0; c < a.values.size(); ++c) {
            const double x = a.values[c][row], y = b.values[c][row];
            if (columns[c].is_uint) {
                error = std::max(error, x == y || is_negligible(columns, c, a, b, row) ? 0.0 : 1.0);
                continue;
            }
            if (!std::isfinite(x) || !std::isfinite(y)) { // a column that nobody has written yet, or an error
                error = std::max(error, std::isfinite(x) == std::isfinite(y) ? 0.0 : 1.0);
                continue;
            }
            const auto stem = [&](std::size_t i) { return columns[i].name.substr(0, columns[i].name.rfind('_')); };
            double scale = negligible;
            for (std::size_t i = 0; i < a.values.size(); ++i)
                if (i == c || (!columns[i].is_uint && stem(i) == stem(c)))
                    scale = std::max(scale, std::abs(b.values[i][row]));
            error = std::max(error, std::min(1.0, std::abs(x - y) / scale));
        }
        return error;
    }

    /// A shadow ray that only one of them asks for, for a gain of nothing.
    static bool is_negligible(const std::vector<Column> &columns, std::size_t c, const Content &a, const Content &b,
                              std::size_t row) {
        if (columns[c].name != "open")
            return false;
        double gain = 0;
        for (std::size_t i = 0; i < columns.size(); ++i)
            if (columns[i].name.starts_with("value_"))
                gain = std::max({gain, std::abs(a.values[i][row]), std::abs(b.values[i][row])});
        return gain < negligible;
    }

    void run(const std::string &stage, const std::string &kind, std::uint32_t first, std::uint32_t count,
             const std::vector<std::string> &compared, std::uint32_t compared_first, std::uint32_t compared_count) {
        synchronise();
        single->run(stage, kind, first, count);
        double_->run(stage, kind, first, count);
        compare(kind.empty() ? stage : stage + " " + kind, compared, compared_first, compared_count);
    }

    void print_figures() {
        for (auto &[name, errors] : figures) {
            std::sort(errors.begin(), errors.end());
            const auto at = [&](double part) { return errors[std::size_t(part * double(errors.size() - 1))]; };
            std::printf("  %-44s median %.1e  99 %% %.1e  99.9 %% %.1e  of %zu rows\n", name.c_str(), at(0.5), at(0.99),
                        at(0.999), errors.size());
        }
    }

    Scene scene;
    SceneTables scene_tables;
    std::unique_ptr<Wavefront> single, double_;
    std::map<std::string, std::vector<double>> figures;
};

TEST_P(DoubleBuild, AgreesWithTheFloatBuildInEveryStage) {
    if (!device().description().has_double)
        GTEST_SKIP() << device().description().name << " has no double precision";
    const std::uint32_t paths = single->tables->capacity;
    Tracer tracer(scene, 0);
    double seconds = 0;
    const auto both_exchange = [&] {
        single->exchange_vertices();
        double_->exchange_vertices();
    };

    run("camera", "", 0, paths, {"ray", "radiance", "feature"}, 0, paths);
    std::uint32_t rays = paths, vertices = 0;
    for (std::uint32_t bounce = 0; bounce < bounces && rays > 0; ++bounce) {
        run_trace_stage(tracer, *single->tables, rays, vertices, seconds);
        run("connect", "", 0, vertices, {"radiance"}, 0, paths);
        run("classify", "", 0, rays, {}, 0, 0);
        const auto bins = single->read_bins(rays), wide_bins = double_->read_bins(rays);
        std::size_t other = 0;
        for (std::size_t i = 0; i < bins.size(); ++i)
            other += bins[i] != wide_bins[i];
        EXPECT_LE(other, rays / 1000 + 1) << "classify: rays in other bins";
        double_->write_bins(bins);
        const std::vector<std::uint32_t> range = single->partition(rays);
        EXPECT_EQ(range, double_->partition(rays));

        const std::uint32_t escaped = range[1], hits = range.back() - escaped;
        both_exchange(); // what was newest is now old; its content is equal in both
        run("escape", "", 0, escaped, {"radiance"}, 0, paths);
        for (std::size_t k = 0; k < scene_tables.kinds.size(); ++k)
            run("emission", "", range[2 + 2 * k], range[3 + 2 * k] - range[2 + 2 * k], {"radiance"}, 0, paths);
        run("surface", "", escaped, hits, {"vertex", "tangent"}, 0, hits);
        for (std::size_t k = 0; k < scene_tables.kinds.size(); ++k) {
            const std::uint32_t first = range[1 + 2 * k] - escaped, items = range[3 + 2 * k] - range[1 + 2 * k];
            const std::string &kind = scene_tables.kinds[k];
            run("feature", kind, first, items, {"feature"}, 0, paths);
            if (!bsdf_kind_is_dirac(kind))
                run("light_sample", kind, first, items, {"shadow"}, first, items);
            run("scatter", kind, first, items, {"vertex", "ray"}, first, items);
        }
        synchronise();
        vertices = rays = hits;
    }
    synchronise();
    single->film->accumulate(paths, 0);
    double_->film->accumulate(paths, 0);
    std::uint64_t rejected = 0;
    const Image a = single->film->image(paths, rejected), b = double_->film->image(paths, rejected);
    EXPECT_EQ(rejected, 0u);
    for (const Channel &channel : a.channels)
        for (std::size_t i = 0; i < channel.values.size() && !channel.name.starts_with("variance"); ++i)
            ASSERT_NEAR(channel.values[i], b.find(channel.name)->values[i],
                        1e-5 * std::max(1.0f, std::abs(channel.values[i])))
                << channel.name;
    print_figures();
}

INSTANTIATE_TEST_SUITE_P(Scenes, DoubleBuild, ::testing::Values("cornell-box", "materials", "plates"), name_of_scene);

} // namespace
} // namespace gradus
