#include "driver/statistics_json.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace gradus {
namespace {

TEST(StatisticsJson, HoldsEveryFigure) {
    Statistics statistics;
    statistics.stages = {{"trace", 3, 400, 8}, {"shade", 1, 200, 4}};
    statistics.rays = {{"extension", 5000}, {"shadow", 3000}};
    statistics.walks = {{"arrived", 70}, {"steps", 90}};
    statistics.compile_seconds = {{"shade", 0.5}, {"camera", 0.25}};
    statistics.first_radii = {4, 2};
    statistics.last_radii = {8, 1};
    statistics.relative_variance = 0.25;
    statistics.surfaces.gathered = {{"diffuse", 3}};
    statistics.samples = std::uint64_t(1) << 40;
    statistics.non_finite = 3;
    statistics.estimated_error = 0.125;
    statistics.render_seconds = 4;
    statistics.device_bytes = 1234;
    RenderRecord record;
    record.scene = "scene.xml";
    record.seed = ~std::uint64_t(0);
    record.precision = "double";
    record.wall_seconds = 5;
    record.phase_seconds = {{"parse", 0.5}, {"tree", 0.25}};
    record.stopped_by = "error";
    record.device.name = "a device";
    // Through text, as a reader gets it.
    const nlohmann::json json = nlohmann::json::parse(statistics_to_json(record, statistics).dump());
    EXPECT_EQ(json.at("stages").size(), 2u);
    EXPECT_EQ(json.at("stages")[1].at("name"), "shade");
    EXPECT_EQ(json.at("stages")[1].at("share"), 0.25);
    EXPECT_EQ(json.at("stages")[1].at("items"), 200);
    EXPECT_EQ(json.at("stages")[1].at("launches"), 4);
    EXPECT_EQ(json.at("rays").at("shadow").at("count"), 3000);
    EXPECT_EQ(json.at("rays").at("shadow").at("per_second"), 750);
    EXPECT_EQ(json.at("rays_per_second"), 2000);
    EXPECT_EQ(json.at("walks").at("steps"), 90);
    EXPECT_EQ(json.at("gathering").at("mean_radius_of_first_pass"), 0.5);
    EXPECT_EQ(json.at("gathering").at("mean_radius_of_last_pass"), 0.125);
    EXPECT_EQ(json.at("gathering").at("relative_variance"), 0.25);
    EXPECT_EQ(json.at("gathering").at("gathered_at").at("diffuse"), 3);
    EXPECT_EQ(json.at("samples").get<std::uint64_t>(), std::uint64_t(1) << 40);
    EXPECT_EQ(json.at("seed").get<std::uint64_t>(), ~std::uint64_t(0));
    EXPECT_EQ(json.at("non_finite"), 3);
    EXPECT_EQ(json.at("estimated_error"), 0.125);
    EXPECT_EQ(json.at("stopped_by"), "error");
    EXPECT_EQ(json.at("compile_seconds").at("total"), 0.75);
    EXPECT_EQ(json.at("compile_seconds").at("kernels").at("camera"), 0.25);
    EXPECT_EQ(json.at("memory").at("device_bytes"), 1234);
    EXPECT_EQ(json.at("device").at("name"), "a device");
    EXPECT_EQ(json.at("precision"), "double");
    EXPECT_EQ(json.at("wall_seconds"), 5);
    EXPECT_EQ(json.at("phase_seconds").at("tree"), 0.25);
    EXPECT_GT(json.at("memory").at("peak_host_bytes").get<std::uint64_t>(), 100000u);
}

TEST(StatisticsJson, ARenderOfNoTimeHasNoInfiniteRates) {
    Statistics statistics;
    statistics.rays = {{"extension", 1}};
    statistics.samples = 1;
    EXPECT_FALSE(statistics_to_json({}, statistics).contains("gathering")) << "no photons were asked for";
    statistics.surfaces.gathered["diffuse"] = 1;
    const nlohmann::json json = statistics_to_json({}, statistics);
    EXPECT_EQ(json.at("rays_per_second"), 0);
    EXPECT_EQ(json.at("samples_per_second"), 0);
    EXPECT_EQ(json.at("gathering").at("mean_radius_of_last_pass"), 0);
    EXPECT_EQ(json.at("gathering").at("relative_variance"), nullptr);
}

} // namespace
} // namespace gradus
