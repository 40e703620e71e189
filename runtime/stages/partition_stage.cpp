#include "runtime/stages/partition_stage.h"

namespace gradus {

std::vector<KernelRequest> PartitionStage::requests() {
    const std::map<std::string, std::string> definitions = {{"PARTITION_CHUNK", std::to_string(partition_chunk)}};
    const std::string file = "kernels/stages/partition.cl";
    return {{"partition count", file, "partition_count", definitions},
            {"partition scan", file, "partition_scan", definitions},
            {"partition scatter", file, "partition_scatter", definitions}};
}

PartitionStage::PartitionStage(std::vector<Kernel> kernels, const BatchTables &tables, std::uint32_t bins)
    : count_(kernels[0]), scan_(kernels[1]), scatter_(kernels[2]), range_buffer_(tables.range), range_(bins + 1) {
    for (Kernel *kernel : {&count_, &scan_, &scatter_}) {
        for (const Buffer *buffer : {&tables.bin, &tables.offset, &tables.index, &tables.range})
            kernel->bind(*buffer);
        kernel->set("bins", bins);
    }
}

const std::vector<std::uint32_t> &PartitionStage::run(std::uint32_t count) {
    const std::uint32_t chunks = (count + partition_chunk - 1) / partition_chunk;
    for (Kernel *kernel : {&count_, &scan_, &scatter_}) {
        kernel->set("count", count);
        kernel->set("chunks", chunks);
    }
    count_.launch(chunks);
    scan_.launch(1);
    // The host plans with the ranges while the rows are scattered.
    Buffer::Reading reading = range_buffer_.start_read(range_.data(), range_.size() * sizeof(std::uint32_t));
    scatter_.launch(chunks);
    reading.wait();
    return range_;
}

} // namespace gradus
