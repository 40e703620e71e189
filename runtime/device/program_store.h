// A folder of compiled programs that several processes share.
#pragma once

#include "runtime/device/program_image.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace gradus {

constexpr std::uint64_t program_store_bytes = std::uint64_t(512) << 20;

/// Programs by a key: a text that says all that the code depends on. Several texts may say the same, one of them in
/// fewer words: the others are aliases of it. Each entry is a file of its own that appears whole, by a rename, so
/// readers and writers need no lock. Nothing here is an error: what cannot be read or written is not there.
class ProgramStore {
  public:
    /// An empty folder: nothing is kept. `limit` is what the files may take in all.
    explicit ProgramStore(std::filesystem::path folder = {}, std::uint64_t limit = program_store_bytes);

    bool is_on() const { return !folder_.empty(); }
    /// None where there is no entry. One that is cut off, damaged or of another key is deleted.
    std::optional<ProgramImage> find(const std::string &key) const;
    void put(const std::string &key, const ProgramImage &image) const;
    void remove(const std::string &key) const;
    /// The key that this one is an alias of.
    std::optional<std::string> find_alias(const std::string &key) const;
    void put_alias(const std::string &key, const std::string &other) const;
    /// Deletes the entries that were not used for the longest time, where all take more than the limit. Scans the
    /// folder: once after several put() is enough.
    void trim() const;

    std::filesystem::path file_of(const std::string &key) const;
    std::filesystem::path alias_file_of(const std::string &key) const;

  private:
    void write(const std::filesystem::path &path, const std::string &content) const;

    std::filesystem::path folder_;
    std::uint64_t limit_;
};

/// How many files of this process's stores could not be written: the disk is full, or its folder is gone.
std::uint64_t programs_not_kept();

} // namespace gradus
