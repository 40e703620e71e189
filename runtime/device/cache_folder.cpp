#include "runtime/device/cache_folder.h"

#include "runtime/user_cache_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <utility>

namespace gradus {

namespace fs = std::filesystem;

namespace {

// A folder is named `locked` once its owner holds a lock on it, which the system takes back when that process ends.
constexpr const char *locked = "gradus-running-", *not_yet_locked = "gradus-starting-";

// Enough for the programs of a render and for what compiles them.
constexpr double least_free_bytes = 256 << 20, least_free_files = 10000;

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

/// How much room there is for code that can be run from there, of what is enough.
double room_for_code(const fs::path &folder) {
    struct statvfs system = {};
    if (folder.empty() || access(folder.c_str(), W_OK | X_OK) != 0 || statvfs(folder.c_str(), &system) != 0 ||
        (system.f_flag & ST_NOEXEC))
        return 0;
    const double bytes = double(system.f_bavail) * double(system.f_frsize) / least_free_bytes;
    // Some file systems have no limit of files, and say 0.
    return system.f_files > 0 ? std::min(bytes, double(system.f_favail) / least_free_files) : bytes;
}

/// In memory where that is possible: PoCL waits for the disk after each of its many small files, and a disk may take
/// seconds to delete them.
fs::path folder_for_code() {
    std::error_code ignored;
    const fs::path kept = program_cache_folder();
    if (!kept.empty())
        fs::create_directories(kept, ignored);
    const fs::path temporary = fs::temp_directory_path(ignored);
    const fs::path chosen = folder_with_room({"/dev/shm", kept, temporary}, room_for_code);
    // Nobody above asks for warnings, and what PoCL says of it is that kernels do not compile.
    if (chosen.empty() && !std::getenv("POCL_CACHE_DIR"))
        std::fputs(fmt::format("gradus: warning: of the folders '/dev/shm', '{}' and '{}' none is there that can be "
                               "written to and that programs can be run from: where kernels do not compile, set "
                               "POCL_CACHE_DIR to one that is\n",
                               kept.string(), temporary.string())
                       .c_str(),
                   stderr);
    return chosen;
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

fs::path folder_with_room(const std::vector<fs::path> &folders, const std::function<double(const fs::path &)> &room) {
    fs::path best;
    double most = 0;
    for (const fs::path &folder : folders) {
        const double here = room(folder);
        if (here >= 1)
            return folder;
        if (here > most) {
            most = here;
            best = folder;
        }
    }
    return best;
}

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
