// Helpers for tests of the loader: scenes as text in a folder of their own.
#pragma once

#include "runtime/error.h"
#include "runtime/io/load_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace gradus {

/// An empty folder that goes when the test ends.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        static std::atomic<int> count{0};
        path_ = std::filesystem::temp_directory_path() /
                ("gradus-io-" + std::to_string(getpid()) + "-" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder &) = delete;
    TemporaryFolder &operator=(const TemporaryFolder &) = delete;

    std::string write(const std::string &name, const std::string &text) const {
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary).write(text.data(), std::streamsize(text.size()));
        return file.string();
    }
    const std::filesystem::path &path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// A scene around `body`, which begins on line 3. It has a sensor and, unless told otherwise, a sphere.
inline std::string scene_around(const std::string &body, const std::string &version = "3.0.0",
                                const std::string &rest = "<shape type=\"sphere\"/>") {
    return "<scene version=\"" + version + "\">\n<sensor type=\"perspective\"/>\n" + body + "\n" + rest +
           "\n</scene>\n";
}

/// Parts of such scenes.
inline const std::string constant_light = "<emitter type=\"constant\"/>";
inline const std::string red_diffuse =
    "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5 0.1 0.1\"/></bsdf>";

inline LoadedScene load_text(const std::string &text, const LoadOptions &options = {}) {
    TemporaryFolder folder;
    return load_scene(folder.write("scene.xml", text), options);
}

/// The error's text; empty where loading succeeds. Checks the exit code.
inline std::string error_of(const std::string &path, const LoadOptions &options = {}) {
    try {
        load_scene(path, options);
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::scene);
        return error.what();
    }
    return {};
}

inline std::string error_of_text(const std::string &text, const LoadOptions &options = {}) {
    TemporaryFolder folder;
    return error_of(folder.write("scene.xml", text), options);
}

inline void expect_rgb(const Rgb &actual, double r, double g, double b, double tolerance = 1e-6) {
    EXPECT_NEAR(actual.r, r, tolerance);
    EXPECT_NEAR(actual.g, g, tolerance);
    EXPECT_NEAR(actual.b, b, tolerance);
}

inline void expect_vector(const Vector3 &actual, double x, double y, double z, double tolerance = 1e-6) {
    EXPECT_NEAR(actual.x, x, tolerance);
    EXPECT_NEAR(actual.y, y, tolerance);
    EXPECT_NEAR(actual.z, z, tolerance);
}

} // namespace gradus
