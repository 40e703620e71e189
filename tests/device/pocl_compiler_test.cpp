// What the processes that compile have PoCL's compiler do.
#include "runtime/device/compile_workers.h"
#include "runtime/device/opencl.h"

#include <gmock/gmock.h>

#include <sys/resource.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace gradus {
namespace {

// A kernel in which three things keep LLVM 15 from vectorising over work-items on a processor without AVX-512, of which
// each is enough: gathers, more than one scattered store, and like operations on neighbouring fields.
const char *const source = R"(
static float4_of scaled(float4_of v, float by) {
    v.x *= by, v.y *= by, v.z *= by, v.w *= by;
    return v;
}
__attribute__((reqd_work_group_size(64, 1, 1))) __kernel
void NAME(uint count, __global const uint *index, __global const float *records, __global float *to) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const size_t row = 4 * (size_t)index[i];
    float4_of v;
    v.x = records[row], v.y = records[row + 1], v.z = records[row + 2], v.w = records[row + 3];
    v = scaled(v, 1.0f / sqrt(v.x * v.x + v.y * v.y + v.z * v.z + v.w * v.w));
    to[row] = v.x, to[row + 1] = v.y, to[row + 2] = v.z, to[row + 3] = v.w;
}
)";

/// How many places look like instructions that gather, by their prefix and number (VEX or EVEX, 0F 38 92 or
/// 93).
std::size_t gathers(const std::string &code) {
    std::size_t found = 0;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(code[i]); };
    for (std::size_t i = 0; i + 4 < code.size(); ++i) {
        const bool is_vex = byte(i) == 0xC4 && (byte(i + 1) & 0x1F) == 2 && (byte(i + 2) & 3) == 1;
        const bool is_evex = byte(i) == 0x62 && (byte(i + 1) & 0x0F) == 2 && (byte(i + 2) & 7) == 5;
        const unsigned number = is_vex ? byte(i + 3) : byte(i + 4);
        found += (is_vex || is_evex) && (number == 0x92 || number == 0x93);
    }
    return found;
}

/// How many places look like instructions on 64 bytes: the prefix EVEX with its fixed bits and that length.
std::size_t wide_instructions(const std::string &code) {
    std::size_t found = 0;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(code[i]); };
    for (std::size_t i = 0; i + 3 < code.size(); ++i)
        found += byte(i) == 0x62 && (byte(i + 1) & 0x0C) == 0 && (byte(i + 2) & 4) == 4 && (byte(i + 3) & 0x60) == 0x40;
    return found;
}

bool has_processor(const char *name) {
    for (const DeviceDescription &found : list_devices())
        if (found.name.find(name) != std::string::npos)
            return true;
    return false;
}

class PoclCompiler : public ::testing::Test {
  protected:
    void SetUp() override {
        const std::vector<DeviceDescription> devices = list_devices();
        const auto found = std::ranges::find_if(devices, [](const DeviceDescription &device) {
            return is_pocl_3_1_cpu(device) || is_pocl_5_or_6_cpu(device);
        });
        if (found == devices.end())
            GTEST_SKIP() << "needs PoCL 3.1, 5 or 6";
        device_ = *found;
    }

    /// The code of a kernel.
    std::string compiled_source(const std::string &name, const std::string &text) const {
        CompileJob job;
        job.device = device_;
        job.source = {name, text, "-cl-std=CL1.2 -cl-kernel-arg-info -D NAME=" + name};
        CompileAnswer answer;
        CompileWorkers().compile({job}, 64, 1, [&](std::size_t, const CompileAnswer &one) { answer = one; });
        EXPECT_EQ(answer.kind, CompileAnswer::Kind::compiled) << answer.content;
        return answer.content;
    }
    /// That of the kernel above, by that name.
    std::string compiled(const std::string &name = "normalize_records") const {
        return compiled_source(name, "typedef struct { float x, y, z, w, more; } float4_of;" + std::string(source));
    }

    DeviceDescription device_;
};

class PoclCompilerOf31 : public PoclCompiler {
  protected:
    void SetUp() override {
        PoclCompiler::SetUp();
        if (!IsSkipped() && !is_pocl_3_1_cpu(device_))
            GTEST_SKIP() << "needs PoCL 3.1";
    }
};

TEST_F(PoclCompiler, VectorisesGathersAndScattersOfRecords) {
    if (!(has_processor("haswell") || has_processor("skylake")))
        GTEST_SKIP() << "needs PoCL of Debian on a processor that gathers";
    EXPECT_GE(gathers(compiled()), 3u);
}

TEST_F(PoclCompilerOf31, TakesSixteenWorkItemsOfSomeKernels) {
    const std::string wide = compiled("shade"), narrow = compiled("shift");
    // Of the kernel's code some 200 are; by chance some 30 places look like them. Without AVX-512 there are none.
    constexpr std::size_t border = 100;
    EXPECT_LT(wide_instructions(narrow), border);
    EXPECT_EQ(wide_instructions(wide) > border, has_processor("avx512"));
}

TEST_F(PoclCompilerOf31, LeavesOutWhatNobodyLaunches) {
    const std::string code = compiled();
    EXPECT_NE(code.find("_pocl_kernel_normalize_records_workgroup"), std::string::npos);
    EXPECT_EQ(code.find("_workgroup_fast"), std::string::npos);
}

// What a library defines is known by the library's name in the code.
TEST_F(PoclCompilerOf31, LinksNoLibraryWhereNoneIsUsed) {
    const std::string code = compiled();
    EXPECT_EQ(code.find("libc.so"), std::string::npos);
    EXPECT_EQ(code.find("libm.so"), std::string::npos);
}

TEST_F(PoclCompilerOf31, LinksALibraryThatIsUsed) {
    const std::string code = compiled_source("copy_records", R"(
typedef struct { float all[1000]; } record;
__kernel void NAME(__global const record *from, __global record *to) { to[get_global_id(0)] = from[get_global_id(0)]; }
)");
    EXPECT_NE(code.find("memcpy"), std::string::npos) << "uses no library";
    EXPECT_NE(code.find("libc.so"), std::string::npos);
}

// Reading all of it takes 30000 pages of memory more, and most of the time until the first kernel is compiled.
TEST_F(PoclCompilerOf31, ReadsOfItsLibraryWhatKernelsCall) {
    const auto pages_of_children = [] {
        rusage used{};
        getrusage(RUSAGE_CHILDREN, &used);
        return used.ru_minflt;
    };
    const long before = pages_of_children();
    compiled();
    EXPECT_LT(pages_of_children() - before, 20000);
}

} // namespace
} // namespace gradus
