// A library with that part of Open Image Denoise's interface that is used, to test how it is used without it.
#include <cstddef>
#include <map>
#include <string>

namespace {

struct Image {
    float *data = nullptr;
    std::size_t pixels = 0;
};
struct Filter {
    std::map<std::string, Image> images;
    std::map<std::string, bool> flags;
};
int error = 0;

} // namespace

extern "C" {

void *oidnNewDevice(int type) { return type == 1 ? new int(0) : nullptr; }
void oidnSetDeviceInt(void *, const char *, int) {}
int oidnGetDeviceInt(void *, const char *name) {
    const std::string part(name);
    return part == "versionMajor" ? 2 : part == "versionMinor" ? 5 : 1;
}
void oidnCommitDevice(void *) {}
void oidnReleaseDevice(void *device) { delete static_cast<int *>(device); }
int oidnGetDeviceError(void *, const char **message) {
    *message = "of the stub";
    return error;
}
void *oidnNewFilter(void *, const char *type) { return std::string(type) == "RT" ? new Filter : nullptr; }
void oidnSetSharedFilterImage(void *filter, const char *name, void *data, int format, std::size_t width,
                              std::size_t height, std::size_t offset, std::size_t, std::size_t) {
    error = format == 3 && offset == 0 ? error : 2;
    static_cast<Filter *>(filter)->images[name] = {static_cast<float *>(data), width * height};
}
void oidnSetFilterBool(void *filter, const char *name, bool value) {
    static_cast<Filter *>(filter)->flags[name] = value;
}
void oidnSetFilterInt(void *, const char *, int) {}
void oidnCommitFilter(void *) {}
void oidnExecuteFilter(void *handle) {
    Filter &filter = *static_cast<Filter *>(handle);
    const Image &output = filter.images["output"];
    const auto has = [&](const char *name) { return filter.images.count(name) > 0; };
    for (std::size_t i = 0; i < 3 * output.pixels; ++i)
        if (!has("color"))
            output.data[i] = 2 * filter.images[has("albedo") ? "albedo" : "normal"].data[i];
        else if (has("albedo") && filter.flags["cleanAux"] && filter.flags["hdr"])
            output.data[i] = filter.images["color"].data[i] * filter.images["albedo"].data[i / 3 * 3] +
                             filter.images["normal"].data[i / 3 * 3 + 2];
        else
            output.data[i] = filter.images["color"].data[i];
}
void oidnReleaseFilter(void *filter) { delete static_cast<Filter *>(filter); }

} // extern "C"
