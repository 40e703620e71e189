#include "driver/program.h"
#include "driver/solve_report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace gradus {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

PoissonReport full_report() {
    PoissonReport report;
    report.method = "irls, pcg";
    report.alpha = 0.125;
    report.iterations = 24;
    report.reweightings = 12;
    report.converged = true;
    report.residuals = {1, 0.5, 0.25};
    report.objectives = {9, 8};
    report.objective = 7;
    report.missing_primal = 1;
    report.missing_dx = 2;
    report.missing_dy = std::uint64_t(1) << 40;
    report.filled = 4;
    report.correction = {0.5, 0.25, 0.125};
    report.seconds = 1.5;
    report.kernels = {{"smooth", 0.75, 100}, {"weights", 0.5, 12}};
    return report;
}

TEST(SolveReport, JsonHoldsEverything) {
    SolveRecord record;
    record.reconstruction = "l1";
    record.norm = "L1";
    record.weights = "uniform";
    record.width = 640;
    record.height = 480;
    record.channels = 3;
    record.device.name = "a device";
    record.prepare_seconds = 0.5;
    record.wall_seconds = 3;
    // Through text, as a reader gets it.
    const nlohmann::json json = nlohmann::json::parse(solve_report_json(record, full_report()).dump());
    nlohmann::json expected = {
        {"version", version()},
        {"method", "irls, pcg"},
        {"reconstruction", "l1"},
        {"norm", "L1"},
        {"weights", "uniform"},
        {"alpha", 0.125},
        {"width", 640},
        {"height", 480},
        {"channels", 3},
        {"iterations", 24},
        {"reweightings", 12},
        {"converged", true},
        {"residuals", {1.0, 0.5, 0.25}},
        {"objectives", {9.0, 8.0}},
        {"objective", 7.0},
        {"missing", {{"primal", 1}, {"dx", 2}, {"dy", std::uint64_t(1) << 40}}},
        {"filled", 4},
        {"correction", {0.5, 0.25, 0.125}},
        {"kernels",
         {{{"name", "smooth"}, {"seconds", 0.75}, {"launches", 100}},
          {{"name", "weights"}, {"seconds", 0.5}, {"launches", 12}}}},
        {"device", {{"name", "a device"}, {"platform", ""}, {"version", ""}, {"driver", ""}, {"type", ""}}},
        {"memory", json.at("memory")},
        {"prepare_seconds", 0.5},
        {"seconds", 1.5},
        {"wall_seconds", 3.0}};
    EXPECT_EQ(json, expected);
    EXPECT_GT(json.at("memory").at("peak_host_bytes").get<std::uint64_t>(), 100000u);
}

TEST(SolveReport, WhatIsNotFiniteIsNull) {
    PoissonReport report;
    report.objective = std::numeric_limits<double>::quiet_NaN();
    report.residuals = {std::numeric_limits<double>::infinity()};
    const nlohmann::json json = nlohmann::json::parse(solve_report_json({}, report).dump());
    EXPECT_TRUE(json.at("objective").is_null());
    EXPECT_TRUE(json.at("residuals").at(0).is_null());
    EXPECT_TRUE(json.at("kernels").is_array());
}

TEST(SolveReport, TextNamesEachFigure) {
    EXPECT_EQ(solve_report_text(full_report()), "method       irls, pcg\n"
                                                "alpha        0.125\n"
                                                "iterations   24 in 12 reweightings, converged\n"
                                                "residual     2.500e-01\n"
                                                "objective    7.000000e+00, at the start 9.000000e+00\n"
                                                "missing      primal 1, dx 2, dy 1099511627776; filled 4\n"
                                                "seconds      1.500, 1.250 of them in kernels\n");
    PoissonReport report;
    report.method = "cg";
    report.iterations = 5;
    const std::string text = solve_report_text(report);
    EXPECT_THAT(text, HasSubstr("iterations   5, not converged\n"));
    EXPECT_THAT(text, Not(HasSubstr("residual")));
    report.reweightings = 2;
    EXPECT_THAT(solve_report_text(report), HasSubstr("iterations   5 in 2 reweightings, stopped by count\n"));
}

} // namespace
} // namespace gradus
