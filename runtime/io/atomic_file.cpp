#include "runtime/io/atomic_file.h"

#include "runtime/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>

namespace gradus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string &path, const std::string &reason) {
    throw Error(ExitCode::output, fmt::format("cannot write '{}': {}", path, reason));
}

/// The file that a write to `path` shall replace: links followed, the last component need not exist.
fs::path resolve_target(const std::string &path) {
    if (path.empty())
        fail(path, "the name is empty");
    std::error_code failure;
    fs::path target = fs::absolute(path);
    // By hand, as the library does not follow a link to a file that is not there yet.
    constexpr int most_links = 40;
    for (int i = 0; i < most_links && fs::is_symlink(fs::symlink_status(target, failure)); ++i) {
        const fs::path next = fs::read_symlink(target, failure);
        if (failure)
            fail(path, failure.message());
        target = target.parent_path() / next;
    }
    const fs::file_status status = fs::status(target, failure);
    if (fs::is_directory(status))
        fail(path, "it is a folder");
    if (fs::exists(status) && !fs::is_regular_file(status))
        fail(path, "it is not a regular file");
    const fs::path folder = target.parent_path();
    const fs::file_status folder_status = fs::status(folder, failure);
    if (!fs::exists(folder_status))
        fail(path, fmt::format("the folder '{}' does not exist", folder.string()));
    if (!fs::is_directory(folder_status))
        fail(path, fmt::format("'{}' is not a folder", folder.string()));
    return target;
}

/// A new file beside its target that removes itself unless it was given the target's name.
class TemporaryFile {
  public:
    TemporaryFile(const std::string &path, const fs::path &target) : path_(path), target_(target) {
        // Hidden, and unique among the processes that may write to this folder.
        static unsigned count = 0;
        name_ = target.parent_path() / fmt::format(".gradus-{}-{}.part", ::getpid(), count++);
        descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (descriptor_ < 0)
            fail(path_, std::strerror(errno));
    }
    ~TemporaryFile() {
        if (descriptor_ >= 0)
            ::close(descriptor_);
        if (!name_.empty())
            ::unlink(name_.c_str());
    }
    TemporaryFile(const TemporaryFile &) = delete;
    TemporaryFile &operator=(const TemporaryFile &) = delete;

    void write(const char *bytes, std::size_t size) {
        while (size > 0) {
            const ssize_t written = ::write(descriptor_, bytes, size);
            if (written < 0 && errno == EINTR)
                continue;
            if (written < 0)
                fail(path_, std::strerror(errno));
            bytes += written;
            size -= static_cast<std::size_t>(written);
        }
    }

    void publish() {
        // A full disk may show only here; without the flush a crash could leave the new name on an empty file.
        if (::fsync(descriptor_) != 0)
            fail(path_, std::strerror(errno));
        const int descriptor = descriptor_;
        descriptor_ = -1;
        if (::close(descriptor) != 0)
            fail(path_, std::strerror(errno));
        if (::rename(name_.c_str(), target_.c_str()) != 0)
            fail(path_, std::strerror(errno));
        name_.clear();
        // The rename is safe from a crash once its folder is on the disk. Some file systems refuse: no harm.
        const int folder = ::open(target_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (folder >= 0) {
            (void)::fsync(folder);
            ::close(folder);
        }
    }

  private:
    std::string path_;
    fs::path target_, name_;
    int descriptor_ = -1;
};

} // namespace

void write_file_atomically(const std::string &path, const void *bytes, std::size_t size) {
    const fs::path target = resolve_target(path);
    TemporaryFile file(path, target);
    file.write(static_cast<const char *>(bytes), size);
    file.publish();
}

void check_writable(const std::string &path) {
    const fs::path target = resolve_target(path);
    const TemporaryFile probe(path, target);
}

} // namespace gradus
