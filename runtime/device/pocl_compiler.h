// Having PoCL's compiler vectorise over work-items where it would not.
#pragma once

#include "runtime/device/device.h"

namespace cl {
class Context;
class Device;
} // namespace cl

namespace gradus {

/// Sets up the compiler of PoCL 3.1, 5 and 6 in this process, for all that it compiles from now on:
///
/// - LLVM packs like operations of one work-item into short vectors, after which it does not vectorise over work-items.
///   It is told not to.
/// - Where the processor cannot scatter (all without AVX-512) it gives up on kernels with more than one such store. It
///   is told to store one work-item after the other.
///
/// That of PoCL 5 and 6: LLVM from 17 on has calls of small functions stay calls, which stand in the way of vectors,
/// where one flushes denormal numbers and the other does not. It is told not to. (That it vectorises at all is the
/// matter of runtime/compiler/pocl_target_machine.cpp.)
///
/// And that of PoCL 3.1:
///
/// - Debian's compiles for one of a few processors. Where there is no AVX-512 that is Haswell, of which LLVM says that
///   gathers are slow, and then it vectorises next to no kernel of ours. It is made to compile for Skylake, which has
///   the same vectors.
/// - LLVM goes through expressions again and again until none changes. It is told to do so once, for compiling is
///   faster and the code is not slower.
///
/// Images stay the same bit for bit; on a Zen 3 processor renders take 0.6 of the time (docs/design.md).
///
/// PoCL offers none of these. Options of LLVM are those of the whole process, and what names the processor is a word of
/// PoCL's own record of the device: so this is for a process that only compiles, and may end of it. To be called before
/// there are programs. Does nothing for other implementations and versions.
void prepare_pocl_compiler(const cl::Context &context, const cl::Device &device, const DeviceDescription &description);
/// The same for the compiler of this device.
void prepare_pocl_compiler(Device &device);

} // namespace gradus
