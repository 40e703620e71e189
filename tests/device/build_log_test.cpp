#include "runtime/device/build_log.h"

#include <gtest/gtest.h>

namespace gradus {
namespace {

const std::string two_files = "#line 1 \"kernels/a.cl\"\n" // line 1
                              "first\n"
                              "#line 1 \"kernels/b.h\"\n"
                              "inner\n"
                              "#line 7 \"kernels/a.cl\"\n"
                              "seventh\n" // line 6
                              "eighth\n";

TEST(BuildLog, OfLinesOfTheWholeSourceNamesTheirFiles) {
    EXPECT_EQ(with_file_names("<kernel>:2:9: error: x\n", two_files), "kernels/a.cl:1:9: error: x\n");
    EXPECT_EQ(with_file_names("In <kernel>:4:1: and <kernel>:7:33: note", two_files),
              "In kernels/b.h:1:1: and kernels/a.cl:8:33: note");
}

TEST(BuildLog, AsksForTheFolderWhereTheSourceHasNoError) {
    EXPECT_EQ(with_hint_at_folder("a.cl:1:9: error: x", "/shm"), "a.cl:1:9: error: x");
    EXPECT_EQ(with_hint_at_folder("failed", "/shm"),
              "failed\nno error in the source is told: is '/shm' full, or not to be written to?");
    EXPECT_NE(with_hint_at_folder("", "").find("POCL_CACHE_DIR"), std::string::npos);
}

TEST(BuildLog, StaysAsItIsElsewhere) {
    for (const std::string log : {"", "kernels/a.cl:2:9: error", "<kernel>: no line", "<kernel>:99:1: past the end",
                                  "<kernel>:0:1: before it", "<kernel>:"})
        EXPECT_EQ(with_file_names(log, two_files), log);
    EXPECT_EQ(with_file_names("<kernel>:1:1: x", "no directive"), "<kernel>:1:1: x");
}

} // namespace
} // namespace gradus
