// The tables of one batch of paths on the device, and how large a batch may be.
//
// A batch is the paths that are in flight at once. A pass is more paths than that: when some end, others begin in their
// rows, so that a batch stays full until the pass runs out.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/program.h"
#include "runtime/scene/traits.h"

#include <cstdint>

namespace gradus {

/// Passes are this many batches long.
constexpr std::uint32_t batches_a_pass = 4;

/// Rows that each work-item of the partition counts.
constexpr std::uint32_t partition_chunk = 256;

struct BatchTables {
    /// For passes of so many paths, with `bins` of the partition, the escaped included. Allocates only what the traits
    /// ask for.
    BatchTables(Device &device, std::uint32_t capacity, std::uint32_t paths, std::uint32_t bins, const TraitMap &traits,
                Precision precision);

    std::uint32_t capacity; ///< paths in flight
    std::uint32_t slots;    ///< rows of the tables that have one for each path of a pass; a few more than those
    Precision precision;    ///< of the columns that are real
    Buffer ray, shadow, radiance, feature, tangent;
    Buffer vertex[2]; ///< surface reads one and writes the other
    Buffer bin, offset, index, range;
};

/// Bytes of a batch for each path in it.
std::size_t batch_bytes_per_path(const TraitMap &traits, Precision precision);

/// Paths in flight where nobody asks for another number.
std::uint32_t default_batch_size(const Device &device);

/// The batch size for a request (0: the device's default), bounded by the device's memory and by what there is to
/// do. Throws Error where not even a small batch fits.
std::uint32_t choose_batch_size(Device &device, std::uint32_t requested, std::uint64_t samples, const TraitMap &traits,
                                Precision precision);

} // namespace gradus
