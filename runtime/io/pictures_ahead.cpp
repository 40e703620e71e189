#include "runtime/io/pictures_ahead.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace gradus {

PicturesAhead::PicturesAhead(const std::vector<Picture> &pictures, unsigned threads, std::uint64_t most_bytes,
                             Decode decode)
    : decode_(std::move(decode)), most_bytes_(most_bytes) {
    for (const Picture &picture : pictures)
        if (const auto [place, is_new] = places_.emplace(picture, entries_.size()); is_new)
            entries_.push_back({.picture = &place->first});
    try {
        for (unsigned i = 0; i < std::min<std::size_t>(threads, entries_.size()); ++i)
            threads_.emplace_back([this] { work(); });
    } catch (const std::system_error &) {
        // Fewer do as well: who asks for a picture decodes it where nobody else has begun.
    }
}

PicturesAhead::~PicturesAhead() {
    {
        const std::lock_guard lock(mutex_);
        stops_ = true;
    }
    changed_.notify_all();
    for (std::thread &thread : threads_)
        thread.join();
}

PicturesAhead::Entry *PicturesAhead::next() {
    while (first_ < entries_.size() && entries_[first_].state != State::waits)
        ++first_;
    return first_ < entries_.size() ? &entries_[first_] : nullptr;
}

bool PicturesAhead::decode_next(std::unique_lock<std::mutex> &lock) {
    Entry *const entry = next();
    if (!entry)
        return false;
    entry->state = State::is_under_way;
    lock.unlock();
    try {
        entry->read = decode_(*entry->picture);
    } catch (...) {
        entry->error = std::current_exception();
    }
    lock.lock();
    entry->state = State::is_done;
    bytes_ += entry->bytes();
    changed_.notify_all();
    return true;
}

void PicturesAhead::work() {
    std::unique_lock lock(mutex_);
    do
        changed_.wait(lock, [this] { return stops_ || bytes_ <= most_bytes_; });
    while (!stops_ && decode_next(lock));
}

ReadBitmap PicturesAhead::take(const Picture &picture) {
    std::unique_lock lock(mutex_);
    const auto place = places_.find(picture);
    Entry *const entry = place == places_.end() ? nullptr : &entries_[place->second];
    if (!entry || entry->state == State::waits || entry->state == State::is_taken) {
        if (entry)
            entry->state = State::is_taken;
        lock.unlock();
        return decode_(picture);
    }
    // Who waits for one decodes another.
    while (entry->state == State::is_under_way)
        if (bytes_ > most_bytes_ || !decode_next(lock))
            changed_.wait(lock, [entry] { return entry->state == State::is_done; });
    entry->state = State::is_taken;
    bytes_ -= entry->bytes();
    changed_.notify_all();
    if (entry->error)
        std::rethrow_exception(entry->error);
    return std::move(entry->read);
}

} // namespace gradus
