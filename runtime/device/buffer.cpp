#include "runtime/device/buffer.h"

#include "runtime/device/opencl.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

#include <sys/mman.h>

namespace gradus {

struct Buffer::Handle {
    Handle(Device::Implementation &device, cl::Buffer memory, std::size_t bytes)
        : device(device), memory(std::move(memory)), bytes(bytes) {
        device.allocated_bytes += bytes;
        device.peak_bytes = std::max(device.peak_bytes, device.allocated_bytes);
    }
    ~Handle() {
        device.allocated_bytes -= bytes;
        // What was queued may still use this memory: the host's own goes after its buffer, and where an error unwinds
        // nobody has waited.
        if (is_of_host || std::uncaught_exceptions() > 0)
            device.finish_quietly();
    }

    Device::Implementation &device;
    cl::Buffer memory;
    std::size_t bytes;             ///< that we allocated: 0 for a caller's and for a part
    bool is_of_host = false;       ///< of Buffer::over()
    std::shared_ptr<Handle> whole; ///< of a part
    std::size_t first = 0;         ///< byte of the whole
};

struct Buffer::Event {
    explicit Event(Device::Implementation &device) : device(device) {}
    ~Event() {
        if (!is_done) // an error came first, and the caller's memory goes
            device.finish_quietly();
    }
    Event(const Event &) = delete;
    Event &operator=(const Event &) = delete;

    Device::Implementation &device;
    cl::Event event;
    bool is_done = false;
};

namespace {
/// Of an array, in bytes.
constexpr std::size_t largest_element = 16;

void check_size(const Device::Implementation &device, const std::string &name, std::size_t bytes) {
    const DeviceDescription &d = device.description;
    if (bytes > d.allocation_bytes)
        throw Error(ExitCode::device,
                    fmt::format("{} needs {} MB, more than the {} MB that {} allocates at once; try a smaller "
                                "--batch-size, --photons, --size or scene",
                                name, bytes >> 20, d.allocation_bytes >> 20, d.name));
}

/// Asks the system for large pages, which it may refuse. Rows of tables are read here and there, and where pages are
/// small the processor looks for each; and a short render spends much of its time on being given them.
void ask_for_large_pages(Device::Implementation &device, const cl::Buffer &memory, std::size_t bytes) {
    constexpr std::uintptr_t large_page = 2u << 20;
    if (!device.description.is_host || bytes < large_page)
        return;
    void *const data = device.queue.enqueueMapBuffer(memory, CL_TRUE, CL_MAP_WRITE_INVALIDATE_REGION, 0, bytes);
    const auto begin = reinterpret_cast<std::uintptr_t>(data);
    const std::uintptr_t first = (begin + large_page - 1) / large_page * large_page;
    const std::uintptr_t end = (begin + bytes) / large_page * large_page;
    if (first < end)
        madvise(reinterpret_cast<void *>(first), end - first, MADV_HUGEPAGE);
    device.queue.enqueueUnmapMemObject(memory, data);
}
} // namespace

Buffer::Buffer(Device &device, const std::string &name, std::size_t bytes)
    : name_(name), bytes_(bytes > 0 ? bytes : largest_element) {
    Device::Implementation &d = device.implementation();
    check_size(d, name, bytes_);
    opencl_call(fmt::format("allocating {} MB for {}", bytes_ >> 20, name), [&] {
        // Elsewhere the host's memory would be a second copy.
        const cl_mem_flags place = d.description.shares_memory ? CL_MEM_ALLOC_HOST_PTR : 0;
        const std::size_t allocated = std::max(bytes_, largest_element);
        handle_ = std::make_shared<Handle>(d, cl::Buffer(d.context, CL_MEM_READ_WRITE | place, allocated), allocated);
        ask_for_large_pages(d, handle_->memory, bytes_);
    });
}

Buffer::Buffer(Device &device, const std::string &name, const void *data, std::size_t bytes)
    : Buffer(device, name, bytes) {
    opencl_call("filling " + name, [&] {
        if (bytes > 0)
            handle_->device.queue.enqueueWriteBuffer(handle_->memory, CL_TRUE, 0, bytes, data);
        else
            clear();
    });
}

/// Less is copied to where the device aligns it: that costs nothing, and small tables are read all the time.
constexpr std::size_t worth_sharing = std::size_t(1) << 20;

Buffer Buffer::over(Device &device, const std::string &name, const void *data, std::size_t bytes) {
    Device::Implementation &d = device.implementation();
    if (!d.description.shares_memory || bytes < worth_sharing)
        return Buffer(device, name, data, bytes);
    check_size(d, name, bytes);
    Buffer buffer;
    buffer.name_ = name;
    buffer.bytes_ = bytes;
    opencl_call("taking the host's memory of " + name, [&] {
        buffer.handle_ = std::make_shared<Handle>(
            d, cl::Buffer(d.context, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, bytes, const_cast<void *>(data)), bytes);
        buffer.handle_->is_of_host = true;
        // From where it lies to there: nothing is moved, but who looks after it, as Oclgrind does, knows that it is
        // set.
        d.queue.enqueueWriteBuffer(buffer.handle_->memory, CL_TRUE, 0, bytes, data);
    });
    return buffer;
}

Buffer Buffer::wrap(Device &device, const std::string &name, _cl_mem *memory) {
    if (!memory)
        throw Error(ExitCode::device, fmt::format("{}: the OpenCL memory object is null", name));
    Device::Implementation &d = device.implementation();
    Buffer buffer;
    buffer.name_ = name;
    opencl_call("taking the memory of " + name, [&] {
        const cl::Buffer object(memory, true);
        if (object.getInfo<CL_MEM_TYPE>() != CL_MEM_OBJECT_BUFFER)
            throw Error(ExitCode::device, fmt::format("{}: the OpenCL memory object is not a buffer", name));
        if (object.getInfo<CL_MEM_CONTEXT>()() != d.context())
            throw Error(ExitCode::device, fmt::format("{}: the OpenCL buffer belongs to another context", name));
        buffer.bytes_ = object.getInfo<CL_MEM_SIZE>();
        buffer.handle_ = std::make_shared<Handle>(d, object, 0);
    });
    return buffer;
}

Buffer Buffer::part(std::size_t first, std::size_t bytes) const {
    Buffer part;
    part.name_ = name_;
    part.bytes_ = bytes;
    opencl_call("taking a part of " + name_, [&] {
        // OpenCL makes no parts of parts.
        const std::shared_ptr<Handle> &whole = handle_->whole ? handle_->whole : handle_;
        const cl_buffer_region region{handle_->first + first, bytes};
        part.handle_ = std::make_shared<Handle>(
            handle_->device, whole->memory.createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &region),
            0);
        part.handle_->whole = whole;
        part.handle_->first = region.origin;
    });
    return part;
}

const void *Buffer::argument() const { return &handle_->memory(); }

namespace {

/// By several threads: most of it is what the system does at the first touch of a page.
void clear_memory(char *memory, std::size_t bytes, unsigned most_threads) {
    constexpr std::size_t worth_a_thread = std::size_t(4) << 20, page = 4096;
    const std::size_t threads = std::clamp<std::size_t>(bytes / worth_a_thread, 1, most_threads);
    const std::size_t part = (bytes / threads + page - 1) / page * page;
    std::vector<std::jthread> others;
    std::size_t begin = 0; // of what is left
    try {
        for (; others.size() + 1 < threads && begin + part < bytes; begin += part)
            others.emplace_back([memory, begin, part] { std::memset(memory + begin, 0, part); });
    } catch (const std::system_error &) {
        // Fewer do as well.
    }
    std::memset(memory + begin, 0, bytes - begin);
}

} // namespace

void Buffer::clear() {
    const Device::Implementation &d = handle_->device;
    if (!d.description.shares_memory) {
        opencl_call("clearing " + name_, [&] { d.queue.enqueueFillBuffer(handle_->memory, cl_uchar(0), 0, bytes_); });
        return;
    }
    // Not so here: a checker of uninitialised memory (oclgrind) does not see what that writes.
    clear_memory(map(Access::write).as<char>(), bytes_, d.host_threads);
}

void Buffer::read(void *data, std::size_t bytes) const { start_read(data, bytes).wait(); }

Buffer::Reading::Reading(const Buffer &buffer, void *data, std::size_t bytes)
    : done_(std::make_shared<Event>(buffer.handle_->device)) {
    const Handle &handle = *buffer.handle_;
    opencl_call("reading " + buffer.name_, [&] {
        handle.device.queue.enqueueReadBuffer(handle.memory, CL_FALSE, 0, bytes, data, nullptr, &done_->event);
        handle.device.queue.flush();
    });
}

Buffer::Reading::Reading(const Buffer &buffer, void *data, const Stripes &stripes)
    : done_(std::make_shared<Event>(buffer.handle_->device)) {
    const Handle &handle = *buffer.handle_;
    opencl_call("reading " + buffer.name_, [&] {
        handle.device.queue.enqueueReadBufferRect(handle.memory, CL_FALSE, {stripes.start, stripes.first, 0}, {0, 0, 0},
                                                  {stripes.bytes, stripes.count, 1}, stripes.pitch, 0,
                                                  stripes.host_pitch, 0, data, nullptr, &done_->event);
        handle.device.queue.flush();
    });
}

void Buffer::start_write(const void *data, const Stripes &stripes) const {
    opencl_call("writing " + name_, [&] {
        handle_->device.queue.enqueueWriteBufferRect(handle_->memory, CL_FALSE, {stripes.start, stripes.first, 0},
                                                     {0, 0, 0}, {stripes.bytes, stripes.count, 1}, stripes.pitch, 0,
                                                     stripes.host_pitch, 0, data);
    });
}

void Buffer::Reading::wait() {
    opencl_call("reading", [&] { done_->event.wait(); });
    done_->is_done = true;
}

Buffer::Mapping::Mapping(const Buffer &buffer, Access access, Wait wait) : buffer_(buffer) {
    const cl_map_flags flags = access == Access::read    ? CL_MAP_READ
                               : access == Access::write ? CL_MAP_WRITE
                                                         : CL_MAP_READ | CL_MAP_WRITE;
    pointer_ = opencl_call("mapping " + buffer.name_, [&] {
        return buffer.handle_->device.queue.enqueueMapBuffer(
            buffer.handle_->memory, wait == Wait::now ? CL_TRUE : CL_FALSE, flags, 0, buffer.bytes_);
    });
}

Buffer::Mapping::~Mapping() {
    try {
        buffer_.handle_->device.queue.enqueueUnmapMemObject(buffer_.handle_->memory, pointer_);
    } catch (const cl::Error &) {
        // Nothing can be done here; the next call on the queue reports the error.
    }
}

} // namespace gradus
