// Files that are open. What a name means may change between two looks at it; what was opened stays what it is, so it is
// this that is judged, and read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace gradus {

/// A file or folder that was found by its name, not yet read: opening it so does nothing to what it is.
class Place {
  public:
    explicit Place(const std::filesystem::path &path);
    ~Place();
    Place(const Place &) = delete;
    Place &operator=(const Place &) = delete;

    bool is_file() const;
    bool is_folder() const;
    /// Where it lies, all links resolved. Empty where nothing is there, or the system does not tell (it takes /proc).
    std::filesystem::path path() const;
    /// A name that leads to it, whatever its own name leads to by now, as long as this object lives. It takes /proc.
    std::string alias() const;

  private:
    int descriptor_;
};

/// Decides by where a file lies.
using AllowsPlace = std::function<bool(const std::filesystem::path &place)>;

/// A regular file that may be read.
class OpenFile {
  public:
    /// nullptr where there is none or it cannot be read; with `allows`, also where that is false of its place. Without,
    /// any file will do.
    static std::shared_ptr<const OpenFile> open(const std::filesystem::path &path, const AllowsPlace &allows = {});
    ~OpenFile();
    OpenFile(const OpenFile &) = delete;
    OpenFile &operator=(const OpenFile &) = delete;

    /// As it was given.
    const std::filesystem::path &name() const { return name_; }
    /// Where it lies, links resolved; its name where the system does not tell.
    const std::filesystem::path &place() const { return place_; }
    /// For libraries that open files themselves: an alias of what was allowed, else the name.
    const std::string &library_name() const { return library_name_; }
    /// It was chosen by its place.
    bool is_confined() const { return is_confined_; }
    std::uint64_t bytes() const { return bytes_; }
    /// The whole file, or nothing where it cannot be read or has become shorter.
    std::optional<std::string> read() const;

  private:
    OpenFile() = default;
    std::filesystem::path name_, place_;
    std::string library_name_;
    int descriptor_ = -1;
    bool is_confined_ = false;
    std::uint64_t bytes_ = 0; ///< when it was opened
};

/// Why a file cannot be read, where that is known: ": ...".
std::string why_not(const std::filesystem::path &path);

} // namespace gradus
