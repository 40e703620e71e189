// A layer between a program and OpenCL, for LD_PRELOAD: writes to the file GRADUS_TEST_OPENCL_REPORT what a program
// does wrong with objects. A kernel does not retain its arguments, so a launch whose buffer is gone reads memory that
// may be another's by then; most implementations say nothing. At the end all objects must have been released; an
// implementation keeps memory of its own, so a leak detector cannot tell.
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include <dlfcn.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <string>

namespace {

struct Object {
    const char *kind;
    long references;
    long number; ///< handles may be used again
};

struct Argument {
    cl_mem buffer;
    long number;
};

/// One for the program; never destroyed, for objects are released until the very end.
struct Book {
    std::mutex mutex;
    std::map<const void *, Object> objects;
    std::map<cl_kernel, std::map<cl_uint, Argument>> arguments;
    long made = 0, launches = 0;
    std::map<std::string, long> faults;
};

Book &book() {
    static Book *const book = new Book;
    return *book;
}

/// Static objects of libraries that were loaded first are destroyed last: the program's own are gone by then.
struct Report {
    ~Report() {
        const char *const path = std::getenv("GRADUS_TEST_OPENCL_REPORT");
        if (!path)
            return;
        const std::lock_guard lock(book().mutex);
        std::ofstream file(path);
        for (const auto &[fault, times] : book().faults)
            file << fault << ": " << times << " times\n";
        std::map<std::string, long> left;
        for (const auto &[handle, object] : book().objects)
            ++left[object.kind];
        for (const auto &[kind, number] : left)
            file << kind << " never released: " << number << "\n";
        file << "launches: " << book().launches << "\n";
    }
} report;

template <class Function>
Function *next(const char *name, Function *) {
    return reinterpret_cast<Function *>(::dlsym(RTLD_NEXT, name));
}

template <class Handle>
Handle made(const char *kind, Handle handle) {
    const std::lock_guard lock(book().mutex);
    if (handle)
        book().objects[handle] = {kind, 1, ++book().made};
    return handle;
}

void made_event(cl_event *event) {
    if (event)
        made("events", *event);
}

void retained(const void *handle) {
    const std::lock_guard lock(book().mutex);
    if (const auto found = book().objects.find(handle); found != book().objects.end())
        ++found->second.references;
}

void released(const void *handle) {
    const std::lock_guard lock(book().mutex);
    const auto found = book().objects.find(handle);
    if (found == book().objects.end())
        ++book().faults["an object is released that is not there"];
    else if (--found->second.references == 0) {
        book().objects.erase(found);
        book().arguments.erase(static_cast<cl_kernel>(const_cast<void *>(handle)));
    }
}

} // namespace

#define NEXT(name) next(#name, &name)

#define COUNT_REFERENCES(Kind, type)                                                                                   \
    extern "C" cl_int clRetain##Kind(type handle) {                                                                    \
        retained(handle);                                                                                              \
        return NEXT(clRetain##Kind)(handle);                                                                           \
    }                                                                                                                  \
    extern "C" cl_int clRelease##Kind(type handle) {                                                                   \
        released(handle);                                                                                              \
        return NEXT(clRelease##Kind)(handle);                                                                          \
    }
COUNT_REFERENCES(Context, cl_context)
COUNT_REFERENCES(CommandQueue, cl_command_queue)
COUNT_REFERENCES(MemObject, cl_mem)
COUNT_REFERENCES(Program, cl_program)
COUNT_REFERENCES(Kernel, cl_kernel)
COUNT_REFERENCES(Event, cl_event)

extern "C" cl_context clCreateContext(const cl_context_properties *a, cl_uint b, const cl_device_id *c,
                                      void(CL_CALLBACK *d)(const char *, const void *, size_t, void *), void *e,
                                      cl_int *f) {
    return made("contexts", NEXT(clCreateContext)(a, b, c, d, e, f));
}
extern "C" cl_command_queue clCreateCommandQueue(cl_context a, cl_device_id b, cl_command_queue_properties c,
                                                 cl_int *d) {
    return made("queues", NEXT(clCreateCommandQueue)(a, b, c, d));
}
extern "C" cl_mem clCreateBuffer(cl_context a, cl_mem_flags b, size_t c, void *d, cl_int *e) {
    return made("buffers", NEXT(clCreateBuffer)(a, b, c, d, e));
}
extern "C" cl_mem clCreateSubBuffer(cl_mem a, cl_mem_flags b, cl_buffer_create_type c, const void *d, cl_int *e) {
    return made("parts of buffers", NEXT(clCreateSubBuffer)(a, b, c, d, e));
}
extern "C" cl_program clCreateProgramWithSource(cl_context a, cl_uint b, const char **c, const size_t *d, cl_int *e) {
    return made("programs", NEXT(clCreateProgramWithSource)(a, b, c, d, e));
}
extern "C" cl_program clCreateProgramWithBinary(cl_context a, cl_uint b, const cl_device_id *c, const size_t *d,
                                                const unsigned char **e, cl_int *f, cl_int *g) {
    return made("programs", NEXT(clCreateProgramWithBinary)(a, b, c, d, e, f, g));
}
extern "C" cl_kernel clCreateKernel(cl_program a, const char *b, cl_int *c) {
    return made("kernels", NEXT(clCreateKernel)(a, b, c));
}
extern "C" cl_int clCreateKernelsInProgram(cl_program a, cl_uint b, cl_kernel *c, cl_uint *d) {
    const cl_int result = NEXT(clCreateKernelsInProgram)(a, b, c, d);
    for (cl_uint i = 0; result == CL_SUCCESS && c && i < b; ++i)
        made("kernels", c[i]);
    return result;
}

/// A buffer is told by its handle: an argument of that size that is one.
extern "C" cl_int clSetKernelArg(cl_kernel kernel, cl_uint index, size_t bytes, const void *value) {
    {
        const std::lock_guard lock(book().mutex);
        cl_mem buffer = nullptr;
        if (bytes == sizeof buffer && value)
            std::memcpy(&buffer, value, sizeof buffer);
        if (const auto found = book().objects.find(buffer); found != book().objects.end())
            book().arguments[kernel][index] = {buffer, found->second.number};
        else
            book().arguments[kernel].erase(index);
    }
    return NEXT(clSetKernelArg)(kernel, index, bytes, value);
}
extern "C" cl_int clEnqueueNDRangeKernel(cl_command_queue a, cl_kernel b, cl_uint c, const size_t *d, const size_t *e,
                                         const size_t *f, cl_uint g, const cl_event *h, cl_event *i) {
    {
        const std::lock_guard lock(book().mutex);
        ++book().launches;
        for (const auto &[index, argument] : book().arguments[b]) {
            const auto found = book().objects.find(argument.buffer);
            if (found != book().objects.end() && found->second.number == argument.number)
                continue;
            char name[256] = "";
            NEXT(clGetKernelInfo)(b, CL_KERNEL_FUNCTION_NAME, sizeof name, name, nullptr);
            ++book().faults["argument " + std::to_string(index) + " of " + name + " is gone when it is launched"];
        }
    }
    const cl_int result = NEXT(clEnqueueNDRangeKernel)(a, b, c, d, e, f, g, h, i);
    made_event(result == CL_SUCCESS ? i : nullptr);
    return result;
}
extern "C" cl_int clEnqueueReadBuffer(cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, void *f, cl_uint g,
                                      const cl_event *h, cl_event *i) {
    const cl_int result = NEXT(clEnqueueReadBuffer)(a, b, c, d, e, f, g, h, i);
    made_event(result == CL_SUCCESS ? i : nullptr);
    return result;
}
extern "C" cl_int clEnqueueWriteBuffer(cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, const void *f,
                                       cl_uint g, const cl_event *h, cl_event *i) {
    const cl_int result = NEXT(clEnqueueWriteBuffer)(a, b, c, d, e, f, g, h, i);
    made_event(result == CL_SUCCESS ? i : nullptr);
    return result;
}
extern "C" void *clEnqueueMapBuffer(cl_command_queue a, cl_mem b, cl_bool c, cl_map_flags d, size_t e, size_t f,
                                    cl_uint g, const cl_event *h, cl_event *i, cl_int *j) {
    void *const mapped = NEXT(clEnqueueMapBuffer)(a, b, c, d, e, f, g, h, i, j);
    made_event(mapped ? i : nullptr);
    return mapped;
}
extern "C" cl_int clEnqueueUnmapMemObject(cl_command_queue a, cl_mem b, void *c, cl_uint d, const cl_event *e,
                                          cl_event *f) {
    const cl_int result = NEXT(clEnqueueUnmapMemObject)(a, b, c, d, e, f);
    made_event(result == CL_SUCCESS ? f : nullptr);
    return result;
}
