// Pictures of a scene, decoded on several threads before the loader asks for them, which it does one after the other.
#pragma once

#include "runtime/io/bitmap_reader.h"

#include <compare>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace gradus {

/// A file and what a texture takes of it.
struct Picture {
    std::filesystem::path path;
    bool is_linear = false;   ///< as BitmapRequest's
    std::string channel = {}; ///< as BitmapRequest's
    auto operator<=>(const Picture &) const = default;
};

class PicturesAhead {
  public:
    /// Called on any thread.
    using Decode = std::function<ReadBitmap(const Picture &)>;

    /// Those that will be asked for, once each and about in this order. Decoding waits while what nobody has taken yet
    /// is more than `most_bytes`.
    PicturesAhead(const std::vector<Picture> &pictures, unsigned threads, std::uint64_t most_bytes, Decode decode);
    /// Waits for what is under way.
    ~PicturesAhead();
    PicturesAhead(const PicturesAhead &) = delete;
    PicturesAhead &operator=(const PicturesAhead &) = delete;

    /// What `decode` gives or throws: there, or here where no thread has begun with it.
    ReadBitmap take(const Picture &picture);

  private:
    enum class State { waits, is_under_way, is_done, is_taken };
    struct Entry {
        const Picture *picture;
        State state = State::waits;
        ReadBitmap read = {};
        std::exception_ptr error = {};
        std::uint64_t bytes() const { return read.bitmap.words.size() * sizeof(read.bitmap.words[0]); }
    };

    void work();
    /// The first that waits, or nullptr.
    Entry *next();
    /// False where none waits. The lock is open while it decodes.
    bool decode_next(std::unique_lock<std::mutex> &lock);

    const Decode decode_;
    const std::uint64_t most_bytes_;
    std::mutex mutex_; ///< of all that follows, but for `read` and `error` of what is under way
    std::condition_variable changed_;
    std::vector<Entry> entries_;
    std::map<Picture, std::size_t> places_; ///< in entries_
    std::size_t first_ = 0;                 ///< of entries_: none before it waits
    std::uint64_t bytes_ = 0;               ///< of what is done and not taken
    bool stops_ = false;
    std::vector<std::thread> threads_;
};

} // namespace gradus
