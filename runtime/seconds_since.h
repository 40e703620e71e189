// Wall time.
#pragma once

#include <chrono>

namespace gradus {

inline double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Adds the seconds of its life to a sum, those of work that an exception ended too.
class AddedSeconds {
  public:
    explicit AddedSeconds(double &sum) : sum_(sum) {}
    ~AddedSeconds() { sum_ += seconds_since(start_); }
    AddedSeconds(const AddedSeconds &) = delete;
    AddedSeconds &operator=(const AddedSeconds &) = delete;

  private:
    double &sum_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace gradus
