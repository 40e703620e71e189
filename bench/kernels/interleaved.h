// Things that are timed against each other, and the triad.
#pragma once

#include "runtime/device/program.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace gradus::bench {

/// Runs each function `repeats` times by Google Benchmark, all of them mixed in random order, so that a machine that
/// slows down slows all. A function returns the seconds that count. Returns these by name.
std::map<std::string, std::vector<double>>
run_interleaved(const std::map<std::string, std::function<double()>> &functions, int repeats);

/// a = b + 3 c on the device, over at least so many bytes.
class Triad {
  public:
    Triad(Device &device, double bytes);
    /// Device seconds of one run.
    double seconds();
    double bytes() const; ///< that it reads and writes

  private:
    Device &device_;
    std::uint32_t count_;
    Buffer a_, b_, c_;
    Kernel kernel_;
};

} // namespace gradus::bench
