#include "runtime/stages/batch_tables.h"

#include "kernels/shared/tables.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace gradus {

using namespace lib_float;

namespace {

// On a CPU a batch should stay near the last-level cache; a GPU wants many rows to hide its latencies.
constexpr std::uint32_t default_batch_cpu = 1u << 17, default_batch_other = 1u << 20;
constexpr std::uint32_t least_batch = 64, largest_batch = 1u << 24;

std::uint32_t vertex_column_count(const TraitMap &traits) {
    if (traits.at("TRAIT_REFRACTION"))
        return vertex_columns;
    return static_cast<std::uint32_t>(traits.at("TRAIT_SHADING_NORMALS") ? int(vertex_eta) : int(vertex_shading_x));
}

/// Kernels write many columns of these tables at once, at rows that are not quite in order. Columns that were a power
/// of two apart would share the same few lines of the caches. So they are an odd number of lines apart.
std::uint32_t slot_rows(std::uint32_t paths) {
    constexpr std::uint32_t line = 64 / sizeof(float);
    return ((paths + line - 1) / line | 1u) * line;
}

} // namespace

BatchTables::BatchTables(Device &device, std::uint32_t rows, std::uint32_t paths, std::uint32_t bins,
                         const TraitMap &traits, Precision real_precision)
    : capacity(rows), slots(slot_rows(paths)), precision(real_precision) {
    const std::size_t column = real_bytes(precision) * capacity, slot_column = real_bytes(precision) * slots;
    const std::size_t chunks = (capacity + partition_chunk - 1) / partition_chunk;
    ray = Buffer(device, "ray", column * ray_columns);
    shadow = Buffer(device, "shadow", column * shadow_columns);
    for (Buffer &v : vertex)
        v = Buffer(device, "vertex", column * vertex_column_count(traits));
    radiance = Buffer(device, "radiance", slot_column * radiance_columns);
    feature = Buffer(device, "feature", traits.at("TRAIT_AOV") ? slot_column * feature_columns : 0);
    tangent = Buffer(device, "tangent", traits.at("TRAIT_ANISOTROPIC") ? column * tangent_columns : 0);
    bin = Buffer(device, "bin", sizeof(std::uint32_t) * capacity);
    index = Buffer(device, "index", sizeof(std::uint32_t) * capacity);
    offset = Buffer(device, "offset", sizeof(std::uint32_t) * chunks * bins);
    range = Buffer(device, "range", sizeof(std::uint32_t) * (bins + 1));
}

std::size_t batch_bytes_per_path(const TraitMap &traits, Precision precision) {
    std::size_t columns = 2 * vertex_column_count(traits);
    for (int table : {int(ray_columns), int(shadow_columns), int(batches_a_pass * radiance_columns)})
        columns += static_cast<std::size_t>(table);
    columns += traits.at("TRAIT_AOV") ? batches_a_pass * feature_columns : 0;
    columns += traits.at("TRAIT_ANISOTROPIC") ? tangent_columns : 0;
    return columns * real_bytes(precision) + 2 * sizeof(std::uint32_t);
}

std::uint32_t default_batch_size(const Device &device) {
    return device.description().type == "cpu" ? default_batch_cpu : default_batch_other;
}

std::uint32_t choose_batch_size(Device &device, std::uint32_t requested, std::uint64_t samples, const TraitMap &traits,
                                Precision precision) {
    const DeviceDescription &d = device.description();
    const std::size_t per_path = batch_bytes_per_path(traits, precision);
    const std::size_t largest_table =
        real_bytes(precision) *
        std::max<std::size_t>(vertex_column_count(traits),
                              batches_a_pass * (traits.at("TRAIT_AOV") ? int(feature_columns) : int(radiance_columns)));
    // Half the memory is for the scene and for others; one table may not pass the largest allocation.
    const std::uint64_t fits =
        std::min<std::uint64_t>(d.memory_bytes / 2 / per_path, d.allocation_bytes / largest_table);
    if (fits < least_batch)
        throw Error(ExitCode::device, fmt::format("{} has not enough memory for {} paths", d.name, least_batch));
    std::uint64_t size = requested ? requested : default_batch_size(device);
    size = std::min<std::uint64_t>({size, largest_batch, std::max<std::uint64_t>(samples, 1)});
    const std::uint64_t rounded_up = (size + least_batch - 1) / least_batch * least_batch;
    return static_cast<std::uint32_t>(std::min(rounded_up, fits / least_batch * least_batch));
}

} // namespace gradus
