// A layer between a program and OpenCL, for LD_PRELOAD: the n-th call fails without being made, where n is what the
// environment has as GRADUS_TEST_FAILING_CALL. The number of calls is written to the file GRADUS_TEST_CALLS at the end,
// and after it the first and the last call from each place: a stack of callers, a kernel and an argument of it.
// Iterations of a solver make thousands of calls from a few places. Retaining and releasing are left alone: nobody asks
// whether they worked. With GRADUS_TEST_THROWING_BUILD=n, instead, the n-th build of a program throws std::bad_alloc,
// as LLVM does through PoCL 3.1, and who then releases a program for good, where PoCL would wait for ever, is ended.
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include <dlfcn.h>
#include <execinfo.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

std::atomic<long> calls{0};

/// The first and the last call from each place.
class Places {
  public:
    explicit Places(const char *path) : path_(path) {}
    ~Places() {
        if (!path_)
            return;
        std::set<long> numbers;
        for (const auto &[place, number] : places_)
            numbers.insert({number.first, number.second});
        std::ofstream file(path_);
        file << calls << "\n";
        for (const long number : numbers)
            file << number << "\n";
    }

    template <class... Arguments>
    void note(long call, Arguments... arguments) {
        if (!path_)
            return;
        constexpr int deepest = 64;
        void *frames[deepest];
        const int depth = ::backtrace(frames, deepest);
        Place place;
        for (int i = 0; i < depth; ++i)
            place.push_back(reinterpret_cast<std::uintptr_t>(frames[i]));
        if constexpr (sizeof...(arguments) > 1) {
            const auto list = std::tie(arguments...);
            const auto add = [&]<class T>(const T &argument) {
                if constexpr (std::is_same_v<T, cl_kernel>)
                    place.push_back(reinterpret_cast<std::uintptr_t>(argument));
                else if constexpr (std::is_same_v<T, cl_uint>)
                    place.push_back(argument);
            };
            add(std::get<0>(list));
            add(std::get<1>(list));
        }
        const std::lock_guard lock(mutex_);
        const auto found = places_.try_emplace(std::move(place), call, call).first;
        found->second.second = call;
    }

  private:
    using Place = std::vector<std::uintptr_t>;
    const char *path_;
    std::mutex mutex_;
    std::map<Place, std::pair<long, long>> places_;
};

Places places(std::getenv("GRADUS_TEST_CALLS"));

bool fails(long call) {
    static const char *const text = std::getenv("GRADUS_TEST_FAILING_CALL");
    static const long failing = text ? std::atol(text) : 0;
    return call == failing;
}

template <class Result, class... Parameters, class... Arguments>
Result forward(const char *name, Result (*)(Parameters...), Arguments... arguments) {
    const long call = ++calls;
    places.note(call, arguments...);
    if (fails(call)) {
        if constexpr (std::is_same_v<Result, cl_int>)
            return CL_OUT_OF_RESOURCES;
        else { // what makes objects takes the address of its error last
            cl_int *const error = std::get<sizeof...(arguments) - 1>(std::tie(arguments...));
            if (error)
                *error = CL_OUT_OF_RESOURCES;
            return nullptr;
        }
    }
    using Function = Result(Parameters...);
    return reinterpret_cast<Function *>(::dlsym(RTLD_NEXT, name))(arguments...);
}

} // namespace

#define LAYER(result, name, parameters, ...)                                                                           \
    extern "C" result name parameters { return forward(#name, &name, __VA_ARGS__); }

LAYER(cl_int, clGetPlatformIDs, (cl_uint a, cl_platform_id *b, cl_uint *c), a, b, c)
LAYER(cl_int, clGetPlatformInfo, (cl_platform_id a, cl_platform_info b, size_t c, void *d, size_t *e), a, b, c, d, e)
LAYER(cl_int, clGetDeviceIDs, (cl_platform_id a, cl_device_type b, cl_uint c, cl_device_id *d, cl_uint *e), a, b, c, d,
      e)
LAYER(cl_int, clGetDeviceInfo, (cl_device_id a, cl_device_info b, size_t c, void *d, size_t *e), a, b, c, d, e)
LAYER(cl_context, clCreateContext,
      (const cl_context_properties *a, cl_uint b, const cl_device_id *c,
       void(CL_CALLBACK *d)(const char *, const void *, size_t, void *), void *e, cl_int *f),
      a, b, c, d, e, f)
LAYER(cl_command_queue, clCreateCommandQueue, (cl_context a, cl_device_id b, cl_command_queue_properties c, cl_int *d),
      a, b, c, d)
LAYER(cl_mem, clCreateBuffer, (cl_context a, cl_mem_flags b, size_t c, void *d, cl_int *e), a, b, c, d, e)
LAYER(cl_mem, clCreateSubBuffer, (cl_mem a, cl_mem_flags b, cl_buffer_create_type c, const void *d, cl_int *e), a, b, c,
      d, e)
LAYER(cl_program, clCreateProgramWithSource, (cl_context a, cl_uint b, const char **c, const size_t *d, cl_int *e), a,
      b, c, d, e)
LAYER(cl_program, clCreateProgramWithBinary,
      (cl_context a, cl_uint b, const cl_device_id *c, const size_t *d, const unsigned char **e, cl_int *f, cl_int *g),
      a, b, c, d, e, f, g)
LAYER(cl_int, clGetProgramInfo, (cl_program a, cl_program_info b, size_t c, void *d, size_t *e), a, b, c, d, e)
LAYER(cl_int, clGetProgramBuildInfo,
      (cl_program a, cl_device_id b, cl_program_build_info c, size_t d, void *e, size_t *f), a, b, c, d, e, f)
LAYER(cl_kernel, clCreateKernel, (cl_program a, const char *b, cl_int *c), a, b, c)
LAYER(cl_int, clCreateKernelsInProgram, (cl_program a, cl_uint b, cl_kernel *c, cl_uint *d), a, b, c, d)
LAYER(cl_int, clGetKernelInfo, (cl_kernel a, cl_kernel_info b, size_t c, void *d, size_t *e), a, b, c, d, e)
LAYER(cl_int, clGetKernelArgInfo, (cl_kernel a, cl_uint b, cl_kernel_arg_info c, size_t d, void *e, size_t *f), a, b, c,
      d, e, f)
LAYER(cl_int, clSetKernelArg, (cl_kernel a, cl_uint b, size_t c, const void *d), a, b, c, d)
LAYER(cl_int, clEnqueueNDRangeKernel,
      (cl_command_queue a, cl_kernel b, cl_uint c, const size_t *d, const size_t *e, const size_t *f, cl_uint g,
       const cl_event *h, cl_event *i),
      a, b, c, d, e, f, g, h, i)
LAYER(cl_int, clEnqueueReadBuffer,
      (cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, void *f, cl_uint g, const cl_event *h, cl_event *i),
      a, b, c, d, e, f, g, h, i)
LAYER(cl_int, clEnqueueWriteBuffer,
      (cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, const void *f, cl_uint g, const cl_event *h,
       cl_event *i),
      a, b, c, d, e, f, g, h, i)
LAYER(void *, clEnqueueMapBuffer,
      (cl_command_queue a, cl_mem b, cl_bool c, cl_map_flags d, size_t e, size_t f, cl_uint g, const cl_event *h,
       cl_event *i, cl_int *j),
      a, b, c, d, e, f, g, h, i, j)
LAYER(cl_int, clEnqueueUnmapMemObject,
      (cl_command_queue a, cl_mem b, void *c, cl_uint d, const cl_event *e, cl_event *f), a, b, c, d, e, f)
LAYER(cl_int, clFlush, (cl_command_queue a), a)
LAYER(cl_int, clFinish, (cl_command_queue a), a)
LAYER(cl_int, clWaitForEvents, (cl_uint a, const cl_event *b), a, b)
LAYER(cl_int, clGetEventProfilingInfo, (cl_event a, cl_profiling_info b, size_t c, void *d, size_t *e), a, b, c, d, e)
LAYER(cl_int, clGetMemObjectInfo, (cl_mem a, cl_mem_info b, size_t c, void *d, size_t *e), a, b, c, d, e)
LAYER(cl_int, clGetCommandQueueInfo, (cl_command_queue a, cl_command_queue_info b, size_t c, void *d, size_t *e), a, b,
      c, d, e)

namespace {
std::atomic<bool> has_thrown{false};
}

extern "C" cl_int clBuildProgram(cl_program a, cl_uint b, const cl_device_id *c, const char *d,
                                 void(CL_CALLBACK *e)(cl_program, void *), void *f) {
    static const char *const text = std::getenv("GRADUS_TEST_THROWING_BUILD");
    static std::atomic<long> left{text ? std::atol(text) : 0};
    if (text && --left == 0) {
        has_thrown = true;
        throw std::bad_alloc();
    }
    return forward("clBuildProgram", &clBuildProgram, a, b, c, d, e, f);
}

extern "C" cl_int clReleaseProgram(cl_program program) {
    cl_uint references = 0;
    if (has_thrown)
        clGetProgramInfo(program, CL_PROGRAM_REFERENCE_COUNT, sizeof references, &references, nullptr);
    if (references == 1)
        std::abort();
    return reinterpret_cast<decltype(&clReleaseProgram)>(::dlsym(RTLD_NEXT, "clReleaseProgram"))(program);
}
