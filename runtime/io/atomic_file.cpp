#include "runtime/io/atomic_file.h"

#include "runtime/error.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

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
    fs::path target = fs::absolute(path, failure);
    if (failure)
        fail(path, fmt::format("the working folder: {}", failure.message()));
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

constexpr const char *prefix = ".gradus-", *suffix = ".part";

/// Whether this name still is the file that is open.
bool is_named(int descriptor, const fs::path &name) {
    struct stat opened = {}, named = {};
    return ::fstat(descriptor, &opened) == 0 && ::lstat(name.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

/// Removes the temporary files in a folder that no process holds any more: those of runs that were killed.
void remove_abandoned(const fs::path &folder) {
    std::error_code failure;
    std::vector<fs::path> names;
    for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        if (name.starts_with(prefix) && name.ends_with(suffix))
            names.push_back(entry->path());
    }
    for (const fs::path &name : names) {
        const int descriptor = ::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
        if (descriptor < 0)
            continue;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && is_named(descriptor, name))
            ::unlink(name.c_str());
        ::close(descriptor);
    }
}

/// Whether a sticky folder, as /tmp is, lets this process put a file in the place of that.
bool may_replace(const fs::path &target) {
    struct stat file = {}, folder = {};
    if (::lstat(target.c_str(), &file) != 0 || ::stat(target.parent_path().c_str(), &folder) != 0)
        return true;
    const uid_t user = ::geteuid();
    return (folder.st_mode & S_ISVTX) == 0 || user == 0 || file.st_uid == user || folder.st_uid == user;
}

/// A new file beside its target that removes itself unless it was given the target's name. It is locked while its
/// process lives, so that others can tell it from what a killed one left.
class TemporaryFile {
  public:
    TemporaryFile(const std::string &path, const fs::path &target) : path_(path), target_(target) {
        // Hidden, and unique among the processes that may write to this folder; whoever else has the name keeps it.
        static std::atomic<unsigned> count{0};
        constexpr int most_tries = 10000;
        for (int i = 0; i < most_tries; ++i) {
            name_ = target.parent_path() / fmt::format("{}{}-{}{}", prefix, ::getpid(), count++, suffix);
            descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
            if (descriptor_ < 0) {
                if (errno == EEXIST)
                    continue;
                break;
            }
            // Some file systems have no locks; there nobody else gets one either. Between the two calls another run may
            // have taken the file for an abandoned one.
            (void)::flock(descriptor_, LOCK_EX);
            if (is_named(descriptor_, name_))
                return;
            ::close(descriptor_);
            descriptor_ = -1;
        }
        const int reason = errno;
        name_.clear();
        fail(path_, std::strerror(reason));
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
        // What its owner keeps from others stays so.
        struct stat replaced = {};
        if (::stat(target_.c_str(), &replaced) == 0)
            (void)::fchmod(descriptor_, replaced.st_mode & 07777);
        // A full disk may show only here; without the flush a crash could leave the new name on an empty file.
        if (::fsync(descriptor_) != 0)
            fail(path_, std::strerror(errno));
        // Still open, and so still locked: without that it would be an abandoned one for a moment.
        if (::rename(name_.c_str(), target_.c_str()) != 0)
            fail(path_, std::strerror(errno));
        name_.clear();
        ::close(descriptor_);
        descriptor_ = -1;
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

std::string written_file(const std::string &path) { return resolve_target(path).string(); }

void write_file_atomically(const std::string &path, const void *bytes, std::size_t size) {
    const fs::path target = resolve_target(path);
    TemporaryFile file(path, target);
    file.write(static_cast<const char *>(bytes), size);
    file.publish();
}

void check_writable(const std::string &path) {
    const fs::path target = resolve_target(path);
    remove_abandoned(target.parent_path());
    const TemporaryFile probe(path, target);
    // What the probe, whose name is another, does not meet.
    const long longest = ::pathconf(target.parent_path().c_str(), _PC_NAME_MAX);
    if (longest > 0 && target.filename().string().size() > std::size_t(longest))
        fail(path, std::strerror(ENAMETOOLONG));
    if (::access(target.c_str(), F_OK) == 0 && ::access(target.c_str(), W_OK) != 0)
        fail(path, "it is there, and write-protected");
    if (!may_replace(target))
        fail(path, "it is somebody else's, in a folder where only owners may replace files");
}

} // namespace gradus
