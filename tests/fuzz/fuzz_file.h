// An input as a file, for readers that take paths.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace gradus {

/// A folder in memory where there is one, removed at the end.
class FuzzFolder {
  public:
    FuzzFolder() {
        const bool in_memory = std::filesystem::is_directory("/dev/shm");
        std::string name = std::string(in_memory ? "/dev/shm" : "/tmp") + "/gradus-fuzz-XXXXXX";
        if (!::mkdtemp(name.data()))
            std::abort();
        path_ = name;
    }
    ~FuzzFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    std::string write(const std::string &name, const void *data, std::size_t size) const {
        const std::string path = path_ + "/" + name;
        std::ofstream(path, std::ios::binary).write(static_cast<const char *>(data), std::streamsize(size));
        return path;
    }

    const std::string &path() const { return path_; }

  private:
    std::string path_;
};

} // namespace gradus
