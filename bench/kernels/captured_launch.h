// One launch of a render or a solve, kept with the content of everything that it was given, so that its kernel can be
// run on it again and again, also in other builds.
#pragma once

#include "runtime/device/launch_observer.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gradus {
struct TableLayout; // runtime/wavefront/table_layout.h
}

namespace gradus::bench {

/// Memory that a launch was given, under each of its names: the solver's kernels work in place.
struct CapturedBuffer {
    std::vector<std::string> arguments;
    Buffer buffer;                  ///< that of the render
    std::vector<char> content;      ///< before the launch
    bool is_real = true;            ///< else uint
    std::size_t rows = 0;           ///< of a table of kernels/shared/tables.h; 0 for anything else
    std::vector<bool> is_uint = {}; ///< by column of a table, as many as the buffer holds
    std::size_t lines = 1;          ///< rows for each work-item: 4 where there is one for each offset path; 0: unknown
    std::size_t line_rows = 0;      ///< how far they are apart
};

/// A kernel with its arguments, in one build, and what restores its memory.
class Replay {
  public:
    /// Device seconds of one launch on the memory as the render left it.
    double seconds();
    /// The same launch without the clock.
    void run();
    /// Puts back what the launch writes.
    void restore() const;
    Kernel &kernel() { return kernel_; }
    /// What CapturedLaunch::buffers() hold now, in the precision of this build.
    std::vector<std::vector<char>> contents() const;

  private:
    friend class CapturedLaunch;
    struct Memory {
        Buffer buffer;
        std::shared_ptr<const std::vector<char>> content;
        bool is_written;
    };
    Device *device_ = nullptr;
    Kernel kernel_;
    std::size_t items_ = 0, lines_ = 0, planes_ = 1; ///< as of Launch
    std::vector<Memory> memory_;
};

class CapturedLaunch {
  public:
    /// Copies what the launch's buffers hold. To be used and destroyed while the observer runs that it comes from: the
    /// float builds work on the render's own memory.
    CapturedLaunch(Device &device, const Launch &launch);
    ~CapturedLaunch();
    CapturedLaunch(const CapturedLaunch &) = delete;
    CapturedLaunch &operator=(const CapturedLaunch &) = delete;

    const std::string &name() const { return request_.name; }
    const std::string &file() const { return request_.file; }
    bool is_written(std::size_t buffer) const { return is_written_[buffer]; }
    std::size_t items() const { return items_ * std::max<std::size_t>(lines_, 1) * planes_; }
    /// Pixels that a kernel does tile by tile (kernels/solver/cycle.cl); 0 of other kernels.
    std::size_t pixels_of_tiles() const;
    Device &device() const { return device_; }
    const std::vector<CapturedBuffer> &buffers() const { return buffers_; }

    /// The kernel as it was built for the launch but for its arithmetic and these definitions more.
    Replay replay(Precision precision, const std::map<std::string, std::string> &definitions = {});

    /// Bytes that one item has to read and write, in float: every column of a table that the launch touches, once; the
    /// items of several planes share them. Nothing where they are not known: where the launch has a buffer that is
    /// neither a table of kernels/shared/tables.h nor a list of one number an item nor of the scene, or where an item
    /// takes several rows of a table.
    ///
    /// Found by experiment: a column is read if the launch leaves something else once its values are changed, and
    /// written if the launch leaves it changed. Records of the scene are not counted, for they stay in caches.
    std::optional<double> table_bytes_an_item();

  private:
    std::size_t uint_argument(const std::string &name) const; ///< 0 where there is none
    void lay_out(CapturedBuffer &captured, const TableLayout &layout) const;
    bool has_known_rows() const; ///< whether it is known how many rows of each buffer an item takes
    std::vector<std::vector<char>> contents() const;
    void restore() const;

    Device &device_;
    KernelRequest request_;
    TraitValues traits_;
    std::map<std::string, Launch::Argument> arguments_;
    std::size_t items_, lines_, planes_;
    std::vector<CapturedBuffer> buffers_;
    std::vector<bool> is_written_; ///< by buffer
};

} // namespace gradus::bench
