/* One source, three compilers: OpenCL C for the device, host C++ in double for the reference, host C++ in
 * float for the sanitizers. Everything that differs between them is in this file.
 *
 * `real` is float, or double where GRADUS_DOUBLE is defined. Write constants as R(0.5), never as 0.5. */
#ifndef GRADUS_SHARED_COMPAT_H
#define GRADUS_SHARED_COMPAT_H

#ifdef GRADUS_DOUBLE
#ifdef __OPENCL_VERSION__
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
typedef double real;
#else
typedef float real;
#endif

#include "kernels/shared/builtins.h"

#ifdef __OPENCL_VERSION__

#define R(constant) ((real)(constant))
#define GRADUS_LIB_BEGIN
#define GRADUS_LIB_END
#ifndef GRADUS_FN /* a checker that cannot read inlined code names another one */
#define GRADUS_FN static inline __attribute__((always_inline))
#endif
#define GRADUS_GLOBAL __global

/* The number of this work-item in a launch of so many of them: Kernel::launch spreads them over lines. */
#define work_item() (get_global_id(1) * get_global_size(0) + get_global_id(0))

#else /* host C++ */

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

/* A translation unit sees one precision; a program may hold both, so each has its namespace. */
#ifdef GRADUS_DOUBLE
#define GRADUS_LIB_BEGIN                                                                                               \
    namespace gradus {                                                                                                 \
    namespace lib_double {
#else
#define GRADUS_LIB_BEGIN                                                                                               \
    namespace gradus {                                                                                                 \
    namespace lib_float {
#endif
#define GRADUS_LIB_END                                                                                                 \
    }                                                                                                                  \
    }
#define GRADUS_FN static inline __attribute__((unused))
#define GRADUS_GLOBAL

/* No macro: headers of other libraries have the name, and may come after this one. */
__attribute__((unused)) static constexpr real R(double constant) { return (real)constant; }

typedef std::uint32_t uint;
typedef std::uint64_t ulong;

static inline __attribute__((unused)) uint as_uint(float x) {
    uint bits;
    std::memcpy(&bits, &x, sizeof bits);
    return bits;
}
static inline __attribute__((unused)) float as_float(uint bits) {
    float x;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}

GRADUS_LIB_BEGIN
GRADUS_FN uint min(uint a, uint b) { return a < b ? a : b; }
GRADUS_FN uint max(uint a, uint b) { return a > b ? a : b; }
GRADUS_FN uint mul_hi(uint a, uint b) { return (uint)((ulong)a * b >> 32); }
GRADUS_LIB_END

#endif

/* Ends every small struct. The x86-64 calling convention passes a struct of up to 16 bytes as short vectors, and PoCL
 * does not vectorise over work-items where such are left after inlining; a larger one goes through memory, which
 * inlining removes without a trace. */
#ifdef __OPENCL_VERSION__
#define GRADUS_NOT_IN_REGISTERS real not_in_registers[4];
#else
#define GRADUS_NOT_IN_REGISTERS
#endif

/* The only built-ins that kernels/lib may call: each vectorises on every CPU implementation and is one
 * instruction on GPUs. They are declared in kernels/shared/builtins.h too. Transcendental functions are in
 * kernels/lib/approximation.h. */
#ifdef __OPENCL_VERSION__
#define r_sqrt(x) sqrt((real)(x))
#define r_abs(x) fabs((real)(x))
#define r_floor(x) floor((real)(x))
#else
#define r_sqrt(x) std::sqrt((real)(x))
#define r_abs(x) std::fabs((real)(x))
#define r_floor(x) std::floor((real)(x))
#endif
/* Ternaries, not fmin and fmax: those must treat NaN, which costs instructions. */
#define r_min(a, b) ((a) < (b) ? (a) : (b))
#define r_max(a, b) ((a) > (b) ? (a) : (b))
#define r_clamp(x, low, high) r_min(r_max(x, low), high)
/* A difference of uints below 2^31, or 0 where it is negative. A choice would become an operation (saturating
 * subtraction) that not every OpenCL implementation knows. */
#ifdef __OPENCL_VERSION__
#define r_not_negative(x) ((uint)max((int)(x), 0))
#else
#define r_not_negative(x) ((int)(x) < 0 ? 0u : (uint)(x))
#endif
#define r_copysign1(x) ((x) < R(0) ? R(-1) : R(1))

#define GRADUS_PI R(3.14159265358979323846)
#define GRADUS_INV_PI R(0.31830988618379067154)

#endif
