// Sorts the rows of a batch by what they need next.
#pragma once

#include "runtime/stages/batch_tables.h"

#include <vector>

namespace gradus {

class PartitionStage {
  public:
    /// Kernels that the stage asks for; they come back in this order.
    static std::vector<KernelRequest> requests();

    PartitionStage(std::vector<Kernel> kernels, const BatchTables &tables, std::uint32_t bins);

    /// Sorts rows [0, count) by `bin` into `index`. Returns bins + 1 places: bin b is index[range[b]] to
    /// index[range[b + 1]]. Waits for the device.
    const std::vector<std::uint32_t> &run(std::uint32_t count);

  private:
    Kernel count_, scan_, scatter_;
    const Buffer &range_buffer_;
    std::vector<std::uint32_t> range_;
};

} // namespace gradus
