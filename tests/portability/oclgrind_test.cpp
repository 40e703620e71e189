// Every stage under oclgrind, which simulates a device and reports invalid accesses, data races, reads of
// uninitialised memory and wrong API calls. Tiny renders, as it interprets each instruction; not one report is allowed.
//
// Three things are set so that oclgrind 21.10 itself works: kernels are compiled without optimisation and without
// inlining (its checker of uninitialised memory does not know all instructions that these make), by one thread (its
// compiler is not safe for several), which Device sees to, and hence --nthreads 1 too.
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <set>

namespace gradus {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

class Oclgrind : public ProgramTest {
  protected:
    // GRADUS_PROGRAM is `env` here, which finds oclgrind on the path.
    void SetUp() override {
        ProgramTest::SetUp();
        if (!has_oclgrind())
            GTEST_SKIP() << "needs oclgrind (apt install oclgrind; Debian 13 has none)";
    }

    std::string report(const std::string &program) const {
        return text_of("report.txt").empty() ? "" : program + ":\n" + text_of("report.txt").substr(0, 4000);
    }

    /// Names of the stages that had something to do.
    std::set<std::string> render(const std::string &scene, std::vector<std::string> more,
                                 bool finds_uninitialized = true) const {
        std::vector<std::string> arguments = {"oclgrind",
                                              "--data-races",
                                              "--uniform-writes",
                                              "--check-api",
                                              "--log",
                                              at("report.txt"),
                                              "--build-options",
                                              "-cl-opt-disable -D GRADUS_FN=static",
                                              GRADUS_BINARY,
                                              "render",
                                              GRADUS_SCENES + std::string("/") + scene,
                                              "-o",
                                              "out.exr",
                                              "--stats",
                                              "out.json",
                                              "--nthreads",
                                              "1",
                                              "--quiet"};
        if (finds_uninitialized)
            arguments.insert(arguments.begin() + 1, "--uninitialized");
        if (std::find(more.begin(), more.end(), "--method") == more.end())
            more.insert(more.end(), {"--method", "pt"});
        if (std::find(more.begin(), more.end(), "--spp") == more.end())
            more.insert(more.end(), {"--spp", "2"});
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.signal, 0);
        EXPECT_EQ(outcome.exit_code, 0);
        // The compiler counts its warnings there: the same clang as PoCL's, on all kernels.
        EXPECT_EQ(outcome.err, "");
        EXPECT_EQ(report(scene), "");
        if (outcome.exit_code != 0)
            return {};
        const nlohmann::json statistics = nlohmann::json::parse(text_of("out.json"));
        EXPECT_EQ(statistics.at("device").at("platform"), "Oclgrind");
        EXPECT_EQ(statistics.at("non_finite"), 0);
        std::set<std::string> stages;
        for (const auto &stage : statistics.at("stages"))
            if (stage.at("items") > 0)
                stages.insert(stage.at("name"));
        return stages;
    }

    /// Runs one work-item each on four elements of two buffers, the first of which nobody has written.
    std::string report_of(const std::string &body) const {
        std::ofstream(folder / "kernel.cl") << "kernel void checked(global float *in, global float *out) {\n"
                                            << "    const size_t i = get_global_id(0);\n    " << body << "\n}\n";
        std::ofstream(folder / "kernel.sim") << "kernel.cl\nchecked\n4 1 1\n1 1 1\n"
                                             << "<size=16 float noinit>\n<size=16 float noinit>\n";
        const Outcome outcome = run({"oclgrind-kernel", "--data-races", "--uniform-writes", "--uninitialized", "--log",
                                     at("report.txt"), "kernel.sim"});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return report("kernel.cl");
    }
};

/// What most of the others meet too, or takes long.
class FullOclgrind : public Oclgrind {};

TEST_F(Oclgrind, ReportsWhatItIsToFind) {
    EXPECT_EQ(report_of("out[i] = (float)i;"), "");
    EXPECT_THAT(report_of("out[i] = in[i];"), HasSubstr("Uninitialized value"));
    EXPECT_THAT(report_of("out[0] = (float)i;"), HasSubstr("data race"));
    EXPECT_THAT(report_of("out[i + 100] = (float)i;"), HasSubstr("Invalid write"));
}

// Walks of chains, there and back, that arrive and that fail; no method has them yet.
TEST_F(Oclgrind, ManifoldWalks) {
    const Outcome outcome =
        run({"GRADUS_TEST_THREADS=1", "oclgrind", "--data-races", "--uniform-writes", "--uninitialized", "--check-api",
             "--log", at("report.txt"), "--build-options", "-cl-opt-disable -D GRADUS_FN=static", GRADUS_WALK_TEST,
             "--gtest_filter=ManifoldWalkOf.ChainsWithoutAWayFailAndAreCounted"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
    EXPECT_EQ(report("walks"), "");
}

// Of the materials, whose Dirac kinds share their kernels.
const std::string kinds[] = {
    "diffuse", "roughconductor_ggx", "roughconductor_beckmann", "roughdielectric_ggx", "roughdielectric_beckmann",
    "dirac"};

// Every BSDF kind and light kind, meshes and spheres, the layers, and two batches.
TEST_F(Oclgrind, EveryMaterialAndLight) {
    std::vector<std::string> expected = {"camera",          "classify",       "escape",
                                         "emission",        "connect",        "accumulate",
                                         "partition count", "partition scan", "partition scatter"};
    for (const std::string &kind : kinds)
        expected.push_back("shade " + kind);
    EXPECT_THAT(render("materials.xml", {"--size", "8x8", "--aov", "--batch-size", "64"}), IsSupersetOf(expected));
}

// The same by gradient-domain path tracing; the reconstruction's kernels have a test of their own.
TEST_F(FullOclgrind, GradientsOfEveryMaterialAndLight) {
    std::vector<std::string> expected = {"primary",    "gradient_begin",     "gradient_connect", "shift",
                                         "weigh",      "weigh apart",        "gradient escape",  "gradient emission",
                                         "advance",    "advance apart",      "shift count",      "gradient_combine",
                                         "accumulate", "gradient_accumulate"};
    for (const std::string &kind : kinds) {
        expected.push_back("shade " + kind);
        expected.push_back("evaluate " + kind);
    }
    // On so few pixels neighbours are seldom of one kind. What `shift` does of its own is the same for all kinds but
    // the Dirac ones, and `evaluate` has called their functions.
    for (const std::string kind : {"diffuse", "dirac", "roughdielectric_beckmann"})
        expected.push_back("shift " + kind);
    for (const std::string kind : {"diffuse", "dirac", "roughdielectric_ggx"})
        expected.push_back("join " + kind);
    EXPECT_THAT(render("materials.xml", {"--method", "gpt", "--norm", "L2", "--size", "20x15", "--crop", "9,4,8,8",
                                         "--batch-size", "64", "--seed", "9"}),
                IsSupersetOf(expected));
}

// Of one material and light, in strips of two rows, the last of one: passes are 256 paths, four batches.
TEST_F(FullOclgrind, GradientsInStripsOfACrop) {
    EXPECT_THAT(render("cornell-box.xml", {"--method", "gpt", "--norm", "L2", "--size", "96x72", "--crop", "5,7,66,3",
                                           "--batch-size", "48", "--rr-depth", "2", "--spp", "1"}),
                IsSupersetOf({"shift", "weigh", "advance", "join diffuse"}));
}

TEST_F(FullOclgrind, GradientsOfPhotonsStraightFromLights) {
    render("cornell-box.xml", {"--method", "gpm", "--norm", "L2", "--size", "6x5", "--photons", "20", "--radius", "5%",
                               "--direct", "photons", "--batch-size", "64"});
}

// With fewer samples there are no variances of halves.
TEST_F(FullOclgrind, ReconstructionsByVariances) {
    const std::vector<std::string> small = {"--size", "6x5", "--spp", "4", "--max-depth", "3"};
    const auto by = [&](const std::string &method, const std::string &reconstruction, bool finds_uninitialized = true) {
        std::vector<std::string> arguments = small;
        arguments.insert(arguments.end(), {"--method", method, "--reconstruction", reconstruction});
        render("cornell-box.xml", arguments, finds_uninitialized);
    };
    by("gpt", "weighted");
    by("pt", "guided");
    // Oclgrind 21.10 goes on with what it knew of a released buffer where a larger one takes its place, and takes what
    // lies behind for never written.
    by("gpt", "guided", false);
}

TEST_F(FullOclgrind, GradientsWithEveryTrait) {
    render("materials.xml", {"--method", "gpt", "--norm", "L2", "--size", "6x6", "--all-traits", "--aov"});
}

TEST_F(Oclgrind, KernelsWithEveryTrait) {
    render("materials.xml", {"--size", "8x8", "--all-traits", "-D", "rfilter=tent"});
}

TEST_F(FullOclgrind, AnisotropicRoughness) { render("plates.xml", {"--size", "8x8"}); }

TEST_F(FullOclgrind, OneMaterialOneLight) { render("cornell-box.xml", {"--size", "8x8", "-D", "rfilter=gaussian"}); }

TEST_F(FullOclgrind, AnEnvironmentMapAndASpot) {
    render("sundial.xml", {"--method", "gpt", "--norm", "L2", "--size", "6x5"});
}

TEST_F(FullOclgrind, ABatchThatIsNoWholeSampleOfTheImage) {
    render("torus-rough-glass.xml", {"--size", "12x9", "--batch-size", "64"});
}

TEST_F(FullOclgrind, ACropAndRussianRoulette) {
    render("door-ajar.xml", {"--size", "32x24", "--crop", "5,7,9,5", "--rr-depth", "2"});
}

// Photons by both estimators of direct light, with growing tables and several windows of pairs.
TEST_F(FullOclgrind, Photons) {
    std::vector<std::string> expected = {"travel",       "gather",        "photon_cells",       "photon_copy",
                                         "photon_lines", "photon_starts", "photon_pairs count", "photon_pairs list",
                                         "pair_scan",    "pair_sum",      "gather_add"};
    expected.push_back("photon_evaluate diffuse");
    EXPECT_THAT(render("materials.xml", {"--method", "sppm", "--size", "8x8", "--photons", "200", "--radius", "5%",
                                         "--batch-size", "64"}),
                IsSupersetOf(expected));
    EXPECT_THAT(render("cornell-box.xml", {"--method", "sppm", "--size", "8x8", "--photons", "200", "--radius", "5%",
                                           "--direct", "photons", "--aov", "--batch-size", "64"}),
                IsSupersetOf({"bias_sum", "bias_add"}));
}

// Photons shifted by reconnections and walks.
TEST_F(FullOclgrind, GradientsOfPhotons) {
    EXPECT_THAT(render("lamp-in-egg.xml", {"--method", "gpm", "--norm", "L2", "--size", "6x5", "--photons", "45",
                                           "--radius", "10%", "--batch-size", "64"}),
                IsSupersetOf({"photon_shift diffuse", "photon_reconnect diffuse", "photon_arrive diffuse",
                              "photon_project", "photon_walk", "photon_leave light", "photon_pass dielectric",
                              "photon_pass end", "pair_difference_sum", "gradient_gather"}));
}

TEST_F(FullOclgrind, GradientsOfPhotonsByGlossySurfaces) {
    EXPECT_THAT(render("cornell-box-glossy.xml", {"--method", "gpm", "--norm", "L2", "--size", "6x5", "--photons",
                                                  "150", "--radius", "10%", "--batch-size", "64", "--spp", "1"}),
                IsSupersetOf({"photon_pass roughconductor_ggx", "photon_pass roughdielectric_ggx"}));
}

} // namespace
} // namespace gradus
