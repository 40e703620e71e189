// The solver in processes of their own: with other numbers of threads, and under oclgrind.
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>

namespace gradus {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SolverProcess : public ProgramTest {
  protected:
    /// What solver_digest says, run by `command`. GRADUS_PROGRAM is `env` here.
    Outcome digests(std::vector<std::string> command, const std::string &width, const std::string &height,
                    const std::string &threads, bool few = false) const {
        command.insert(command.end(), {GRADUS_SOLVER_DIGEST, width, height, threads});
        if (few)
            command.push_back("few");
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.signal, 0);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("L2, missing"));
        EXPECT_THAT(outcome.out, Not(HasSubstr("not finite")));
        return outcome;
    }
};

TEST_F(SolverProcess, GivesTheSameBitsWithAnyNumberOfThreads) {
    const Outcome one = digests({}, "333", "201", "1");
    EXPECT_THAT(one.err, HasSubstr(" 1 compute units"));
    for (const std::string threads : {"2", "3", "7"}) {
        const Outcome more = digests({}, "333", "201", threads);
        EXPECT_THAT(more.err, HasSubstr(" " + threads + " compute units"));
        EXPECT_EQ(more.out, one.out) << threads << " threads";
    }
}

/// What takes long.
class FullSolverProcess : public SolverProcess {};

/// As in tests/portability/oclgrind_test.cpp, which shows that these options find what they are to find. One size is
/// of odd width on every level of multigrid and wider than a work-group; a second a pixel is what it takes.
TEST_F(FullSolverProcess, IsCleanUnderOclgrind) {
    if (!has_oclgrind())
        GTEST_SKIP() << "needs oclgrind (apt install oclgrind; Debian 13 has none)";
    for (const auto &[width, height] : {std::pair{"9", "3"}, {"1", "1"}}) {
        const Outcome outcome =
            digests({"oclgrind", "--data-races", "--uniform-writes", "--uninitialized", "--check-api", "--log",
                     at("report.txt"), "--build-options", "-cl-opt-disable -D GRADUS_FN=static"},
                    width, height, "1", true);
        EXPECT_THAT(outcome.err, HasSubstr("Oclgrind"));
        EXPECT_EQ(text_of("report.txt").substr(0, 4000), "") << width << " x " << height;
    }
}

} // namespace
} // namespace gradus
