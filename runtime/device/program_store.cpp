#include "runtime/device/program_store.h"

#include "runtime/device/byte_text.h"
#include "runtime/device/hash.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

namespace gradus {

namespace fs = std::filesystem;

namespace {

std::atomic<std::uint64_t> lost{0}; ///< files that could not be written

/// Changes with the layout of the files.
constexpr std::string_view magic = "gradus program 1\n";
constexpr const char *suffix = ".program", *alias_suffix = ".alias", *unfinished = ".unfinished-";
/// The name of a file is one hash of its key, its head holds another: a file that was renamed is seen.
constexpr std::uint64_t seed_in_name = 1, seed_in_head = 2, seed_of_content = 3;

/// Whether a file of that name is one of the store's, written or being written: others may lie in its folder.
bool is_ours(std::string_view name) {
    const std::size_t digits = std::min(name.find_first_not_of("0123456789abcdef"), name.size());
    if (digits != 2 * sizeof(Hash128))
        return false;
    name.remove_prefix(digits);
    name = name.substr(0, name.find(unfinished));
    return name == suffix || name == alias_suffix;
}

void write_hash(ByteWriter &writer, const Hash128 &hash) {
    writer.number(hash.low);
    writer.number(hash.high);
}

Hash128 read_hash(ByteReader &reader) {
    const std::uint64_t low = reader.number();
    return {low, reader.number()};
}

std::string file_content(const std::string &key, const std::string &payload) {
    ByteWriter writer;
    write_hash(writer, hash128(key, seed_in_head));
    write_hash(writer, hash128(payload, seed_of_content));
    writer.text(payload);
    return std::string(magic) + writer.bytes();
}

/// Throws std::runtime_error for anything but what file_content() wrote for this key.
std::string_view checked_payload(const std::string &key, std::string_view content) {
    if (!content.starts_with(magic))
        throw std::runtime_error("not a program, or one of another version");
    ByteReader reader(content.substr(magic.size()));
    if (read_hash(reader) != hash128(key, seed_in_head))
        throw std::runtime_error("a program of another key");
    const Hash128 checksum = read_hash(reader);
    const std::string_view payload = reader.text();
    if (!reader.rest().empty() || checksum != hash128(payload, seed_of_content))
        throw std::runtime_error("a damaged program");
    return payload;
}

/// None where there is no such file. Throws as checked_payload() does.
std::optional<std::string> payload_of(const fs::path &path, const std::string &key) {
    std::error_code absent;
    const fs::file_type type = fs::status(path, absent).type();
    if (type == fs::file_type::not_found)
        return std::nullopt;
    if (type != fs::file_type::regular) // a device may have no end, and a pipe waits for a writer
        throw std::runtime_error("no file");
    std::ifstream file(path, std::ios::binary);
    if (!file)
        return std::nullopt;
    const std::string content{std::istreambuf_iterator<char>(file), {}};
    std::string payload(checked_payload(key, content));
    utimensat(AT_FDCWD, path.c_str(), nullptr, 0); // trim() goes by the time of the last use
    return payload;
}

bool write_all(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = write(file, bytes.data(), bytes.size());
        if (written <= 0)
            return false;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

} // namespace

ProgramStore::ProgramStore(fs::path folder, std::uint64_t limit) : folder_(std::move(folder)), limit_(limit) {}

fs::path ProgramStore::file_of(const std::string &key) const {
    return folder_ / (hexadecimal(hash128(key, seed_in_name)) + suffix);
}

fs::path ProgramStore::alias_file_of(const std::string &key) const {
    return folder_ / (hexadecimal(hash128(key, seed_in_name)) + alias_suffix);
}

std::optional<ProgramImage> ProgramStore::find(const std::string &key) const {
    if (!is_on())
        return std::nullopt;
    try {
        if (const std::optional<std::string> payload = payload_of(file_of(key), key))
            return program_image(*payload);
    } catch (const std::runtime_error &) {
        remove(key);
    }
    return std::nullopt;
}

std::optional<std::string> ProgramStore::find_alias(const std::string &key) const {
    if (!is_on())
        return std::nullopt;
    try {
        return payload_of(alias_file_of(key), key);
    } catch (const std::runtime_error &) {
        return std::nullopt; // and is written anew
    }
}

void ProgramStore::put(const std::string &key, const ProgramImage &image) const {
    if (is_on())
        write(file_of(key), file_content(key, to_bytes(image)));
}

void ProgramStore::put_alias(const std::string &key, const std::string &other) const {
    if (is_on())
        write(alias_file_of(key), file_content(key, other));
}

void ProgramStore::write(const fs::path &path, const std::string &content) const {
    std::error_code ignored;
    fs::create_directories(folder_, ignored);
    std::string temporary = path.string() + unfinished + "XXXXXX";
    const int file = mkostemp(temporary.data(), O_CLOEXEC);
    if (file < 0) {
        ++lost;
        return;
    }
    // No fsync: after a crash the checksum tells.
    const bool written = write_all(file, content);
    const bool closed = close(file) == 0;
    if (!written || !closed || std::rename(temporary.c_str(), path.c_str()) != 0) {
        unlink(temporary.c_str());
        ++lost;
    }
}

std::uint64_t programs_not_kept() { return lost; }

void ProgramStore::remove(const std::string &key) const {
    std::error_code ignored;
    if (is_on())
        fs::remove(file_of(key), ignored);
}

void ProgramStore::trim() const {
    if (!is_on())
        return;
    struct Entry {
        fs::file_time_type used;
        std::uint64_t bytes;
        fs::path path;
    };
    std::vector<Entry> entries;
    std::uint64_t total = 0;
    std::error_code failure;
    const auto now = fs::file_time_type::clock::now();
    for (fs::directory_iterator file(folder_, failure), end; !failure && file != end; file.increment(failure)) {
        const std::string name = file->path().filename().string();
        if (!is_ours(name))
            continue;
        std::error_code gone;
        const auto used = fs::last_write_time(file->path(), gone);
        const std::uint64_t bytes = gone ? 0 : fs::file_size(file->path(), gone);
        if (gone)
            continue; // by another process
        // What another process is writing now is young; the rest is of processes that were killed.
        if (name.find(unfinished) != std::string::npos) {
            if (now - used > std::chrono::hours(1))
                fs::remove(file->path(), gone);
            continue;
        }
        entries.push_back({used, bytes, file->path()});
        total += bytes;
    }
    std::sort(entries.begin(), entries.end(), [](const Entry &a, const Entry &b) { return a.used < b.used; });
    for (const Entry &entry : entries) {
        if (total <= limit_)
            break;
        std::error_code gone;
        fs::remove(entry.path, gone);
        total -= entry.bytes;
    }
}

} // namespace gradus
