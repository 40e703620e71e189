// What kernels need of a source, and which sources become the same.
#include "runtime/device/needed_source.h"

#include "runtime/device/kernel_source.h"
#include "tests/device/stage_files.h"

#include <gmock/gmock.h>

namespace gradus {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const char *const small_kernel = R"(#line 1 "kernels/small.cl"
typedef float real;
typedef struct { real x; } one;
typedef struct tag { int y; } two;
enum columns { column_a, column_b };
enum others { other_a };
static const real table[2] = {1, 2}, unused_table[1] = {0};
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
real __attribute__((overloadable, const)) sqrt(real);
real __attribute__((overloadable, const)) floor(real);
/* Used only with TRAIT_ROOT. */
static inline __attribute__((always_inline)) real root(real x) { return sqrt(x); }
static inline __attribute__((always_inline)) real value(one a) {
#if TRAIT_ROOT
    return root(a.x);
#else
    return table[column_b] * a.x;
#endif
}
static inline __attribute__((always_inline)) real of_nobody(two a) { return floor(a.y) + TRAIT_OF_NOBODY; }
__attribute__((reqd_work_group_size(SIZE, 1, 1))) __kernel void first(__global real *out) {
#pragma unroll
    for (int i = 0; i < 2; ++i)
        out[i] = value((one){i});
}
)";

NeededSource needed(const std::string &options) {
    const auto result = needed_source(small_kernel, options);
    EXPECT_TRUE(result) << options;
    return result.value_or(NeededSource{});
}

TEST(NeededSource, HoldsWhatTheKernelNames) {
    const NeededSource plain = needed("-D SIZE=64 -D TRAIT_ROOT=0");
    for (const char *there : {"typedef float real ;", "} one ;", "column_a", "table [ 2 ]", "value ( one a )",
                              "( 64 , 1", "\n#pragma OPENCL EXTENSION", "\n#pragma unroll\n", "__kernel void first"})
        EXPECT_THAT(plain.text, HasSubstr(there));
    for (const char *gone : {"two", "tag", "other_a", "sqrt", "floor", "root", "of_nobody", "SIZE", "Used"})
        EXPECT_THAT(plain.text, Not(HasSubstr(gone)));
    const NeededSource rooted = needed("-D SIZE=64 -D TRAIT_ROOT=1");
    EXPECT_THAT(rooted.text, HasSubstr("sqrt ( real ) ;"));
    EXPECT_THAT(rooted.text, Not(HasSubstr("columns")));
}

TEST(NeededSource, IsTheSameWhereNothingThatIsUsedDiffers) {
    const std::string plain = needed("-D SIZE=64 -D TRAIT_ROOT=0").meaning;
    EXPECT_EQ(needed("-D SIZE=64 -D TRAIT_ROOT=0 -D TRAIT_OF_NOBODY=7").meaning, plain);
    EXPECT_EQ(needed("-D SIZE=64").meaning, plain) << "a name that is not defined is 0";
    EXPECT_NE(needed("-D SIZE=32").meaning, plain);
    EXPECT_NE(needed("-D SIZE=64 -D TRAIT_ROOT=1").meaning, plain);
    std::string moved = small_kernel;
    moved.replace(moved.find("/* Used"), 7, "/*\n\n\nNot used");
    EXPECT_EQ(needed_source(moved, "-D SIZE=64")->meaning, plain) << "comments and lines";
}

TEST(NeededSource, NumbersItsLinesAsTheSourceDoes) {
    const NeededSource plain = needed("-D SIZE=64");
    EXPECT_THAT(plain.text, HasSubstr("#line 22 \"kernels/small.cl\"\nfor (")) << "after a pragma";
    EXPECT_THAT(plain.text, HasSubstr("#line 12 \"kernels/small.cl\"\nstatic inline"));
}

TEST(NeededSource, KeepsOptionsButDefinitionsOfOurs) {
    EXPECT_EQ(needed("-cl-std=CL1.2 -D SIZE=64 -D _OPENCL_H_ -DTRAIT_ROOT=1 -cl-denorms-are-zero").options,
              "-w -cl-std=CL1.2 -D _OPENCL_H_ -cl-denorms-are-zero");
    EXPECT_FALSE(needed_source(small_kernel, "-D NAME=\"two words\""));
    EXPECT_FALSE(needed_source("#error no", ""));
}

TEST(NeededSource, KnowsAllNamesOfADeclaration) {
    const auto text_of = [](const std::string &declaration) {
        const auto result = needed_source(declaration + "\n__kernel void k(__global uint *out) { out[0] = b; }", "");
        return result ? result->text : "not understood";
    };
    EXPECT_THAT(text_of("__constant uint a = 1u, b = 2u;"), HasSubstr("a = 1u , b"));
    EXPECT_THAT(text_of("__constant uint a[2] = {f(1, 2), 3}, b = 2u;"), HasSubstr("3 } , b"));
    EXPECT_THAT(text_of("__constant uint b[sizeof(float)] = {1u};"), HasSubstr("b [ sizeof"));
    EXPECT_THAT(text_of("__constant uint a = 1u, c = b;"), Not(HasSubstr("1u"))) << "which gives none";
}

// A tenth of the text is what this is for; a kernel that was not understood would be compiled whole, and alone.
TEST(NeededSource, IsMadeOfEveryKernel) {
    for (const std::string &path : testing::stage_files()) {
        const KernelSource &whole = kernel_source(path);
        const auto part = needed_source(whole.text, "-D WORK_GROUP_SIZE=64 -D BSDF=diffuse -D GRADUS_DECLARE_BUILTINS");
        ASSERT_TRUE(part) << path;
        EXPECT_THAT(part->text, HasSubstr("__kernel")) << path;
        EXPECT_LT(part->text.size(), whole.text.size() / 2) << path;
    }
}

} // namespace
} // namespace gradus
