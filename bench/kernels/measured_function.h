// The functions of kernels/lib whose errors are measured, with arguments over their domains and at its edges.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace gradus::bench {

/// Columns of numbers: argument c of case i is columns[c][i].
using Columns = std::vector<std::vector<double>>;

/// A part of what a function returns.
struct Output {
    std::string name;
    std::size_t column, width = 1; ///< several columns: a vector or a colour, whose error is a length
    double floor = 0;              ///< values of less than this are not looked at: they have no relative error
    bool is_absolute = false;      ///< numbers of order 1 around 0, and unit vectors: their error is not relative
    bool has_choice = false;       ///< not compared where builds differ in `choice`: they went different ways
};

struct MeasuredFunction {
    std::string name;                               ///< "diffuse", "fresnel dielectric"
    std::string file, entry;                        ///< the kernel that calls it
    std::map<std::string, std::string> definitions; ///< for it
    std::size_t result_columns;
    std::vector<Output> outputs;
    std::size_t choice = 0; ///< the column that says which way the function went: a lobe, a failure

    struct Domain {
        std::string name;
        /// One case, of numbers that float holds exactly.
        std::function<std::vector<double>(std::mt19937_64 &)> draw;
        bool is_adjusted = false; ///< by `adjust`
    };
    std::vector<Domain> domains; ///< the first is the inside, the others are edges
    /// Changes arguments by what the double build makes of them.
    std::function<void(Columns &arguments, const Columns &results)> adjust;
    /// Whether a case of the first domain lies at an edge after all; may be empty.
    std::function<bool(const Columns &arguments, std::size_t i)> is_edge;
};

std::vector<MeasuredFunction> measured_functions(const std::vector<std::string> &kinds);

} // namespace gradus::bench
