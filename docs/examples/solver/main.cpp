// Gradus's Poisson solver on a program's own OpenCL context, queue and buffers.
//
// The differences are those of an image, but the primal is off by a wave, cos(pi k (x + 1/2) / width). Of such a wave
// the L2 solution keeps the share alpha^2 / (alpha^2 + 2 - 2 cos(pi k / width)): the answer is known.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <gradus/solver/poisson_solver.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

constexpr std::uint32_t width = 64, height = 48, channels = 3;
constexpr std::size_t size = std::size_t(width) * height * channels;
constexpr double pi = 3.14159265358979323846, alpha = 0.2, wave_number = 8;

void check(cl_int status, const char *doing) {
    if (status != CL_SUCCESS)
        throw std::runtime_error(std::string(doing) + ": OpenCL error " + std::to_string(status));
}

double image(int c, int x, int y) { return (c + 1) * (0.01 * x + (x > y ? 1 : 0.2)); }
double wave(int x) { return 0.5 * std::cos(pi * wave_number * (x + 0.5) / width); }

/// An image's planes, one channel after the other.
template <class Function>
std::vector<float> planes(Function value) {
    std::vector<float> result(size);
    for (std::size_t i = 0; i < size; ++i)
        result[i] = float(value(int(i / width / height), int(i % width), int(i / width % height)));
    return result;
}

/// The root mean square error of a solution on the caller's queue.
double solve(cl_context context, cl_command_queue queue) {
    gradus::Device device(context, queue);
    const auto buffer = [&](const char *name, std::vector<float> values) {
        cl_int status;
        const cl_mem_flags flags = CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR;
        cl_mem memory = clCreateBuffer(context, flags, size * sizeof(float), values.data(), &status);
        check(status, "clCreateBuffer");
        gradus::Buffer wrapped = gradus::Buffer::wrap(device, name, memory);
        clReleaseMemObject(memory); // `wrapped` holds a reference of its own
        return wrapped;
    };
    const auto primal = buffer("primal", planes([](int c, int x, int y) { return image(c, x, y) + wave(x); }));
    const auto dx = buffer("dx", planes([](int c, int x, int y) { return image(c, x + 1, y) - image(c, x, y); }));
    const auto dy = buffer("dy", planes([](int c, int x, int y) { return image(c, x, y + 1) - image(c, x, y); }));
    auto result = buffer("result", std::vector<float>(size));

    gradus::PoissonSolver solver(device, width, height, channels);
    const gradus::DeviceImages images = {.primal = &primal, .dx = &dx, .dy = &dy};
    const gradus::PoissonOptions options = {.norm = gradus::PoissonNorm::l2, .alpha = alpha, .tolerance = 1e-6};
    const gradus::PoissonReport report = solver.solve(images, options, result);
    std::printf("%s, %d iterations\n", report.method.c_str(), report.iterations);

    const double share = alpha * alpha / (alpha * alpha + 2 - 2 * std::cos(pi * wave_number / width));
    const auto expected = planes([&](int c, int x, int y) { return image(c, x, y) + share * wave(x); });
    std::vector<float> solution(size);
    result.read(solution.data(), size * sizeof(float));
    double squares = 0;
    for (std::size_t i = 0; i < size; ++i)
        squares += (solution[i] - expected[i]) * (solution[i] - expected[i]);
    return std::sqrt(squares / size);
}

int main() {
    try {
        cl_platform_id platform;
        cl_device_id device;
        cl_int status;
        check(clGetPlatformIDs(1, &platform, nullptr), "clGetPlatformIDs");
        check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, nullptr), "clGetDeviceIDs");
        cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status);
        check(status, "clCreateContext");
        cl_command_queue queue = clCreateCommandQueue(context, device, 0, &status);
        check(status, "clCreateCommandQueue");
        const double error = solve(context, queue);
        clReleaseCommandQueue(queue);
        clReleaseContext(context);
        std::printf("root mean square error %.1e\n", error);
        return error < 1e-5 ? 0 : 1;
    } catch (const std::exception &error) { // gradus::Error is one
        std::fprintf(stderr, "solver_example: %s\n", error.what());
        return 1;
    }
}
