#include "runtime/wavefront/table.h"

#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace gradus {

namespace {

// On a CPU each core's share of a batch should stay near its caches. But a launch costs some 25 us beside its rows on
// two cores, and 150 us and more on sixteen, which PoCL wakes one by one; so cores have a share of the same size,
// however many there are. A GPU wants many rows to hide its latencies.
constexpr std::uint32_t batch_of_core = 1u << 16, fewest_cores = 2, default_batch_other = 1u << 20;
// Where paths take few bytes there are twice as many of them.
constexpr std::uint64_t twice_below_bytes_of_core = 48u << 20;
// What cores beyond the fewest may add to, for machines that have many of them.
constexpr std::uint64_t most_bytes_of_cores = 1u << 30;
constexpr std::uint32_t least_batch = 64, largest_batch = 1u << 24;

std::uint32_t cores_of(const DeviceDescription &device) { return std::max(device.compute_units, fewest_cores); }

std::size_t element_bytes(const TableDeclaration &table, Precision precision) {
    return table.is_uint ? sizeof(std::uint32_t) : real_bytes(precision);
}

} // namespace

std::uint64_t TableRows::of(RowsOf kind) const {
    switch (kind) {
    case RowsOf::path:
        return paths;
    case RowsOf::slot:
        return slots;
    case RowsOf::chain:
        return chains;
    case RowsOf::pixel:
        return pixels;
    case RowsOf::image_row:
        return width;
    case RowsOf::chunk:
        return chunks;
    case RowsOf::one:
        return 1;
    }
    return 0;
}

std::uint64_t table_bytes(const TableDeclaration &table, const TableRows &rows, Precision precision) {
    return rows.of(table.rows) * table.multiple * table.columns * element_bytes(table, precision);
}

Tables::Tables(Device &device, const TableList &list, const TableRows &rows, Precision precision)
    : device_(device), rows_(rows), precision_(precision) {
    for (const TableDeclaration &table : list) {
        if (table.columns == 0)
            continue;
        Entry &entry = tables_[table.name];
        entry.declaration = table;
        for (int i = 0; i <= int(table.alternates); ++i) {
            entry.buffer[i] = Buffer(device, table.name, table_bytes(table, rows, precision));
            if (table.is_cleared)
                entry.buffer[i].clear();
        }
    }
}

const Tables::Entry &Tables::entry(const std::string &name) const {
    const auto found = tables_.find(name);
    if (found == tables_.end())
        throw std::logic_error("there is no table " + name);
    return found->second;
}

const Buffer &Tables::operator[](const std::string &name) const {
    const Entry &found = entry(name);
    return found.buffer[found.declaration.alternates ? newest_ : 0];
}

Buffer &Tables::operator[](const std::string &name) {
    return const_cast<Buffer &>(static_cast<const Tables &>(*this)[name]);
}

std::uint64_t Tables::rows_of(const std::string &name) const {
    const TableDeclaration &table = entry(name).declaration;
    return rows_.of(table.rows) * table.multiple;
}

void Tables::grow(const std::string &name, std::uint32_t multiple) {
    Entry &entry = tables_.at(name);
    if (!entry.declaration.grows || entry.declaration.alternates)
        throw std::logic_error("the table " + name + " does not grow");
    const std::size_t element = element_bytes(entry.declaration, precision_), before = rows_of(name) * element;
    TableDeclaration declaration = entry.declaration;
    declaration.multiple = multiple;
    Buffer grown(device_, name, table_bytes(declaration, rows_, precision_));
    entry.declaration = std::move(declaration);
    const std::size_t after = rows_of(name) * element;
    {
        const auto from = entry.buffer[0].map(Access::read), to = grown.map(Access::write);
        for (std::size_t column = 0; column < entry.declaration.columns; ++column)
            std::memcpy(to.as<char>() + column * after, from.as<char>() + column * before, std::min(before, after));
    }
    entry.buffer[0] = std::move(grown);
    ++grown_;
}

void Tables::release_all_but(const std::vector<std::string> &kept) {
    std::erase_if(tables_,
                  [&](const auto &entry) { return std::find(kept.begin(), kept.end(), entry.first) == kept.end(); });
}

std::uint32_t odd_lines(std::uint32_t rows) {
    constexpr std::uint32_t line = 64 / sizeof(float);
    return ((rows + line - 1) / line | 1u) * line;
}

std::uint32_t default_batch_size(const Device &device) {
    const DeviceDescription &d = device.description();
    return d.is_host ? std::min(largest_batch / batch_of_core, cores_of(d)) * batch_of_core : default_batch_other;
}

std::uint32_t choose_batch_size(Device &device, std::uint32_t requested, std::uint64_t samples, const TableList &list,
                                Precision precision) {
    const DeviceDescription &d = device.description();
    // By a batch of one path: what does not grow with the batch is small, or is the film, which must fit anyway.
    const TableRows none = {}, one = {1, batches_a_pass, 0, 0, 0, 1};
    std::uint64_t of_path = 0, largest_table = 1;
    for (const TableDeclaration &table : list) {
        const std::uint64_t bytes = table_bytes(table, one, precision) - table_bytes(table, none, precision);
        of_path += bytes * (table.alternates ? 2 : 1);
        largest_table = std::max(largest_table, bytes);
    }
    // Half the memory is for the scene and for others; one table may not pass the largest allocation.
    const std::uint64_t fits = std::min<std::uint64_t>(d.memory_bytes / 2 / std::max<std::uint64_t>(of_path, 1),
                                                       d.allocation_bytes / largest_table);
    if (fits < least_batch)
        throw Error(ExitCode::device, fmt::format("{} has not enough memory for {} paths", d.name, least_batch));
    std::uint64_t size = requested ? requested : default_batch_size(device);
    if (!requested && d.is_host) {
        if (2 * batch_of_core * of_path <= twice_below_bytes_of_core)
            size *= 2;
        size = std::max<std::uint64_t>(std::min(size, most_bytes_of_cores / std::max<std::uint64_t>(of_path, 1)),
                                       fewest_cores * batch_of_core);
    }
    size = std::min<std::uint64_t>({size, largest_batch, std::max<std::uint64_t>(samples, 1)});
    const std::uint64_t rounded_up = (size + least_batch - 1) / least_batch * least_batch;
    return static_cast<std::uint32_t>(std::min(rounded_up, fits / least_batch * least_batch));
}

} // namespace gradus
