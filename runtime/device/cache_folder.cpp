#include "runtime/device/cache_folder.h"

#include "runtime/user_cache_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <string>
#include <utility>

namespace gradus {

namespace fs = std::filesystem;

namespace {

// A folder is named `locked` once its owner holds a lock on it, which the system takes back when that process ends.
constexpr const char *locked = "gradus-running-", *not_yet_locked = "gradus-starting-";

constexpr std::uint64_t least_free_bytes = std::uint64_t(256) << 20;

int locked_folder(const fs::path &folder) {
    const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0)
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

void delete_what_others_left(const fs::path &parent) {
    std::error_code failure, ignored;
    for (fs::directory_iterator entry(parent, failure), end; !failure && entry != end; entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        const bool is_starting = name.starts_with(not_yet_locked);
        if (!is_starting && !name.starts_with(locked))
            continue;
        const auto age = fs::file_time_type::clock::now() - fs::last_write_time(entry->path(), ignored);
        if (ignored || (is_starting && age < std::chrono::hours(1)))
            continue;
        const int file = locked_folder(entry->path());
        if (file < 0)
            continue; // its process lives
        fs::remove_all(entry->path(), ignored);
        close(file);
    }
}

/// Whether code that is written there can be run.
bool takes_code(const fs::path &folder) {
    struct statvfs system = {};
    return !folder.empty() && access(folder.c_str(), W_OK | X_OK) == 0 && statvfs(folder.c_str(), &system) == 0 &&
           !(system.f_flag & ST_NOEXEC) && std::uint64_t(system.f_bavail) * system.f_frsize >= least_free_bytes;
}

/// In memory where that is possible: PoCL waits for the disk after each of its many small files, and a disk may take
/// seconds to delete them.
fs::path folder_for_code() {
    std::error_code ignored;
    const fs::path kept = program_cache_folder();
    if (!kept.empty())
        fs::create_directories(kept, ignored);
    for (const fs::path &folder : {fs::path("/dev/shm"), kept, fs::temp_directory_path(ignored)})
        if (takes_code(folder))
            return folder;
    return {};
}

class PrivateFolder {
  public:
    explicit PrivateFolder(const fs::path &parent) {
        std::error_code ignored;
        if (parent.empty())
            return;
        delete_what_others_left(parent);
        std::string name = (parent / (std::string(not_yet_locked) + "XXXXXX")).string();
        if (!mkdtemp(name.data()))
            return;
        path_ = name;
        lock_ = locked_folder(path_);
        const fs::path final_path = parent / (locked + name.substr(name.size() - 6));
        fs::rename(path_, final_path, ignored);
        if (!ignored)
            path_ = final_path;
    }
    ~PrivateFolder() {
        std::error_code ignored;
        // A child of fork() that ends by exit() comes here too.
        if (!path_.empty() && getpid() == owner_)
            fs::remove_all(path_, ignored);
        if (lock_ >= 0)
            close(lock_);
    }
    const fs::path &path() const { return path_; }

    /// Makes the folder again where it was deleted, by the same name. Returns how often that was so.
    unsigned renew() {
        const std::lock_guard lock(mutex_);
        struct stat folder = {};
        if (lock_ < 0 || fstat(lock_, &folder) != 0 || folder.st_nlink > 0)
            return renewals_;
        mkdir(path_.c_str(), S_IRWXU); // which PoCL may have done, too
        const int lock_of_new = locked_folder(path_);
        if (lock_of_new < 0)
            return renewals_;
        close(std::exchange(lock_, lock_of_new));
        return ++renewals_;
    }

  private:
    fs::path path_;
    int lock_ = -1; ///< the open folder
    pid_t owner_ = getpid();
    std::mutex mutex_;
    unsigned renewals_ = 0;
};

} // namespace

fs::path program_cache_folder() {
    if (const char *chosen = std::getenv("GRADUS_CACHE_DIR")) {
        const std::string folder = chosen;
        std::error_code ignored; // the working folder may be gone: then nothing is kept
        return folder.empty() || folder == "off" ? fs::path() : fs::absolute(folder, ignored);
    }
    const fs::path cache = user_cache_folder();
    return cache.empty() ? fs::path() : cache / "gradus" / "programs";
}

namespace {

PrivateFolder &folder_of_process() {
    static PrivateFolder folder(folder_for_code());
    return folder;
}

} // namespace

fs::path private_folder() { return folder_of_process().path(); }

unsigned renewals_of_private_folder() { return folder_of_process().renew(); }

} // namespace gradus
