// What `gradus tune` keeps: read back, told apart by device and driver, and no trouble where it is damaged.
#include "driver/tuning_store.h"

#include "runtime/error.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace gradus {
namespace {

class TuningStore : public ::testing::Test {
  protected:
    void SetUp() override {
        folder = std::filesystem::temp_directory_path() / ("gradus-tuning-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder);
        setenv("XDG_CACHE_HOME", folder.c_str(), 1);
        device.platform = "Platform";
        device.name = "Device \"one\"";
        device.driver = "1.2";
        device.compute_units = 4;
    }
    void TearDown() override {
        std::filesystem::remove_all(folder);
        unsetenv("XDG_CACHE_HOME");
    }
    void write(const std::string &text) const {
        std::filesystem::create_directories(folder / "gradus");
        std::ofstream(folder / "gradus" / "tuning.json") << text;
    }
    /// A file with one entry for the device, of these two values as JSON.
    void write_entry(const std::string &work_group, const std::string &batch) const {
        write(R"({"version": 1, "devices": [{"platform": "Platform", "name": "Device \"one\"", "driver": "1.2",
                 "compute_units": 4, "work_group_size": )" +
              work_group + R"(, "batch_size": )" + batch + "}]}");
    }

    std::filesystem::path folder;
    DeviceDescription device;
};

TEST_F(TuningStore, ReadsBackWhatItKeeps) {
    EXPECT_EQ(stored_tuning(device), std::nullopt);
    store_tuning(device, {128, 65536});
    EXPECT_EQ(stored_tuning(device), (Tuning{128, 65536}));
    store_tuning(device, {0, 1024});
    EXPECT_EQ(stored_tuning(device), (Tuning{0, 1024}));
}

TEST_F(TuningStore, TellsDevicesAndDriversApart) {
    DeviceDescription other = device;
    other.driver = "1.3";
    store_tuning(device, {128, 0});
    EXPECT_EQ(stored_tuning(other), std::nullopt);
    store_tuning(other, {256, 0});
    EXPECT_EQ(stored_tuning(device), (Tuning{128, 0}));
    EXPECT_EQ(stored_tuning(other), (Tuning{256, 0}));
    other.driver = device.driver;
    other.compute_units = 8;
    EXPECT_EQ(stored_tuning(other), std::nullopt);
}

TEST_F(TuningStore, SaysWhatIsWrongWithADamagedFileAndBeginsItAnew) {
    for (const char *text : {"", "{", "[]", "null", "{\"version\": 2, \"devices\": []}", "{\"version\": 1}",
                             "{\"version\": 1, \"devices\": [3]}", "{\"version\": 1, \"devices\": 7}"}) {
        write(text);
        std::string problem;
        EXPECT_EQ(stored_tuning(device, &problem), std::nullopt) << text;
        EXPECT_NE(problem.find("tuning.json"), std::string::npos) << text;
    }
    store_tuning(device, {64, 256});
    EXPECT_EQ(stored_tuning(device), (Tuning{64, 256}));
}

TEST_F(TuningStore, UsesNoNumbersThatNoTunerFinds) {
    write_entry("128", "4096");
    ASSERT_EQ(stored_tuning(device), (Tuning{128, 4096}));
    const std::pair<const char *, const char *> wrong[] = {{"3", "4096"},     {"4096", "4096"}, {"-64", "4096"},
                                                           {"128", "1"},      {"128", "1e30"},  {"128", "-1"},
                                                           {"\"128\"", "64"}, {"null", "64"},   {"128", "[]"}};
    for (const auto &[work_group, batch] : wrong) {
        write_entry(work_group, batch);
        std::string problem;
        EXPECT_EQ(stored_tuning(device, &problem), std::nullopt) << work_group << " " << batch;
        EXPECT_FALSE(problem.empty()) << work_group << " " << batch;
    }
}

TEST_F(TuningStore, CannotKeepAnythingWhereThereIsNoFolder) {
    const std::filesystem::path file = folder / "file";
    std::ofstream(file) << "in the way";
    setenv("XDG_CACHE_HOME", file.c_str(), 1);
    EXPECT_EQ(stored_tuning(device), std::nullopt);
    try {
        store_tuning(device, {128, 0});
        FAIL() << "kept below a file";
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::output);
    }
}

TEST_F(TuningStore, FillsInOnlyWhatIsLeftOpen) {
    RenderOptions options;
    apply_tuning(std::nullopt, options);
    EXPECT_EQ(options.batch_size, 0u);
    apply_tuning(Tuning{128, 4096}, options);
    EXPECT_EQ(options.work_group_size, 128u);
    EXPECT_EQ(options.batch_size, 4096u);
    options.batch_size = 640;
    apply_tuning(Tuning{128, 4096}, options);
    EXPECT_EQ(options.batch_size, 640u);
}

} // namespace
} // namespace gradus
