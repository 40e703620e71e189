#include "runtime/io/picture_library.h"

#include "runtime/companion_file.h"
#include "runtime/error.h"
#include "runtime/version.h"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <filesystem>
#include <string>

namespace gradus {
namespace {

[[noreturn]] void fail(const std::string &reason) {
    throw Error(ExitCode::failure,
                fmt::format("image files cannot be read or written: {}; install Gradus again, or build it", reason));
}

std::filesystem::path file_of_library() {
    if (const char *chosen = std::getenv("GRADUS_PICTURES"))
        return chosen;
    return companion_file(GRADUS_PICTURES_OF_BUILD, GRADUS_PICTURES_OF_INSTALLATION);
}

const PictureLibrary &load() {
    const std::string path = file_of_library().string();
    if (path.empty())
        fail(fmt::format("gradus-pictures.so is neither beside the program nor at '{}'",
                         GRADUS_PICTURES_OF_INSTALLATION));
    // Never closed: what it returns is freed by functions of its libraries.
    void *const handle = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (!handle) {
        const std::string reason = dlerror();
        // As the loader says it: "failed to map segment from shared object", "cannot allocate memory".
        if (reason.find("map segment") != std::string::npos || reason.find("allocate") != std::string::npos)
            throw Error(ExitCode::device,
                        fmt::format("there is not enough memory to load what reads and writes images: {}", reason));
        fail(reason);
    }
    const auto *library = static_cast<const PictureLibrary *>(dlsym(handle, "gradus_picture_library"));
    if (!library || std::strcmp(library->version, GRADUS_VERSION) != 0)
        fail(fmt::format("'{}' is not of Gradus {}", path, GRADUS_VERSION));
    return *library;
}

} // namespace

const PictureLibrary &picture_library() {
    static const PictureLibrary &library = load();
    return library;
}

} // namespace gradus
