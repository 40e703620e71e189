// Manifold walks: chains of specular and glossy vertices whose end moves (Jakob and Marschner 2012).
#pragma once

#include "runtime/wavefront/partition.h"
#include "runtime/wavefront/session.h"
#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gradus {

struct WalkSettings {
    std::uint32_t most_vertices = 8; ///< between start and end of a chain: what there is room for
    std::uint32_t steps = 5;         ///< tried at most, those that are halved counted in (Hua et al. 2017)
    /// An end has arrived at this distance from its target, over the length of the chain's last segment: the angle by
    /// which its last half vector is wrong. Beside that it may be off by what rounding does to the coordinates of the
    /// first vertex, magnified as the chain does.
    double tolerance = 1e-5;
    bool comes_back = true; ///< walks count as arrived only where the walk back comes back: shifts need that
    /// Then, how far the first vertex may come back from where it was, over the length of the first segment.
    double back_tolerance = 1e-3;
};

/// Walks over a shrinking queue. A step aims the first ray at where the derivative wants the first vertex, and traces
/// the chain again: each vertex does as it did, by the same half vector in its frame. The end is in the plane through
/// the old end and the target that is symmetric in both, so that the walk back is in the same plane. A step that comes
/// nearer is taken, and the next one is twice as large a share of the whole, at most 1; any other is halved. The answer
/// of a chain is the same bits whatever the rows beside it and the threads.
///
/// Kernels ask for `walked_kind` (by material record, the kind as `kind` in kernels/shared/tables.h; kind_none where no
/// walk leads), which the method adds to the scene's buffers before its stages are built. A vertex of a chain is
/// specular where that has kind_is_dirac, else glossy; the new one must be of the same kind, flags included.
class ManifoldWalk {
  public:
    /// Declares the stages `walk ...`. There is room for TableRows::chains.
    ManifoldWalk(Session &session, Stages &stages, const WalkSettings &settings);

    /// Tables to be written: `chain` and `chain_vertex`; to be read: `walked` and `walked_vertex`
    /// (kernels/shared/walk_tables.h), in the kernels of which `chain_rows` is the first two's rows and
    /// `chain_vertices` that of the tables of vertices: numbers that a launch passes. And what walks keep.
    TableList tables() const;
    /// To be called once they are allocated.
    void attach(Tables &tables);

    std::uint32_t chain_rows() const { return chain_rows_; }
    std::uint32_t chain_vertices() const { return chain_rows_ * settings_.most_vertices; }
    const WalkSettings &settings() const { return settings_; }

    /// Walks chains [0, count), whose answers are in `walked` and `walked_vertex` then.
    void run(std::uint32_t count);

    /// What became of the chains of all runs, by the names of GRADUS_WALK_OUTCOMES, "none" left out; "steps": those of
    /// walks that arrived.
    const std::map<std::string, std::uint64_t> &counts() const { return counts_; }

  private:
    struct Side;
    void walk(const Side &side, std::uint32_t count);
    std::vector<std::uint32_t> sort(std::uint32_t rows);
    void trace(std::uint32_t rows);
    void bind(const Side &side);
    void add_counts(std::uint32_t count);

    Session &session_;
    WalkSettings settings_;
    Stage &events_, &queue_, &aim_, &follow_, &land_;
    Partition partition_; ///< of the walks that go on, by the vertices that they have yet to meet
    Stage &link_, &seen_, &turn_, &turn_vertices_, &return_, &count_;
    Tables *tables_ = nullptr;
    std::uint32_t chain_rows_ = 0;
    std::map<std::string, std::uint64_t> counts_;
};

} // namespace gradus
