// A Device and Buffers made of what a caller of OpenCL's C interface has already.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "runtime/device/buffer.h"
#include "runtime/device/device.h"
#include "runtime/device/program.h"
#include "runtime/error.h"

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <thread>
#include <vector>

namespace gradus {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The first device of the first platform, with contexts and queues that OpenCL counts references of.
class CallersQueue : public ::testing::Test {
  protected:
    void SetUp() override {
        cl_platform_id platform = nullptr;
        ASSERT_EQ(clGetPlatformIDs(1, &platform, nullptr), CL_SUCCESS);
        ASSERT_EQ(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device_id, nullptr), CL_SUCCESS);
        context = make_context();
    }
    void TearDown() override {
        for (const cl_command_queue queue : queues)
            EXPECT_EQ(clReleaseCommandQueue(queue), CL_SUCCESS);
        for (const cl_context made : contexts)
            EXPECT_EQ(clReleaseContext(made), CL_SUCCESS);
    }

    cl_context make_context() {
        contexts.push_back(clCreateContext(nullptr, 1, &device_id, nullptr, nullptr, nullptr));
        EXPECT_NE(contexts.back(), nullptr);
        return contexts.back();
    }
    cl_command_queue make_queue(cl_command_queue_properties properties) {
        queues.push_back(clCreateCommandQueue(context, device_id, properties, nullptr));
        EXPECT_NE(queues.back(), nullptr);
        return queues.back();
    }
    cl_mem make_buffer(cl_context owner, const std::vector<cl_uint> &values) {
        return clCreateBuffer(owner, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, values.size() * sizeof(cl_uint),
                              const_cast<cl_uint *>(values.data()), nullptr);
    }
    static cl_uint references(cl_context object) {
        cl_uint count = 0;
        EXPECT_EQ(clGetContextInfo(object, CL_CONTEXT_REFERENCE_COUNT, sizeof count, &count, nullptr), CL_SUCCESS);
        return count;
    }
    static cl_uint references(cl_command_queue object) {
        cl_uint count = 0;
        EXPECT_EQ(clGetCommandQueueInfo(object, CL_QUEUE_REFERENCE_COUNT, sizeof count, &count, nullptr), CL_SUCCESS);
        return count;
    }
    static cl_uint references(cl_mem object) {
        cl_uint count = 0;
        EXPECT_EQ(clGetMemObjectInfo(object, CL_MEM_REFERENCE_COUNT, sizeof count, &count, nullptr), CL_SUCCESS);
        return count;
    }

    /// A kernel that sums up the counts of chunks, launched on caller's buffers: {3, 1, 4, 1, 5, 9} in 3 bins.
    Kernel launch_scan(Device &device, cl_mem counts, cl_mem ranges) {
        KernelLibrary library(device, {});
        const KernelRequest scan = {
            "partition scan", "kernels/stages/partition.cl", "partition_scan", {{"PARTITION_CHUNK", "4"}}};
        Kernel kernel = library.build({scan})[0];
        kernel.bind(Buffer::wrap(device, "chunk_offset", counts));
        kernel.bind(Buffer::wrap(device, "range", ranges));
        kernel.set("count", 1);
        kernel.set("bins", 3);
        kernel.set("chunks", 2);
        kernel.launch(1);
        return kernel;
    }

    cl_device_id device_id = nullptr;
    cl_context context = nullptr;
    std::vector<cl_context> contexts;
    std::vector<cl_command_queue> queues;
};

template <class Function>
void expect_device_error(Function function, const std::string &message) {
    try {
        function();
        ADD_FAILURE() << "no error with \"" << message << "\"";
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::device);
        EXPECT_THAT(error.what(), HasSubstr(message));
    }
}

TEST_F(CallersQueue, IsWhatADeviceRunsOn) {
    const cl_command_queue queue = make_queue(CL_QUEUE_PROFILING_ENABLE);
    Device device(context, queue);
    EXPECT_EQ(device.description().name, list_devices()[0].name);
    EXPECT_EQ(device.description().platform, list_devices()[0].platform);
    EXPECT_EQ(device.description().allocation_bytes, list_devices()[0].allocation_bytes);

    const cl_mem counts = make_buffer(context, {0, 0, 0, 0, 0, 0});
    const cl_mem ranges = make_buffer(context, std::vector<cl_uint>(8, 0xC0FFEE));
    // The caller's command is still in the queue when the kernel is launched: it must come first.
    const std::array<cl_uint, 6> values = {3, 1, 4, 1, 5, 9};
    ASSERT_EQ(clEnqueueWriteBuffer(queue, counts, CL_FALSE, 0, sizeof values, values.data(), 0, nullptr, nullptr),
              CL_SUCCESS);
    const Kernel kernel = launch_scan(device, counts, ranges);
    std::vector<cl_uint> result(8);
    ASSERT_EQ(clEnqueueReadBuffer(queue, ranges, CL_TRUE, 0, 32, result.data(), 0, nullptr, nullptr), CL_SUCCESS);
    EXPECT_THAT(result, ElementsAre(0, 4, 9, 23, 0xC0FFEE, 0xC0FFEE, 0xC0FFEE, 0xC0FFEE));
    EXPECT_GT(kernel.usage().seconds, 0);
    clReleaseMemObject(counts);
    clReleaseMemObject(ranges);
}

TEST_F(CallersQueue, NeedNotTimeKernels) {
    const cl_command_queue queue = make_queue(0);
    Device device(context, queue);
    const cl_mem counts = make_buffer(context, {3, 1, 4, 1, 5, 9}), ranges = make_buffer(context, {0, 0, 0, 0});
    Kernel kernel = launch_scan(device, counts, ranges);
    // More launches than are kept before their times are collected.
    for (int i = 1; i < 300; ++i)
        kernel.launch(1);
    const Kernel::Usage usage = kernel.usage();
    EXPECT_EQ(usage.launches, 300u);
    EXPECT_EQ(usage.seconds, 0);
    kernel.reset_usage();
    EXPECT_EQ(kernel.usage().launches, 0u);
    finish(device); // PoCL compiles when a kernel is about to run, which a process that exits cuts short
    clReleaseMemObject(counts);
    clReleaseMemObject(ranges);
}

TEST_F(CallersQueue, IsRetained) {
    const cl_command_queue queue = make_queue(0);
    const cl_uint contexts_before = references(context);
    const cl_mem memory = make_buffer(context, {1, 2, 3, 4});
    {
        Device device(context, queue);
        EXPECT_GT(references(context), contexts_before);
        EXPECT_EQ(references(queue), 2u);
        Buffer kept;
        {
            const Buffer buffer = Buffer::wrap(device, "numbers", memory);
            kept = buffer;
            EXPECT_EQ(references(memory), 2u) << "copies share one reference";
        }
        EXPECT_EQ(clReleaseMemObject(memory), CL_SUCCESS);
        std::vector<cl_uint> values(4);
        kept.read(values.data(), 16);
        EXPECT_THAT(values, ElementsAre(1, 2, 3, 4)) << "after the caller let it go";
    }
    // PoCL's threads let go of a command a little after those that wait for it go on.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (references(queue) != 1 && std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(references(queue), 1u);
    EXPECT_EQ(references(context), contexts_before);
}

TEST_F(CallersQueue, ThatWillNotDoIsAnError) {
    const cl_command_queue queue = make_queue(0);
    expect_device_error([&] { Device(nullptr, queue); }, "null");
    expect_device_error([&] { Device(context, nullptr); }, "null");
    expect_device_error([&] { Device(make_context(), queue); }, "another context");
    cl_command_queue_properties supported = 0;
    ASSERT_EQ(clGetDeviceInfo(device_id, CL_DEVICE_QUEUE_PROPERTIES, sizeof supported, &supported, nullptr),
              CL_SUCCESS);
    if (!(supported & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE))
        GTEST_SKIP() << "the device has no queue that runs out of order";
    const cl_command_queue unordered = make_queue(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE);
    expect_device_error([&] { Device(context, unordered); }, "out of order");
    EXPECT_EQ(references(unordered), 1u) << "let go with the error";
}

TEST_F(CallersQueue, TakesBuffersThatAreNotCounted) {
    Device device(context, make_queue(0));
    const cl_mem memory = make_buffer(context, {1, 2, 3, 4, 5});
    {
        Buffer buffer = Buffer::wrap(device, "numbers", memory);
        EXPECT_TRUE(buffer.valid());
        EXPECT_EQ(buffer.name(), "numbers");
        EXPECT_EQ(buffer.bytes(), 20u);
        EXPECT_EQ(buffer.map(Access::read).as<cl_uint>()[4], 5u);
        buffer.clear();
        std::vector<cl_uint> values(5, 7);
        buffer.read(values.data(), 20);
        EXPECT_THAT(values, Each(0u));
    }
    EXPECT_EQ(peak_device_bytes(device), 0u);
    const Buffer ours(device, "ours", 100);
    EXPECT_EQ(peak_device_bytes(device), 100u) << "nor taken off when it was let go";
    clReleaseMemObject(memory);
}

TEST_F(CallersQueue, TakesBuffersOfItsContextOnly) {
    Device device(context, make_queue(0));
    expect_device_error([&] { Buffer::wrap(device, "primal", nullptr); }, "primal");
    const cl_mem foreign = make_buffer(make_context(), {1, 2, 3, 4});
    expect_device_error([&] { Buffer::wrap(device, "primal", foreign); }, "primal: the OpenCL buffer belongs to");
    EXPECT_EQ(references(foreign), 1u);
    clReleaseMemObject(foreign);
    const cl_image_format format = {CL_RGBA, CL_FLOAT};
    cl_image_desc description = {};
    description.image_type = CL_MEM_OBJECT_IMAGE2D;
    description.image_width = description.image_height = 4;
    const cl_mem image = clCreateImage(context, CL_MEM_READ_WRITE, &format, &description, nullptr, nullptr);
    if (!image)
        GTEST_SKIP() << "the device has no images";
    expect_device_error([&] { Buffer::wrap(device, "primal", image); }, "not a buffer");
    clReleaseMemObject(image);
}

} // namespace
} // namespace gradus
