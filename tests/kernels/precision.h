// Names the build of kernels/lib that a test file sees: every test is compiled once in float and once in double.
#pragma once

// First: it has template parameters named R, which is a macro of kernels/shared/compat.h.
#include <gtest/gtest.h>

#include "kernels/lib/approximation.h"
#include "kernels/lib/bsdf.h"
#include "kernels/lib/frame.h"
#include "kernels/lib/microfacet.h"
#include "kernels/lib/warp.h"

namespace gradus::testing {

#ifdef GRADUS_DOUBLE
namespace lib = gradus::lib_double;
constexpr bool is_double = true;
#else
namespace lib = gradus::lib_float;
constexpr bool is_double = false;
#endif

/// The bound that holds in this build.
constexpr double bound(double in_float, double in_double) { return is_double ? in_double : in_float; }

/// Samples a statistical test draws: fewer under the sanitizers, whose build looks for faults, not for bias.
#ifdef GRADUS_SANITIZED
constexpr int sample_count = 20'000;
#else
constexpr int sample_count = 200'000;
#endif

} // namespace gradus::testing
