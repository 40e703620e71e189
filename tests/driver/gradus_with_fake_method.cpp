// The gradus program with a scene loader and a method that tests control by scene parameters (-D):
//   batch_ms=N   what a batch of one sample a pixel takes (0)
//   patient_ms=N the first batch takes so long, but for being told to stop
//   endless=N    after N samples a pixel batches end only by being told to stop
//   holes=N      so many pixels have a sample less than the others
//   fail=memory  the render runs out of memory; fail=strange: throws what is no exception; memory-later, device-later:
//                after three samples a pixel; memory-image: and in image(), too; memory-partial: in the first image();
//                statistics: all statistics after the first sample fail;
//                reconstruction: in all image() but not in mean_image(), whose B is 0.25
//   reads=FILE   the loader says that it read this file, too
//   spp=N        the samples that the scene asks for (4)
//   nan=1        one value of the image is NaN
//   warn=TEXT    the loader warns
//   choice=NAME  what the method auto chooses (gpt)
//   image_ms=N   what making an image takes (0)
//   pilot_ms=N   what the pilot of method auto takes (0)
//   error=X      with --error, the estimated error of the image of one sample a pixel; it falls as 1 over the samples
// The image is R = seed, G = samples a pixel so far, B = 0.5; the film is 8x6 with 4 samples a pixel.
// A solve gives the primal; the device named "too small" has no room for it.
#include "driver/program.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <new>
#include <thread>

namespace gradus {
namespace {

std::map<std::string, std::string> parameters;

std::string parameter(const std::string &name) {
    const auto at = parameters.find(name);
    return at == parameters.end() ? "" : at->second;
}

LoadedScene load_fake_scene(const std::string &path, const LoadOptions &options) {
    if (!std::filesystem::exists(path))
        throw Error(ExitCode::scene, path + ":1: no such scene");
    parameters = options.parameters;
    LoadedScene loaded;
    loaded.scene.path = path;
    loaded.scene.film.width = 8;
    loaded.scene.film.height = 6;
    loaded.scene.settings.samples_per_pixel = 4;
    if (!parameter("warn").empty())
        loaded.warnings.push_back(path + ":2: " + parameter("warn"));
    loaded.files = {path, parameter("reads")};
    if (!parameter("spp").empty())
        loaded.scene.settings.samples_per_pixel = std::stoull(parameter("spp"));
    return loaded;
}

class FakeMethod : public Method {
  public:
    FakeMethod(const std::string &method, const Scene &scene, const RenderOptions &options)
        : stop_(options.stop), automatic_(method == "auto"), seed_(options.seed), aov_(options.aov),
          error_(options.error), samples_per_pixel_(scene.settings.samples_per_pixel) {
        width_ = scene.film.crop_width > 0 ? scene.film.crop_width : scene.film.width;
        height_ = scene.film.crop_height > 0 ? scene.film.crop_height : scene.film.height;
        if (options.time_limit > 0)
            reason_ += fmt::format(", within {} s", options.time_limit);
        if (options.on_compiled)
            options.on_compiled("fake_kernel", 1, 1, 0.25);
        if (automatic_ && options.on_pilot)
            options.on_pilot(6);
        if (automatic_ && !parameter("pilot_ms").empty())
            std::this_thread::sleep_for(std::chrono::milliseconds(std::stoi(parameter("pilot_ms"))));
    }
    std::uint64_t total_samples() const override { return pixels() * samples_per_pixel_; }
    std::uint64_t frame_samples() const override { return pixels(); }
    std::uint64_t done_samples() const override {
        return pixels() * done_ - (parameter("holes").empty() || done_ == 0 ? 0 : std::stoull(parameter("holes")));
    }
    bool render_batch() override {
        if (parameter("fail") == "memory")
            throw std::bad_alloc();
        if (parameter("fail") == "strange")
            throw 7;
        if (done_ == 3 && (parameter("fail") == "memory-later" || parameter("fail") == "memory-image"))
            throw std::bad_alloc();
        if (done_ == 3 && parameter("fail") == "device-later")
            throw Error(ExitCode::device, "the fake device is lost");
        if (!parameter("batch_ms").empty())
            std::this_thread::sleep_for(std::chrono::milliseconds(std::stoi(parameter("batch_ms"))));
        if (done_ == 0 && !parameter("patient_ms").empty())
            for (int slept = 0; slept < std::stoi(parameter("patient_ms")); slept += 2)
                sleep_or_stop();
        while (!parameter("endless").empty() && done_ >= std::stoull(parameter("endless")))
            sleep_or_stop();
        ++done_;
        return done_ < samples_per_pixel_;
    }
    Image mean_image() override {
        if (parameter("fail") == "memory-image")
            throw std::bad_alloc();
        return image_of(0.25f);
    }
    Image image() override {
        if (!parameter("image_ms").empty())
            std::this_thread::sleep_for(std::chrono::milliseconds(std::stoi(parameter("image_ms"))));
        if (parameter("fail") == "reconstruction")
            throw std::runtime_error("the fake guide is lost");
        if (parameter("fail") == "memory-image" || (parameter("fail") == "memory-partial" && done_ == 1))
            throw std::bad_alloc();
        return image_of(0.5f);
    }
    Image image_of(float blue) {
        imaged_ = done_;
        Image image;
        image.width = width_;
        image.height = height_;
        const auto add = [&](const char *name, float value) {
            image.channels.push_back({name, std::vector<float>(pixels(), value)});
        };
        add("R", float(seed_));
        add("G", float(done_));
        add("B", blue);
        if (aov_)
            add("albedo.R", 0.25f);
        if (!parameter("nan").empty())
            image.channels[2].values[0] = std::numeric_limits<float>::quiet_NaN();
        return image;
    }
    Statistics statistics() const override {
        if (parameter("fail") == "statistics" && done_ > 0)
            throw Error(ExitCode::device, "the fake device is lost");
        Statistics statistics;
        statistics.stages = {{"trace", 0.75, 100, 10}, {"camera", 0.25, 50, 5}};
        statistics.rays = {{"extension", 1000}};
        statistics.samples = done_samples();
        statistics.render_seconds = 1;
        if (error_ && !parameter("error").empty())
            statistics.estimated_error = std::stod(parameter("error")) / double(imaged_);
        if (automatic_)
            statistics.choice = MethodChoice{parameter("choice").empty() ? "gpt" : parameter("choice"),
                                             reason_,
                                             6,
                                             0.5,
                                             {{"pt", {2, 3}}, {"gpt", {0.25, 6}}},
                                             4};
        return statistics;
    }

  private:
    void sleep_or_stop() const {
        if (stop_())
            throw Stopped();
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    std::uint64_t pixels() const { return std::uint64_t(width_) * height_; }

    std::function<bool()> stop_;
    bool automatic_;
    std::string reason_ = "it was told to";
    std::uint64_t seed_;
    bool aov_, error_;
    std::uint64_t samples_per_pixel_, done_ = 0, imaged_ = 0;
    std::uint32_t width_ = 0, height_ = 0;
};

PreparedSolver prepare_fake_solver(const std::string &device, int, std::uint32_t width, std::uint32_t height,
                                   std::uint32_t channels) {
    if (device == "too small")
        throw Error(ExitCode::device, "the fake device is too small for " + std::to_string(width) + "x" +
                                          std::to_string(height) + " pixels");
    PreparedSolver solver;
    solver.description.name = "fake device";
    solver.solve = [count = std::size_t(width) * height * channels](const HostImages &images, const PoissonOptions &,
                                                                    float *result) {
        std::copy(images.primal, images.primal + count, result);
        PoissonReport report;
        report.method = "fake method";
        report.converged = true;
        report.seconds = 0.25;
        return report;
    };
    return solver;
}

} // namespace
} // namespace gradus

int main(int argc, char **argv) {
    gradus::Services services;
    services.load_scene = gradus::load_fake_scene;
    services.list_devices = [] { return std::vector<gradus::DeviceDescription>(); };
    services.method_names = [] { return std::vector<std::string>{"pt", "gpt", "sppm", "gpm", "auto"}; };
    services.programs_not_kept = [] { return std::uint64_t(std::getenv("FAKE_FULL_DISK") ? 1 : 0); };
    services.cache_folder = [] {
        const char *folder = std::getenv("FAKE_CACHE");
        return folder ? std::filesystem::path(folder) : std::filesystem::temp_directory_path();
    };
    services.traits = [](const gradus::Scene &) {
        return std::vector<std::pair<std::string, int>>{{"HAS_DIFFUSE", 1}, {"HAS_CONSTANT", 0}};
    };
    services.prepare = [](const std::string &method, const std::string &, const gradus::Scene &scene,
                          const gradus::RenderOptions &options) {
        gradus::PreparedMethod prepared;
        prepared.description.name = "fake device";
        prepared.method = std::make_unique<gradus::FakeMethod>(method, scene, options);
        return prepared;
    };
    services.prepare_solver = gradus::prepare_fake_solver;
    return gradus::run_program(argc, argv, services);
}
