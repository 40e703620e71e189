// A film with splats, without a method.
#pragma once

#include "runtime/wavefront/film.h"
#include "runtime/wavefront/splats.h"
#include "tests/support/small_scenes.h"

#include <array>
#include <optional>
#include <random>
#include <vector>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/tables.h"

namespace gradus::testing {

struct SplatRow {
    std::uint32_t pixel = 0;
    std::array<double, 3> value = {};
    std::uint32_t path = 0;
};

class SplatFilm {
  public:
    /// A film of side x side pixels, and room for so many splats.
    SplatFilm(Device &device, std::uint32_t side, std::uint32_t room, Splats::Order order = Splats::Order::rows,
              const SessionOptions &options = {})
        : order_(order), maker_(side, 1), session_(device, maker_.scene, options, {}), film(session_, stages_),
          splats(session_, stages_, RowsOf::path, 2, order) {
        TableList list = film.tables();
        for (const TableDeclaration &table : splats.tables())
            list.push_back(table);
        const std::uint32_t pixels = side * side, slots = odd_lines(pixels);
        tables.emplace(device, list, TableRows{(room + 1) / 2, slots, pixels, side, 1}, options.precision);
        session_.numbers["slots"] = slots;
        stages_.build(session_, *tables);
        film.attach(*tables);
        splats.attach(*tables);
    }

    /// Adds rows [first, first + count).
    void add(const std::vector<SplatRow> &rows, std::size_t first, std::size_t count) {
        std::uint32_t highest_path = 0;
        {
            const auto values = (*tables)["splat"].map(Access::write);
            const auto pixels = (*tables)["splat_pixel"].map(Access::write);
            std::optional<Buffer::Mapping> paths;
            if (order_ == Splats::Order::paths)
                paths.emplace((*tables)["splat_path"], Access::write, Wait::now);
            const std::size_t room = tables->rows().paths * 2;
            for (std::size_t i = 0; i < count; ++i) {
                const SplatRow &row = rows[first + i];
                for (std::size_t c = 0; c < 3; ++c)
                    if (tables->precision() == Precision::double_)
                        values.as<double>()[c * room + i] = row.value[c];
                    else
                        values.as<float>()[c * room + i] = float(row.value[c]);
                pixels.as<std::uint32_t>()[i] = row.pixel;
                if (paths)
                    paths->as<std::uint32_t>()[i] = row.path;
                highest_path = std::max(highest_path, row.path);
            }
        }
        splats.add(std::uint32_t(count), highest_path);
    }
    void add(const std::vector<SplatRow> &rows) { add(rows, 0, rows.size()); }

    /// All bits of the sums.
    std::vector<std::uint32_t> bits() const {
        const Buffer &sums = (*tables)["splat_film"];
        std::vector<std::uint32_t> bits(sums.bytes() / sizeof(std::uint32_t));
        sums.read(bits.data(), sums.bytes());
        return bits;
    }

  private:
    Splats::Order order_;
    SceneMaker maker_;
    Session session_;
    Stages stages_;

  public:
    Film film;
    Splats splats;
    std::optional<Tables> tables;
};

/// Splats of positive values over many magnitudes, some of which are nowhere, so that the order of sums shows; half of
/// them on a hundredth of the pixels.
inline std::vector<SplatRow> random_splats(std::size_t count, std::uint32_t pixels) {
    std::mt19937 engine(5);
    std::normal_distribution<double> normal;
    std::uniform_int_distribution<std::uint32_t> anywhere(0, pixels - 1), spot(0, pixels / 100), one_of_20(0, 19);
    std::vector<SplatRow> rows(count);
    for (SplatRow &row : rows) {
        row.pixel = engine() % 2 ? spot(engine) : anywhere(engine);
        if (one_of_20(engine) == 0)
            row.pixel = splat_none;
        row.path = engine() % 1000;
        for (double &value : row.value)
            value = float(std::exp(3 * normal(engine)));
    }
    return rows;
}

} // namespace gradus::testing
