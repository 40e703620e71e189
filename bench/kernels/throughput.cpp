// The kernels that a render by each method and a solve launch on more than one item, the solver's main ones alone
// (bench/kernels/solver_traffic.cpp), measured in the render itself: where a kernel is about to be launched on the most
// items that it gets in this render, the render is held, what the launch was given is kept, and the kernel runs on it
// again and again, in its float, relaxed and double builds, before the render goes on. So tables, arguments and
// specialisation are those of a real batch, whatever stages a method has.
//
// The scene is a room, scenes/cornell-box.xml, whose surfaces are all of one BSDF kind and all but one emit: then each
// stage gets a queue about as long as the batch. It is rendered once for each kind; a kernel that does not depend on
// the kind is measured with the first. Methods of photons are left out where the kind is too smooth to gather any. A
// queue of n items is a film of n pixels with one sample each in batches of n paths.
//
// Google Benchmark runs the builds of a kernel in random order, interleaved, and takes the device's own clock. Between
// two runs the memory that the kernel writes is restored, outside the clock.
#include "bench/kernels/captured_launch.h"
#include "bench/kernels/interleaved.h"
#include "bench/kernels/measurements.h"
#include "bench/kernels/solver_traffic.h"
#include "bench/kernels/vector_width.h"
#include "bench/spread.h"
#include "methods/method.h"
#include "planning/make_method.h"
#include "runtime/error.h"
#include "runtime/io/load_scene.h"
#include "runtime/scene/roughness.h"
#include "runtime/scene/traits.h"
#include "solver/poisson_solver.h"
#include "tests/support/poisson_problem.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>

namespace gradus::bench {

namespace {

/// They throw where there is nothing to gather photons at.
const std::set<std::string> photon_methods = {"sppm", "gpm"};

constexpr int depth = 5; // a stage is at its most long before

/// The room with every surface of one kind. All but one emit.
Scene room(const std::string &path, const std::string &kind, std::uint32_t queue) {
    Scene scene = load_scene(path).scene;
    const std::uint32_t side = static_cast<std::uint32_t>(std::lround(std::sqrt(double(queue))));
    scene.film = {};
    scene.film.filter = FilmSettings::Filter::box;
    scene.film.width = scene.film.height = side;
    scene.settings.samples_per_pixel = 1;
    scene.settings.max_depth = depth;
    scene.settings.rr_depth = depth;
    float shade = 1; // each material another one, so that it matters which one a kernel reads
    for (Material &material : scene.materials) {
        shade *= 0.95f;
        for (Bsdf *bsdf : {&material.front, &material.back}) {
            bsdf->kind = bsdf_kind_named(kind);
            bsdf->specular_reflectance = bsdf->specular_transmittance = {shade, shade, shade};
            bsdf->alpha_u = bsdf->alpha_v = 0.2f * shade;
            material.two_sided = !bsdf_kind_traits(bsdf->kind).transmits;
        }
    }
    Emitter glow;
    glow.value = {0.1f, 0.1f, 0.1f};
    scene.emitters.push_back(glow);
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        if (i != 1 && scene.shapes[i].emitter < 0)
            scene.shapes[i].emitter = static_cast<std::int32_t>(scene.emitters.size()) - 1;
    return scene;
}

KernelPlace place_of(const KernelRequest &request) { return {request.file, request.name}; }

class Throughput {
  public:
    explicit Throughput(const Settings &settings) : settings_(settings), device_(settings.device) {}

    nlohmann::json measure() {
        if (settings_.asks_vectoriser)
            widths_ = pocl_vector_widths(settings_);
        print_heading();
        measure_queues();
        return rows_;
    }

    /// Has the compiler make its remarks on each kernel, in place of measuring it.
    void remark() {
        is_remarking_ = true;
        measure_queues();
    }

  private:
    void measure_queues() {
        for (const std::uint32_t queue : settings_.queue_sizes) {
            known_.clear();
            for (const std::string &kind : settings_.kinds) {
                const Scene scene = room(settings_.scene, kind, queue);
                for (const std::string &method : settings_.methods) {
                    RenderOptions options;
                    options.batch_size = queue;
                    if (photon_methods.contains(method) &&
                        gathering_surfaces(scene, options.gather_roughness).gathered.empty()) {
                        fmt::print("  {} without {}: too smooth to gather photons at\n", method, kind);
                        continue;
                    }
                    measure_launches(queue, [&] { make_method(method, device_, scene, options)->render_batch(); });
                }
            }
            measure_solver(queue);
        }
    }

    /// `work` is done twice: once to learn which launch of each kernel is the largest, once to measure there.
    void measure_launches(std::uint32_t queue, const std::function<void()> &work) {
        struct Largest {
            std::size_t items = 0, ordinal = 0, seen = 0;
        };
        std::map<KernelPlace, Largest> launches;
        const auto with_observer = [&](const LaunchObserver &observer) {
            observe_launches(device_, observer);
            work();
            observe_launches(device_, {});
        };
        with_observer([&](const Launch &launch) {
            if (is_empty(launch))
                return;
            Largest &largest = launches[place_of(launch.request)];
            if (launch.items > largest.items)
                largest = {launch.items, largest.seen, largest.seen};
            ++largest.seen;
        });
        for (auto &[place, largest] : launches)
            largest.seen = 0;
        with_observer([&](const Launch &launch) {
            if (is_empty(launch))
                return;
            Largest &largest = launches.at(place_of(launch.request));
            // A launch of one item ends a sum.
            if (largest.seen++ != largest.ordinal || launch.items == 1 || !is_wanted(launch) ||
                !known_.insert(place_of(launch.request)).second)
                return;
            CapturedLaunch captured(device_, launch);
            if (is_remarking_)
                print_remarks(captured);
            else
                measure_kernel(queue, captured);
        });
    }

    /// Kernels are launched on no rows before a render, to be compiled.
    static bool is_empty(const Launch &launch) {
        const auto count = launch.arguments.find("count");
        return count != launch.arguments.end() && std::get<std::uint32_t>(count->second.value) == 0;
    }

    /// The solver has kernels without number that run once a solve.
    static bool is_wanted(const Launch &launch) {
        return launch.request.file.starts_with("kernels/stages/") || solver_traffic(launch.request.name);
    }

    void measure_solver(std::uint32_t queue) {
        const std::uint32_t side = static_cast<std::uint32_t>(std::lround(std::sqrt(double(queue))));
        const testing::PoissonProblem problem = testing::make_poisson_problem(side, side, 3, 1);
        std::vector<float> result(problem.primal.size());
        for (const LinearMethod method : {LinearMethod::multigrid, LinearMethod::cg})
            measure_launches(queue, [&] {
                PoissonOptions options;
                options.norm = PoissonNorm::l2;
                options.alpha = 0.2;
                options.method = method;
                options.iterations = 3;
                options.tolerance = 1e-12;
                PoissonSolver(device_, side, side, 3).solve(problem.images(), options, result.data());
            });
    }

    void measure_kernel(std::uint32_t queue, CapturedLaunch &launch) {
        std::map<std::string, Replay> replays;
        replays["float"] = launch.replay(Precision::single);
        replays["relaxed"] = launch.replay(Precision::relaxed);
        if (device_.description().has_double)
            replays["double"] = launch.replay(Precision::double_);
        // By experiment once, at the smallest queue: the columns are the same at every size.
        const KernelPlace place{launch.file(), launch.name()};
        if (!bytes_.contains(place))
            bytes_[place] = bytes_an_item(launch);
        const std::optional<double> bytes = bytes_.at(place);

        std::map<std::string, std::function<double()>> builds;
        for (auto &[name, replay] : replays) {
            replay.seconds(); // compiles
            builds[name] = [&replay = replay] { return replay.seconds(); };
        }
        std::optional<Triad> triad;
        if (bytes) {
            triad.emplace(device_, *bytes * double(launch.items()));
            triad->seconds();
            builds["triad"] = [&] { return triad->seconds(); };
        }
        report(queue, launch, bytes, triad ? triad->bytes() : 0, run_interleaved(builds, settings_.repeats));
    }

    static std::optional<double> bytes_an_item(CapturedLaunch &launch) {
        if (const auto traffic = solver_traffic(launch.name()); traffic && launch.file().starts_with("kernels/solver/"))
            return sizeof(float) * *traffic *
                   (launch.pixels_of_tiles() > 0 ? double(launch.pixels_of_tiles()) / double(launch.items()) : 1);
        // An item of the partition takes a chunk of rows.
        if (launch.file() == "kernels/stages/partition.cl")
            return std::nullopt;
        return launch.table_bytes_an_item();
    }

    static void print_heading() {
        fmt::print(
            "Kernels: M items/s of the float build, its time over those of the others, its bytes an item over a triad "
            "of as many, -: not known\n  {:<32} {:>8} {:>9} {:>8} {:>8} {:>7} {:>7} {:>7}\n",
            "kernel", "items", "M items/s", "relaxed", "double", "bytes", "/triad", "vector");
    }

    void report(std::uint32_t queue, const CapturedLaunch &launch, std::optional<double> bytes, double triad_bytes,
                const std::map<std::string, std::vector<double>> &seconds) {
        nlohmann::json row = {{"kernel", launch.name()},
                              {"file", launch.file()},
                              {"queue", queue},
                              {"items", launch.items()},
                              {"bytes_per_item", nullptr}};
        const double single = median(seconds.at("float"));
        for (const auto &[build, of] : seconds) {
            row["seconds"][build] = spread(of);
            if (build != "triad")
                row["items_per_second"][build] = double(launch.items()) / median(of);
        }
        const auto ratio = [&](const char *build) -> std::optional<double> {
            if (!seconds.contains(build))
                return std::nullopt;
            return median(seconds.at(build)) / single;
        };
        std::optional<double> share;
        if (bytes) {
            row["bytes_per_item"] = *bytes;
            share = *bytes * double(launch.items()) / single / (triad_bytes / median(seconds.at("triad")));
            row["bandwidth_over_triad"] = *share;
        }
        row["float_over_relaxed"] = 1 / *ratio("relaxed");
        if (const auto wide = ratio("double"))
            row["float_over_double"] = 1 / *wide;
        const auto width = widths_.find({launch.file(), launch.name()});
        if (width != widths_.end())
            row["vector_width"] = width->second;
        const auto text = [](std::optional<double> value, const char *format) {
            return value ? fmt::format(fmt::runtime(format), *value) : std::string("-");
        };
        const auto inverse = [](std::optional<double> value) {
            return value ? std::optional<double>(1 / *value) : std::nullopt;
        };
        fmt::print("  {:<32} {:>8} {:>9.2f} {:>8} {:>8} {:>7} {:>7} {:>7}\n", launch.name(), launch.items(),
                   1e-6 * double(launch.items()) / single, text(inverse(ratio("relaxed")), "{:.2f}"),
                   text(inverse(ratio("double")), "{:.2f}"), text(bytes, "{:.0f}"), text(share, "{:.2f}"),
                   width != widths_.end() ? std::to_string(width->second) : "-");
        rows_.push_back(row);
    }

    const Settings &settings_;
    Device &device_;
    bool is_remarking_ = false;
    std::set<KernelPlace> known_; ///< that this queue size has been measured for
    std::map<KernelPlace, std::optional<double>> bytes_;
    std::map<KernelPlace, int> widths_; ///< of vectors
    nlohmann::json rows_ = nlohmann::json::array();
};

} // namespace

nlohmann::json measure_throughput(const Settings &settings) { return Throughput(settings).measure(); }

void remark_on_kernels(const Settings &settings) { Throughput(settings).remark(); }

} // namespace gradus::bench
