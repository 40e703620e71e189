#include "bench/render/measurements.h"
#include "runtime/error.h"
#include "runtime/io/load_scene.h"
#include "runtime/phases.h"
#include "runtime/seconds_since.h"
#include "runtime/trace/embree.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace gradus::bench {

namespace {

/// What the scene's file names that lies beside it, and itself. Throws Error where a file is not there, or its name has
/// a parameter, which is not looked up here.
std::vector<std::filesystem::path> files_of(const std::filesystem::path &scene) {
    std::ifstream in(scene);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string before = "name=\"filename\" value=\"";
    std::set<std::filesystem::path> files{scene};
    for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
        at += before.size();
        files.insert(scene.parent_path() / text.substr(at, text.find('"', at) - at));
    }
    for (const std::filesystem::path &file : files)
        if (!std::filesystem::exists(file))
            throw Error(ExitCode::scene,
                        fmt::format("{}: there is no file {}; files named by parameters cannot be measured",
                                    scene.string(), file.string()));
    return {files.begin(), files.end()};
}

bool is_picture(const std::filesystem::path &file) {
    static const std::set<std::string> kinds = {".png", ".jpg", ".exr", ".hdr", ".tga"};
    return kinds.contains(file.extension().string());
}

/// Pictures are decoded into memory as they are stored, other files read.
double seconds_of_reading(const std::filesystem::path &file) {
    const auto begun = std::chrono::steady_clock::now();
    if (is_picture(file)) {
        const auto picture = OIIO::ImageInput::open(file.string());
        if (!picture)
            throw Error(ExitCode::image, "cannot read " + file.string());
        const OIIO::ImageSpec &spec = picture->spec();
        std::vector<std::byte> pixels(spec.image_bytes(true));
        picture->read_image(0, 0, 0, spec.nchannels, spec.format, pixels.data());
    } else {
        std::vector<char> bytes(std::filesystem::file_size(file));
        std::ifstream(file, std::ios::binary).read(bytes.data(), std::streamsize(bytes.size()));
    }
    return seconds_since(begun);
}

/// Of the tree alone, of all triangles in one geometry, as good as ours.
double seconds_of_embree(const Scene &scene, int threads) {
    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene built) const { rtcReleaseScene(built); }
    };
    const std::string configuration = threads > 0 ? fmt::format("threads={}", threads) : "";
    const std::unique_ptr<RTCDeviceTy, Release> device(rtcNewDevice(configuration.c_str()));
    const std::unique_ptr<RTCSceneTy, Release> built(rtcNewScene(device.get()));
    rtcSetSceneBuildQuality(built.get(), RTC_BUILD_QUALITY_HIGH);
    std::size_t vertices = 0, triangles = 0;
    for (const Mesh &mesh : scene.meshes)
        vertices += mesh.positions.size(), triangles += mesh.triangles.size();
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *vertex = static_cast<Vector3 *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vector3), vertices));
    auto *triangle = static_cast<std::uint32_t *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles));
    std::uint32_t first = 0;
    for (const Mesh &mesh : scene.meshes) {
        vertex = std::copy(mesh.positions.begin(), mesh.positions.end(), vertex);
        for (const auto &corners : mesh.triangles)
            for (const std::uint32_t corner : corners)
                *triangle++ = first + corner;
        first += std::uint32_t(mesh.positions.size());
    }
    const auto begun = std::chrono::steady_clock::now();
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(built.get(), geometry);
    rtcCommitScene(built.get());
    const double seconds = seconds_since(begun);
    rtcReleaseGeometry(geometry);
    return seconds;
}

} // namespace

nlohmann::json measure_loading(const Settings &settings, const std::string &path) {
    const std::vector<std::filesystem::path> files = files_of(path);
    std::uint64_t bytes = 0;
    for (const std::filesystem::path &file : files)
        bytes += std::filesystem::file_size(file);
    std::vector<double> ratios, loads, reads, trees;
    std::map<std::string, std::vector<double>> by_phase;
    for (int turn = 0; turn < settings.repeats; ++turn) {
        Phases phases;
        LoadOptions loading;
        loading.phases = &phases;
        Job job{"", load_scene(path, loading).scene};
        job.scene.film.width = job.scene.film.height = 16;
        RenderOptions options;
        options.threads = settings.threads;
        options.phases = &phases;
        method_of(settings, job, options);
        double seconds = 0;
        for (const Phases::Time &time : phases.times())
            if (const std::string key = time.name.key;
                key != phase_names::device.key && key != phase_names::compile.key) {
                by_phase[key].push_back(time.seconds);
                seconds += time.seconds;
            }
        double read = 0;
        for (const std::filesystem::path &file : files)
            read += seconds_of_reading(file);
        loads.push_back(seconds);
        reads.push_back(read);
        trees.push_back(seconds_of_embree(job.scene, settings.threads));
        ratios.push_back(seconds / (read + trees.back()));
    }
    fmt::print(
        "{}, {:.0f} MiB\n  loading {:.2f} s over reading or decoding {:.2f} s and Embree's tree {:.2f} s: {:.2f}\n ",
        std::filesystem::path(path).stem().string(), double(bytes) / (1 << 20), median(loads), median(reads),
        median(trees), median(ratios));
    nlohmann::json seconds_by_phase;
    for (const auto &[key, seconds] : by_phase) {
        fmt::print(" {} {:.2f} s", key, median(seconds));
        seconds_by_phase[key] = spread(seconds);
    }
    fmt::print("\n\n");
    return {{"scene", path},
            {"bytes", bytes},
            {"ratio", spread(ratios)},
            {"load_seconds", spread(loads)},
            {"read_seconds", spread(reads)},
            {"tree_seconds", spread(trees)},
            {"phases", seconds_by_phase}};
}

} // namespace gradus::bench
