// Device memory, and the short time in which the host may touch it.
#pragma once

#include "runtime/device/device.h"

#include <cstddef>
#include <span>
#include <string>

struct _cl_mem; // cl_mem, as OpenCL's headers declare it

namespace gradus {

enum class Access { read, write, read_write };
enum class Wait { now, later };

/// Some rows of some columns of a table. Its columns lie `pitch` bytes apart, those on the host `host_pitch`: of
/// `count` columns from number `first` on, `bytes` from byte `start` on.
struct Stripes {
    std::size_t pitch, host_pitch, first, count, start, bytes;
};

/// An array in device memory. Where the device shares the host's memory (DeviceDescription::shares_memory), mapping it
/// copies nothing; else all of it.
class Buffer {
    struct Event;

  public:
    Buffer() = default;
    /// `name` is for messages and for the arguments of kernels that bear it. An empty buffer holds one element, for
    /// OpenCL has none of size 0. Throws Error where there is no memory.
    Buffer(Device &device, const std::string &name, std::size_t bytes);
    /// The same with its content.
    Buffer(Device &device, const std::string &name, const void *data, std::size_t bytes);

    /// The host's memory for kernels to read. It must live as long as the buffer and stay as it is: where the device
    /// shares it nothing is copied, but for what is small.
    static Buffer over(Device &device, const std::string &name, const void *data, std::size_t bytes);

    /// A caller's cl_mem, which is retained and not counted as ours. It must be a buffer of the device's context:
    /// throws Error(ExitCode::device) where it is not. Maps and reads need a buffer that the host may access.
    static Buffer wrap(Device &device, const std::string &name, _cl_mem *memory);

    /// Some of its bytes as a buffer of the same name, which keeps the whole alive. `first` must be a multiple of what
    /// the device aligns memory to (4096 is on all known).
    Buffer part(std::size_t first, std::size_t bytes) const;

    /// The same memory for arguments of another name.
    Buffer named(const std::string &name) const {
        Buffer other = *this;
        other.name_ = name;
        return other;
    }

    const std::string &name() const { return name_; }
    std::size_t bytes() const { return bytes_; }
    bool valid() const { return handle_ != nullptr; }
    /// The cl_mem, as a pointer that clSetKernelArg takes.
    const void *argument() const;

    /// Sets all bytes to zero.
    void clear();
    /// Waits for all work on the queue, then copies the content.
    void read(void *data, std::size_t bytes) const;

    /// A copy of the content that is on its way: as it is once all work queued before is done.
    class Reading {
      public:
        Reading(const Buffer &buffer, void *data, std::size_t bytes);
        Reading(const Buffer &buffer, void *data, const Stripes &stripes);
        /// `data` must live until then.
        void wait();

      private:
        std::shared_ptr<Event> done_;
    };
    /// Work may be queued before Reading::wait(), so that the device need not wait for the host.
    Reading start_read(void *data, std::size_t bytes) const { return Reading(*this, data, bytes); }
    /// The same of some stripes; `data` is where the first begins.
    Reading start_read(void *data, const Stripes &stripes) const { return Reading(*this, data, stripes); }
    /// Puts them there, before all work that is queued later. `data` must live, and stay as it is, until the host has
    /// waited for such work.
    void start_write(const void *data, const Stripes &stripes) const;

    /// The host's view of the buffer, until it is destroyed. Waits for all work on the queue, or (`later`) leaves that
    /// to a later mapping or read.
    class Mapping {
      public:
        Mapping(const Buffer &buffer, Access access, Wait wait);
        ~Mapping();
        Mapping(const Mapping &) = delete;
        Mapping &operator=(const Mapping &) = delete;
        template <class T>
        T *as() const {
            return static_cast<T *>(pointer_);
        }

      private:
        const Buffer &buffer_;
        void *pointer_;
    };
    Mapping map(Access access, Wait wait = Wait::now) const { return Mapping(*this, access, wait); }

  private:
    struct Handle;
    std::string name_;
    std::size_t bytes_ = 0;
    std::shared_ptr<Handle> handle_;
};

} // namespace gradus
