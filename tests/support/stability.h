// A row of docs/stability.md, recorded by the test that measures its number. tests/stability/stability_table.py makes
// the page of what tests record, so the texts of a row stand beside the number and cannot drift from it.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <optional>
#include <string>

namespace gradus::testing {

/// A number of a row beside its first one.
struct StabilityMeasure {
    std::string quantity;        ///< what the number is
    double number = 0;           ///< measured
    double limit = 0;            ///< largest number that passes
    std::optional<double> found; ///< as in StabilityRow
};

/// A case where methods fail in theory, and how this program fares. Texts are Markdown without line breaks.
struct StabilityRow {
    const char *area;        ///< heading of the table that the row stands in: one of AREAS in stability_table.py
    std::string failure;     ///< what goes wrong in theory
    std::string provoked_by; ///< the scene or kernel case
    std::string contract;    ///< what the program does
    std::string quantity;    ///< what the number is
    double number = 0;       ///< measured
    double limit = 0;        ///< largest number that passes
    /// What was found, without what noise may hide: under a planted defect it says what the number has to see
    /// (tests/stability/power.py).
    std::optional<double> found = std::nullopt;
    std::optional<StabilityMeasure> also = std::nullopt;
};

/// Holds the numbers against their limits, which fails the test where one is above or no number, and records the row.
inline void record_stability(const StabilityRow &row) {
    EXPECT_LE(row.number, row.limit) << row.quantity;
    if (row.also) {
        EXPECT_LE(row.also->number, row.also->limit) << row.also->quantity;
    }
    // Each property of a test needs a name of its own.
    const ::testing::TestInfo *test = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::string prefix = "stability." + std::to_string(test->result()->test_property_count()) + ".";
    const auto record = [&](const char *field, const std::string &text) {
        ::testing::Test::RecordProperty(prefix + field, text);
    };
    const auto digits = [](double value) {
        char text[40];
        std::snprintf(text, sizeof text, "%.17g", value);
        return std::string(text);
    };
    record("area", row.area);
    record("failure", row.failure);
    record("provoked_by", row.provoked_by);
    record("contract", row.contract);
    record("quantity", row.quantity);
    record("number", digits(row.number));
    record("limit", digits(row.limit));
    if (row.found)
        record("found", digits(*row.found));
    if (!row.also)
        return;
    record("also_quantity", row.also->quantity);
    record("also_number", digits(row.also->number));
    record("also_limit", digits(row.also->limit));
    if (row.also->found)
        record("also_found", digits(*row.also->found));
}

} // namespace gradus::testing
