// Denormals count as zero on the calling thread, as Embree asks for: they cost a hundred times a normal number.
#pragma once

#if defined(__SSE2__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#elif defined(__aarch64__)
#include <cstdint>
#endif

namespace gradus {

/// Where the processor is neither an x86 nor an ARM of 64 bits, it does nothing.
inline void flush_denormals() {
#if defined(__SSE2__)
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#elif defined(__aarch64__)
    constexpr std::uint64_t flush_to_zero = std::uint64_t(1) << 24; // inputs and results
    std::uint64_t control;
    asm volatile("mrs %0, fpcr" : "=r"(control));
    asm volatile("msr fpcr, %0" : : "r"(control | flush_to_zero));
#endif
}

} // namespace gradus
