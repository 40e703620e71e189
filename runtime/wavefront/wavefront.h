// Paths in flight: new ones begin in the rows that others leave, all are traced together, and the partition brings
// those together that go on alike.
#pragma once

#include "runtime/wavefront/material_reader.h"
#include "runtime/wavefront/partition.h"
#include "runtime/wavefront/session.h"
#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <cstdint>
#include <vector>

namespace gradus {

/// What a method keeps apart beside BSDF kinds and emission. A path tracer has one phase. The bins of `classify` are,
/// in turn, `escaped` ones for paths that left the scene, then for each phase two for each BSDF kind: surfaces that do
/// not emit, and those that do.
struct BinLayout {
    std::uint32_t escaped = 1, phases = 1, kinds = 0;
    std::uint32_t bins() const { return escaped + phases * 2 * kinds; }
};

/// Where the partition put paths. The index names rows of before, those that escaped first. Those that met a surface
/// take new rows in the order of the index, from 0 on.
class Hits {
  public:
    Hits() = default;
    /// `ranges`: where each bin begins in the index, and where the last ends.
    Hits(const BinLayout &layout, std::vector<std::uint32_t> ranges) : layout_(layout), ranges_(std::move(ranges)) {}

    /// Places in the index.
    Range escaped(std::uint32_t number = 0) const { return places(number, number + 1); }
    /// New rows.
    std::uint32_t count() const { return ranges_.empty() ? 0 : ranges_.back() - surfaces(); }
    Range phase(std::uint32_t phase) const { return rows(bin(phase, 0), bin(phase, layout_.kinds)); }
    /// Those of phases [first, end).
    Range phases(std::uint32_t first, std::uint32_t end) const { return rows(bin(first, 0), bin(end, 0)); }
    Range kind(std::uint32_t phase, std::size_t kind) const { return rows(bin(phase, kind), bin(phase, kind + 1)); }
    Range emitting(std::uint32_t phase, std::size_t kind) const {
        return rows(bin(phase, kind) + 1, bin(phase, kind + 1));
    }
    /// The place in the index of a new row.
    std::uint32_t place(std::uint32_t row) const { return surfaces() + row; }

  private:
    std::uint32_t surfaces() const { return ranges_.empty() ? 0 : ranges_[layout_.escaped]; }
    std::size_t bin(std::uint32_t phase, std::size_t kind) const {
        return layout_.escaped + 2 * (phase * layout_.kinds + kind);
    }
    Range places(std::size_t first, std::size_t end) const {
        return ranges_.empty() ? Range() : Range{ranges_[first], ranges_[end] - ranges_[first]};
    }
    Range rows(std::size_t first, std::size_t end) const {
        const Range found = places(first, end);
        return {found.first - surfaces(), found.count};
    }
    BinLayout layout_;
    std::vector<std::uint32_t> ranges_;
};

class Wavefront {
  public:
    /// Declares the stages `classify` (with `definitions` and the launch numbers `numbers` of its own) and of the
    /// partition.
    Wavefront(Session &session, Stages &stages, const BinLayout &layout,
              const std::map<std::string, std::string> &definitions = {}, const std::vector<std::string> &numbers = {},
              bool of_light_paths = false);

    /// The tables of paths in flight.
    TableList tables() const;
    /// Those of rays alone: for who keeps the state of paths himself and connects none to lights.
    TableList ray_tables() const;
    /// To be called once they are allocated.
    void attach(Tables &tables);

    /// A pass of so many paths begins.
    void begin_pass(std::uint32_t paths);
    /// The rows that paths of this pass may begin in, behind those of the newest vertices; none once all have begun and
    /// no path is left. `slot` is the first of their slots.
    Range refill(std::uint32_t &slot);
    /// True while there are rows to trace.
    bool is_alive() const { return rays() > 0; }
    /// Rows of the newest vertices, and all rows with rays: those and the new ones.
    std::uint32_t vertices() const { return vertices_; }
    std::uint32_t rays() const { return vertices_ + fresh_; }

    /// Traces the rays of all rows and the connections of the newest vertices to lights, and reads the materials met.
    void trace();
    /// Reads textures and chooses the parts of blends where `planes` times `rows` rows of another table of rays, of
    /// table_rows rows, have met something. trace() does so for all rows.
    void read_materials(const Buffer &rays, std::uint32_t rows, std::uint32_t planes, std::uint32_t table_rows,
                        const Buffer &surface);
    /// Sorts all rows by what they go to next.
    const Hits &partition(LaunchNumbers numbers = {});
    /// Ends the paths of all rows.
    void drop() { vertices_ = fresh_ = 0; }
    /// The rows that the partition found are the newest; tables that alternate are exchanged.
    void advance() { advance(hits_.count()); }
    /// The same where only the first `rows` of them go on.
    void advance(std::uint32_t rows);

    std::size_t kinds() const { return layout_.kinds; }

  private:
    Session &session_;
    BinLayout layout_;
    bool fresh_are_alike_; ///< paths that begin: neighbours' rays lie side by side
    MaterialReader materials_;
    Stage &classify_;
    Partition partition_;
    Tables *tables_ = nullptr;
    Hits hits_;
    std::uint32_t paths_ = 0, begun_ = 0, vertices_ = 0, fresh_ = 0;
};

} // namespace gradus
