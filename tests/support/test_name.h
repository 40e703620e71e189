// Names of tests whose parameter is a scene or a method, and of suites.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace gradus::testing {

/// Scenes have hyphens in their names, where GoogleTest takes underscores only.
inline std::string test_name(std::string scene) {
    std::replace(scene.begin(), scene.end(), '-', '_');
    return scene;
}

/// For INSTANTIATE_TEST_SUITE_P, where the parameter is the scene's name.
inline std::string name_of_scene(const ::testing::TestParamInfo<const char *> &info) { return test_name(info.param); }

/// The same where the parameter is a method's.
inline std::string name_of_method(const ::testing::TestParamInfo<const char *> &info) { return info.param; }

/// Whether the test that runs is one of those instantiated as `Full`, which ./check --full alone runs.
inline bool is_full() {
    return std::string(::testing::UnitTest::GetInstance()->current_test_suite()->name()).starts_with("Full/");
}

} // namespace gradus::testing
