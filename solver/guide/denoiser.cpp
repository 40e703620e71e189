#include "solver/guide/denoiser.h"

#include "runtime/error.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <vector>

namespace gradus {

namespace {

constexpr const char *usual_names[] = {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so",
                                       "libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"};
constexpr const char *variable = "GRADUS_DENOISER";
/// Values of the library's enumerations.
constexpr int device_type_cpu = 1, format_float3 = 3, quality_high = 6;

using Handle = void *;

} // namespace

/// What is used of the library's C interface, version 2.
struct Denoiser::Library {
    void *file = nullptr;
    Handle (*new_device)(int type) = nullptr;
    void (*set_device_int)(Handle, const char *, int) = nullptr;
    int (*get_device_int)(Handle, const char *) = nullptr;
    void (*commit_device)(Handle) = nullptr;
    void (*release_device)(Handle) = nullptr;
    int (*get_device_error)(Handle, const char **) = nullptr;
    Handle (*new_filter)(Handle device, const char *type) = nullptr;
    void (*set_image)(Handle filter, const char *name, void *data, int format, std::size_t width, std::size_t height,
                      std::size_t offset, std::size_t pixel_stride, std::size_t row_stride) = nullptr;
    void (*set_bool)(Handle filter, const char *, bool) = nullptr;
    void (*set_int)(Handle filter, const char *, int) = nullptr;
    void (*commit_filter)(Handle) = nullptr;
    void (*execute_filter)(Handle) = nullptr;
    void (*release_filter)(Handle) = nullptr;
    Handle device = nullptr;

    ~Library() {
        if (device)
            release_device(device);
        // The file stays: threads of its own may still be on their way out of it.
    }

    bool open(const std::string &name) { return (file = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) != nullptr; }

    template <class Function>
    void find(Function *&function, const char *name) {
        function = reinterpret_cast<Function *>(dlsym(file, name));
        if (!function)
            throw Error(ExitCode::usage, fmt::format("the denoiser's library has no {}: Gradus needs Open Image "
                                                     "Denoise 2.0 or later",
                                                     name));
    }

    void find_all() {
        find(new_device, "oidnNewDevice");
        find(set_device_int, "oidnSetDeviceInt");
        find(get_device_int, "oidnGetDeviceInt");
        find(commit_device, "oidnCommitDevice");
        find(release_device, "oidnReleaseDevice");
        find(get_device_error, "oidnGetDeviceError");
        find(new_filter, "oidnNewFilter");
        find(set_image, "oidnSetSharedFilterImage");
        find(set_bool, "oidnSetFilterBool");
        find(set_int, "oidnSetFilterInt");
        find(commit_filter, "oidnCommitFilter");
        find(execute_filter, "oidnExecuteFilter");
        find(release_filter, "oidnReleaseFilter");
    }

    void check(const char *what) {
        const char *message = nullptr;
        if (get_device_error(device, &message) != 0)
            throw Error(ExitCode::device, fmt::format("the denoiser failed {}: {}", what, message ? message : ""));
    }

    /// By the filter's names of images, pixel by pixel.
    using Inputs = std::map<std::string, const std::vector<float> *>;

    /// The denoised color; where there is none, the one image that there is.
    std::vector<float> filtered(const Inputs &inputs, std::size_t width, std::size_t height) {
        struct Filter {
            Library &library;
            Handle handle;
            ~Filter() { library.release_filter(handle); }
        } filter{*this, new_filter(device, "RT")};
        std::vector<float> output(3 * width * height);
        for (const auto &[name, values] : inputs) // which the library only reads
            set_image(filter.handle, name.c_str(), const_cast<float *>(values->data()), format_float3, width, height, 0,
                      0, 0);
        set_image(filter.handle, "output", output.data(), format_float3, width, height, 0, 0, 0);
        set_int(filter.handle, "quality", quality_high);
        if (inputs.contains("color")) {
            set_bool(filter.handle, "hdr", true);
            set_bool(filter.handle, "cleanAux", inputs.size() > 1);
        }
        commit_filter(filter.handle);
        execute_filter(filter.handle);
        check("to denoise");
        return output;
    }
};

namespace {

/// Pixel by pixel, as the library reads images.
std::vector<float> interleaved(const float *planes, std::size_t pixels) {
    std::vector<float> values(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = planes[c * pixels + i];
            values[3 * i + c] = std::isfinite(value) ? value : 0;
        }
    return values;
}

} // namespace

Denoiser::Denoiser(const std::string &library, int threads) : library_(std::make_unique<Library>()) {
    const char *named = std::getenv(variable);
    const std::string asked = !library.empty() ? library : named ? named : "";
    bool found = false;
    std::string reason; // why not the first of them
    for (const std::string &name : asked.empty()
                                       ? std::vector<std::string>(std::begin(usual_names), std::end(usual_names))
                                       : std::vector<std::string>{asked}) {
        found = found || library_->open(name);
        if (const char *text = found ? nullptr : dlerror(); text && reason.empty())
            reason = text;
    }
    if (!found) {
        throw Error(
            ExitCode::usage,
            fmt::format("no Open Image Denoise: {}. Install its library (libOpenImageDenoise.so.2, from "
                        "https://www.openimagedenoise.org, or as the Python package pyoidn holds it), and let {} "
                        "name the file where the system does not find it",
                        reason, variable));
    }
    library_->find_all();
    library_->device = library_->new_device(device_type_cpu);
    if (!library_->device)
        throw Error(ExitCode::device, "the denoiser has no device for this processor");
    if (threads > 0)
        library_->set_device_int(library_->device, "numThreads", threads);
    library_->commit_device(library_->device);
    library_->check("to start");
}

Denoiser::~Denoiser() = default;

std::string Denoiser::version() const {
    const auto part = [&](const char *name) { return library_->get_device_int(library_->device, name); };
    return fmt::format("{}.{}.{}", part("versionMajor"), part("versionMinor"), part("versionPatch"));
}

Denoiser::Features Denoiser::cleaned(const float *albedo, const float *normal, std::uint32_t width,
                                     std::uint32_t height) {
    const std::size_t pixels = std::size_t(width) * height;
    const std::vector<float> given_albedo = interleaved(albedo, pixels), given_normal = interleaved(normal, pixels);
    return {library_->filtered({{"albedo", &given_albedo}}, width, height),
            library_->filtered({{"normal", &given_normal}}, width, height)};
}

void Denoiser::run(const float *color, const Features &features, std::uint32_t width, std::uint32_t height,
                   float *result) {
    const std::size_t pixels = std::size_t(width) * height;
    const std::vector<float> given = interleaved(color, pixels);
    Library::Inputs inputs{{"color", &given}};
    if (!features.albedo.empty())
        inputs = {{"color", &given}, {"albedo", &features.albedo}, {"normal", &features.normal}};
    const std::vector<float> denoised = library_->filtered(inputs, width, height);
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            result[c * pixels + i] = denoised[3 * i + c];
}

} // namespace gradus
