#include "runtime/io/open_file.h"

#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace gradus {
namespace fs = std::filesystem;

namespace {

std::string alias_of(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

mode_t kind_of(int descriptor) {
    struct stat status {};
    return descriptor >= 0 && ::fstat(descriptor, &status) == 0 ? status.st_mode & S_IFMT : 0;
}

} // namespace

Place::Place(const fs::path &path) : descriptor_(::open(path.empty() ? "." : path.c_str(), O_PATH | O_CLOEXEC)) {}

Place::~Place() {
    if (descriptor_ >= 0)
        ::close(descriptor_);
}

bool Place::is_file() const { return kind_of(descriptor_) == S_IFREG; }

bool Place::is_folder() const { return kind_of(descriptor_) == S_IFDIR; }

fs::path Place::path() const {
    if (descriptor_ < 0)
        return {};
    std::error_code error;
    const fs::path path = fs::read_symlink(alias(), error);
    return error || !path.is_absolute() ? fs::path() : path;
}

std::string Place::alias() const { return alias_of(descriptor_); }

std::shared_ptr<const OpenFile> OpenFile::open(const fs::path &path, const AllowsPlace &allows) {
    const Place place(path);
    if (!place.is_file())
        return nullptr;
    const std::shared_ptr<OpenFile> file(new OpenFile);
    file->name_ = path;
    file->place_ = place.path();
    file->is_confined_ = bool(allows);
    if (allows && (file->place_.empty() || !allows(file->place_)))
        return nullptr;
    file->descriptor_ = ::open(place.alias().c_str(), O_RDONLY | O_CLOEXEC);
    if (file->descriptor_ < 0 && !allows) // a system without /proc
        file->descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status {};
    if (file->descriptor_ < 0 || ::fstat(file->descriptor_, &status) != 0 || !S_ISREG(status.st_mode))
        return nullptr;
    file->bytes_ = std::uint64_t(status.st_size);
    file->library_name_ = allows ? alias_of(file->descriptor_) : path.string();
    if (file->place_.empty())
        file->place_ = path;
    return file;
}

OpenFile::~OpenFile() {
    if (descriptor_ >= 0)
        ::close(descriptor_);
}

std::optional<std::string> OpenFile::read() const {
    std::string text(bytes_, '\0');
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t count = ::pread(descriptor_, text.data() + done, text.size() - done, off_t(done));
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            return std::nullopt;
        done += std::size_t(count);
    }
    return text;
}

std::string why_not(const std::filesystem::path &path) {
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(path, failure);
    if (status.type() == std::filesystem::file_type::not_found)
        return ": there is none of that name";
    if (std::filesystem::is_directory(status))
        return ": it is a folder";
    if (failure)
        return ": " + failure.message();
    if (!std::filesystem::is_regular_file(status))
        return ": it is no regular file";
    return ::access(path.c_str(), R_OK) != 0 ? ": " + std::generic_category().message(errno) : "";
}

} // namespace gradus
