// Photons and gather points of the test's own, sorted and searched without a render.
#pragma once

#include "methods/photons/photon_pairs.h"
#include "tests/support/small_scenes.h"

#include <array>
#include <numeric>
#include <optional>
#include <vector>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/tables.h"

namespace gradus::testing {

struct SyntheticPhoton {
    std::array<float, 3> position{}, normal{0, 0, 1};
    std::uint32_t depth = 1;
};

struct SyntheticGatherPoint {
    std::array<float, 3> position{}, normal{0, 0, 1};
    float radius = 0;
    std::uint32_t deepest = 100;
};

/// A row of `gather`, and a photon by its number before they were sorted.
struct FoundPair {
    std::uint32_t gather, photon;
    auto operator<=>(const FoundPair &) const = default;
};

class PhotonSearch {
  public:
    /// The scene is a box between these corners; there is room for so many photons and gather points.
    PhotonSearch(Device &device, Vector3 low, Vector3 high, std::uint32_t photons, std::uint32_t gather_points)
        : maker_(4, 1), session_(device, with_box(maker_, low, high), {}, {}),
          map_(session_, stages_, odd_lines(photons)), pairs_(stages_) {
        using namespace lib_float;
        TableList list = map_.tables();
        for (const TableDeclaration &table : pairs_.tables())
            list.push_back(table);
        list.push_back({.name = "photon",
                        .rows = RowsOf::one,
                        .multiple = odd_lines(photons),
                        .columns = photon_columns,
                        .is_cleared = true,
                        .grows = true});
        list.push_back({.name = "photon_order", .rows = RowsOf::one, .multiple = odd_lines(photons), .is_uint = true});
        list.push_back({.name = "gather", .columns = gather_columns, .is_cleared = true});
        tables_.emplace(device, list, TableRows{gather_points, gather_points, 16, 4, 1}, Precision::single);
        session_.numbers["capacity"] = gather_points;
        session_.numbers["gather_rows"] = gather_points;
        session_.numbers["photon_rows"] = odd_lines(photons);
        session_.numbers["pair_rows"] = PhotonPairs::pair_rows(gather_points);
        stages_.build(session_, *tables_);
        map_.attach(*tables_);
        pairs_.attach(*tables_);
    }

    void place(const std::vector<SyntheticPhoton> &photons, const std::vector<SyntheticGatherPoint> &points) {
        using namespace lib_float;
        const std::size_t rows = tables_->rows_of("photon"), capacity = tables_->rows().paths;
        const auto photon = (*tables_)["photon"].map(Access::write);
        const auto order = (*tables_)["photon_order"].map(Access::write);
        for (std::size_t i = 0; i < photons.size(); ++i) {
            const std::size_t row = photons.size() - 1 - i; // not in order
            order.as<std::uint32_t>()[i] = std::uint32_t(row);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                photon.as<float>()[(photon_position_x + axis) * rows + row] = photons[i].position[axis];
                photon.as<float>()[(photon_normal_x + axis) * rows + row] = photons[i].normal[axis];
            }
            photon.as<float>()[photon_power_r * rows + row] = float(i);
            photon.as<std::uint32_t>()[photon_depth * rows + row] = photons[i].depth;
        }
        const auto gather = (*tables_)["gather"].map(Access::write);
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                gather.as<float>()[(gather_position_x + axis) * capacity + i] = points[i].position[axis];
                gather.as<float>()[(gather_geometric_x + axis) * capacity + i] = points[i].normal[axis];
            }
            gather.as<float>()[gather_radius * capacity + i] = points[i].radius;
            gather.as<std::uint32_t>()[gather_deepest * capacity + i] = points[i].deepest;
        }
        photons_ = std::uint32_t(photons.size());
        points_ = std::uint32_t(points.size());
    }

    /// The pairs as they are listed.
    std::vector<FoundPair> find(double edge) {
        using namespace lib_float;
        map_.build(photons_, photons_, edge);
        std::vector<FoundPair> found;
        windows = 0;
        const std::size_t rows = tables_->rows_of("photon");
        total = pairs_.find({0, points_}, [&](const PairWindow &window) {
            ++windows;
            const auto gather = (*tables_)["pair_gather"].map(Access::read);
            const auto photon = (*tables_)["pair_photon"].map(Access::read);
            const auto sorted = (*tables_)["photon_sorted"].map(Access::read);
            for (std::uint32_t i = 0; i < window.pairs; ++i)
                found.push_back(
                    {gather.as<std::uint32_t>()[i], number(sorted.as<float>(), rows, photon.as<std::uint32_t>()[i])});
        });
        return found;
    }

    /// Sums, by gather point, what value(photon) gives for each of its pairs.
    template <class Value>
    std::vector<float> sums(double edge, const Value &value) {
        using namespace lib_float;
        map_.build(photons_, photons_, edge);
        const std::size_t rows = tables_->rows_of("photon"), capacity = tables_->rows().paths;
        {
            const auto gather = (*tables_)["gather"].map(Access::write);
            for (int column = gather_sum_r; column <= gather_sum_b; ++column)
                std::fill_n(gather.as<float>() + std::size_t(column) * capacity, capacity, 0.0f);
        }
        windows = 0;
        total = pairs_.find({0, points_}, [&](const PairWindow &window) {
            ++windows;
            {
                const auto photon = (*tables_)["pair_photon"].map(Access::read);
                const auto sorted = (*tables_)["photon_sorted"].map(Access::read);
                const auto values = (*tables_)["pair_value"].map(Access::write);
                for (std::uint32_t i = 0; i < window.pairs; ++i)
                    values.as<float>()[i] = value(number(sorted.as<float>(), rows, photon.as<std::uint32_t>()[i]));
            }
            pairs_.sum(window);
        });
        const auto gather = (*tables_)["gather"].map(Access::read);
        const float *sum = gather.as<float>() + std::size_t(gather_sum_r) * capacity;
        return {sum, sum + points_};
    }

    /// How many photons were looked at to list the pairs of the last search.
    std::uint64_t looked_at() const {
        std::vector<std::uint32_t> looked(points_);
        (*tables_)["pair_looked"].read(looked.data(), looked.size() * sizeof(looked[0]));
        return std::accumulate(looked.begin(), looked.end(), std::uint64_t(0));
    }

    std::uint64_t total = 0;
    std::size_t windows = 0;

  private:
    /// The number of a photon, which its power tells.
    static std::uint32_t number(const float *sorted, std::size_t rows, std::uint32_t row) {
        return std::uint32_t(sorted[lib_float::photon_sorted_power_r * rows + row]);
    }

    static const Scene &with_box(SceneMaker &maker, Vector3 low, Vector3 high) {
        const std::uint32_t gray = maker.material(diffuse(0.5));
        maker.parallelogram(low, {high.x - low.x, 0, 0}, {0, high.y - low.y, 0}, gray);
        maker.parallelogram({low.x, low.y, high.z}, {high.x - low.x, 0, 0}, {0, high.y - low.y, 0}, gray);
        return maker.scene;
    }

    SceneMaker maker_;
    Session session_;
    Stages stages_;
    PhotonMap map_;
    PhotonPairs pairs_;
    std::optional<Tables> tables_;
    std::uint32_t photons_ = 0, points_ = 0;
};

} // namespace gradus::testing
