// Manifold walks without a method: chains in, answers out.
#pragma once

#include "runtime/wavefront/manifold_walk.h"
#include "tests/support/small_scenes.h"
#include "tests/wavefront/chain_sampler.h"

#include "runtime/seconds_since.h"
#include "runtime/wavefront/host_table.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "kernels/shared/tables.h"

namespace gradus::testing {

struct WalkResult {
    std::uint32_t outcome = 0, steps = 0;
    double base_spread = 0, base_turn = 0, spread = 0, turn = 0;
    std::vector<WalkVertex> vertices;
};

/// By material record: rough are diffuse ones and those of at least that roughness.
inline std::vector<std::uint32_t> material_kinds(const Scene &scene, float threshold = 0.3f) {
    using namespace lib_float;
    std::vector<std::uint32_t> kinds;
    for (const Bsdf &bsdf : material_records(scene)) {
        const BsdfKindTraits &kind = bsdf_kind_traits(bsdf.kind);
        const bool is_rough = !kind.is_dirac && (!kind.has_roughness || bsdf.alpha_u >= threshold);
        kinds.push_back(bsdf_kind_number(bsdf) | (is_rough ? kind_is_rough : 0) | (kind.is_dirac ? kind_is_dirac : 0));
    }
    return kinds;
}

/// With as many threads as the environment says: oclgrind's compiler is safe for one.
inline Device &walk_device() {
    const char *threads = std::getenv("GRADUS_TEST_THREADS");
    // Never destroyed: at the end of the process oclgrind is gone before it would be.
    static Device &device = *new Device("", threads ? std::atoi(threads) : 0);
    return device;
}

class Walker {
  public:
    Walker(const Scene &scene, std::uint32_t capacity, const WalkSettings &settings = {},
           const SessionOptions &options = {}, Device &device = walk_device())
        : session(device, scene, options, {}), walk(session, stages_, settings), kinds(material_kinds(scene)),
          sampler(scene, kinds, session.tracer) {
        session.add_scene_buffer("walked_kind", kinds);
        tables.emplace(device, walk.tables(),
                       TableRows{capacity, capacity, 16, 4, chunks_of(capacity), odd_lines(capacity)},
                       options.precision);
        stages_.build(session, *tables);
        walk.attach(*tables);
    }

    /// Walks all chains, as many at a time as there is room for, or `batch`.
    std::vector<WalkResult> run(const std::vector<WalkChain> &chains, std::size_t batch = ~std::size_t(0)) {
        batch = std::min<std::size_t>(batch, walk.chain_rows());
        std::vector<WalkResult> results;
        for (std::size_t first = 0; first < chains.size(); first += batch) {
            const std::size_t count = std::min(batch, chains.size() - first);
            put(chains, first, count);
            const auto start = std::chrono::steady_clock::now();
            walk.run(std::uint32_t(count));
            seconds += seconds_since(start);
            take(chains, first, count, results);
        }
        return results;
    }

    Session session;
    double seconds = 0; ///< spent walking

  private:
    Stages stages_;

  public:
    ManifoldWalk walk;
    std::vector<std::uint32_t> kinds;
    ChainSampler sampler;
    std::optional<Tables> tables;

  private:
    /// A table that the host writes.
    class Writer {
      public:
        Writer(Tables &tables, const char *name, std::size_t rows)
            : mapping_(tables[name].map(Access::read_write)), rows_(rows), size_(real_bytes(tables.precision())) {}
        void real(int column, std::size_t row, double value) {
            char *place = mapping_.as<char>() + (std::size_t(column) * rows_ + row) * size_;
            const float single = float(value);
            size_ == 8 ? std::memcpy(place, &value, 8) : std::memcpy(place, &single, 4);
        }
        void vector(int column, std::size_t row, const Point &value) {
            for (int axis = 0; axis < 3; ++axis)
                real(column + axis, row, value[std::size_t(axis)]);
        }
        void uint(int column, std::size_t row, std::uint32_t value) {
            std::memcpy(mapping_.as<char>() + (std::size_t(column) * rows_ + row) * size_, &value, 4);
        }

      private:
        Buffer::Mapping mapping_;
        std::size_t rows_, size_;
    };

    void put(const std::vector<WalkChain> &chains, std::size_t first, std::size_t count) {
        using namespace lib_float;
        Writer rows(*tables, "chain", walk.chain_rows()), vertices(*tables, "chain_vertex", walk.chain_vertices());
        for (std::size_t i = 0; i < count; ++i) {
            const WalkChain &chain = chains[first + i];
            const auto end = [&](const ChainEnd &e, int position, int normal) {
                rows.vector(position, i, e.position);
                rows.vector(normal, i, e.normal);
            };
            end(chain.start, chain_start_x, chain_start_normal_x);
            end(chain.end, chain_end_x, chain_end_normal_x);
            end(chain.target, chain_target_x, chain_target_normal_x);
            rows.real(chain_start_offset, i, chain.start.offset);
            rows.real(chain_target_offset, i, chain.target.offset);
            rows.uint(chain_inner, i, std::uint32_t(chain.vertices.size()));
            for (std::size_t k = 0; k < std::min<std::size_t>(chain.vertices.size(), walk.settings().most_vertices);
                 ++k) {
                vertices.vector(chain_vertex_position_x, k * walk.chain_rows() + i, chain.vertices[k].position);
                vertices.uint(chain_vertex_primitive, k * walk.chain_rows() + i, chain.vertices[k].primitive);
            }
        }
    }
    void take(const std::vector<WalkChain> &chains, std::size_t first, std::size_t count,
              std::vector<WalkResult> &results) {
        using namespace lib_float;
        const HostTable rows((*tables)["walked"], walk.chain_rows(), tables->precision());
        const HostTable vertices((*tables)["walked_vertex"], walk.chain_vertices(), tables->precision());
        for (std::size_t i = 0; i < count; ++i) {
            WalkResult result{rows.uint(walked_outcome, i),
                              rows.uint(walked_steps, i),
                              rows.real(walked_base_spread, i),
                              rows.real(walked_base_turn, i),
                              rows.real(walked_spread, i),
                              rows.real(walked_turn, i),
                              {}};
            for (std::size_t k = 0; result.outcome == walk_arrived && k < chains[first + i].vertices.size(); ++k) {
                const std::size_t at = k * walk.chain_rows() + i;
                result.vertices.push_back(
                    {{vertices.real(walked_vertex_position_x, at), vertices.real(walked_vertex_position_y, at),
                      vertices.real(walked_vertex_position_z, at)},
                     vertices.uint(walked_vertex_primitive, at)});
            }
            results.push_back(result);
        }
    }
};

} // namespace gradus::testing
