// The embedded kernel sources, put together; and that each declares the traits that it depends on.
#include "runtime/device/embedded_kernels.h"
#include "runtime/device/kernel_source.h"
#include "runtime/error.h"
#include "runtime/scene/traits.h"
#include "tests/device/stage_files.h"
#include "tests/support/pattern.h"

#include <gmock/gmock.h>

#include <map>
#include <sstream>

namespace gradus {
namespace {

using ::testing::HasSubstr;
using testing::Pattern;
using testing::stage_files;

std::vector<std::string> lines_of(const std::string &text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

/// The text without comments, strings and the lines that declare traits.
std::string code_of(const std::string &text) {
    std::string code;
    for (const std::string &line : lines_of(text))
        if (!line.starts_with("//!"))
            code += line + "\n";
    static const Pattern comment("/\\*[^*]*\\*+([^/*][^*]*\\*+)*/|//[^\n]*"), string("\"[^\"\n]*\"");
    return string.replaced_in(comment.replaced_in(code, " "), " ");
}

std::set<std::string> traits_used_in(const std::string &text) {
    static const Pattern name(
        R"(\b(TRAIT_\w+|STRATEGY|SAMPLES_LIGHTS|FEW_LIGHTS|MANY_LIGHTS|SOLVER_(CHANNELS|WEIGHTED|JOINT))\b)");
    const std::string code = code_of(text);
    std::set<std::string> names;
    for (const Pattern::Match &match : name.all_in(code))
        names.insert(match[0]);
    return names;
}

std::set<std::string> missing(const std::set<std::string> &wanted, const std::set<std::string> &there) {
    std::set<std::string> result;
    for (const std::string &name : wanted)
        if (!there.contains(name))
            result.insert(name);
    return result;
}

TEST(EmbeddedKernels, HoldEveryStage) {
    EXPECT_THAT(stage_files(), ::testing::IsSupersetOf({"kernels/stages/camera.cl", "kernels/stages/shade.cl",
                                                        "kernels/stages/shift.cl", "kernels/stages/accumulate.cl"}));
    for (const EmbeddedKernel &file : embedded_kernels())
        EXPECT_FALSE(file.text.empty()) << file.path;
}

// A name that a file uses without a declaration would be 0 in its kernels, whatever the scene.
TEST(KernelTraits, AreDeclaredByWhoeverUsesThem) {
    std::size_t found = 0;
    for (const EmbeddedKernel &file : embedded_kernels()) {
        const std::set<std::string> used = traits_used_in(file.text);
        found += used.size();
        EXPECT_THAT(missing(used, kernel_source(file.path).traits), ::testing::IsEmpty()) << file.path;
    }
    EXPECT_GT(found, 20u) << "the scan finds no names";
}

// A name that a kernel is compiled for without any use of it would compile the kernel anew for nothing.
TEST(KernelTraits, AreUsedByEachStageThatHasThem) {
    std::map<std::string, std::set<std::string>> used_in; // each file is part of many sources
    for (const EmbeddedKernel &file : embedded_kernels())
        used_in["#line 1 \"" + std::string(file.path) + "\""] = traits_used_in(file.text);
    for (const std::string &path : stage_files()) {
        const KernelSource &source = kernel_source(path);
        std::set<std::string> used;
        for (const std::string &line : lines_of(source.text))
            if (const auto file = used_in.find(line); file != used_in.end())
                used.insert(file->second.begin(), file->second.end());
        EXPECT_THAT(missing(source.traits, used), ::testing::IsEmpty()) << path;
    }
}

TEST(KernelTraits, AreThoseThatAMethodKnows) {
    // Of the render and of the solver, not of the scene.
    std::set<std::string> known = {
        "TRAIT_AOV",         "TRAIT_SHARED_JITTER",  "TRAIT_APART",        "TRAIT_SHIFT_DISTANCE", "TRAIT_SHARED_START",
        "TRAIT_GRADIENT",    "TRAIT_LIGHT_VERTICES", "TRAIT_LIGHT_STARTS", "TRAIT_STRATIFIED",     "TRAIT_LOBE_LEVELS",
        "TRAIT_ONLY_CHAINS", "TRAIT_OPACITY",        "SAMPLES_LIGHTS",     "FEW_LIGHTS",           "MANY_LIGHTS",
        "STRATEGY",          "SOLVER_CHANNELS",      "SOLVER_WEIGHTED",    "SOLVER_JOINT",         "TRAIT_PART_BITS",
        "TRAIT_LIGHT_TREE"};
    for (const auto &[name, value] : scene_traits(Scene{}))
        known.insert(name);
    known.erase("TRAIT_FAR_CLIP"); // a stage of its own, there or not
    std::set<std::string> declared;
    for (const std::string &path : stage_files()) {
        const std::set<std::string> &traits = kernel_source(path).traits;
        declared.insert(traits.begin(), traits.end());
    }
    EXPECT_THAT(missing(declared, known), ::testing::IsEmpty());
    EXPECT_THAT(missing(known, declared), ::testing::IsEmpty()) << "no kernel asks for these";
}

TEST(KernelSource, HoldsEachFileOnce) {
    for (const std::string &path : stage_files()) {
        std::set<std::string> begun;
        for (const std::string &line : lines_of(kernel_source(path).text)) {
            if (line.starts_with("#line 1 \"")) {
                EXPECT_TRUE(begun.insert(line).second) << path << " holds twice: " << line;
            }
            EXPECT_FALSE(line.starts_with("#include \"")) << path << ": " << line;
        }
        EXPECT_TRUE(begun.contains("#line 1 \"" + path + "\""));
    }
}

// A compiler's message names file and line by the #line directives.
TEST(KernelSource, NumbersItsLinesAsTheirFilesDo) {
    static const Pattern directive("^#line ([0-9]+) \"([^\"]+)\"$");
    for (const std::string &path : stage_files()) {
        std::vector<std::string> file;
        std::string name;
        std::size_t next = 0, checked = 0;
        for (const std::string &line : lines_of(kernel_source(path).text)) {
            if (const std::vector<Pattern::Match> found = directive.all_in(line); !found.empty()) {
                next = std::stoul(found[0][1]);
                name = found[0][2];
                for (const EmbeddedKernel &embedded : embedded_kernels())
                    if (embedded.path == name)
                        file = lines_of(embedded.text);
                continue;
            }
            ASSERT_GE(next, 1u) << "text before the first #line";
            ASSERT_LE(next, file.size()) << name;
            ASSERT_EQ(line, file[next - 1]) << name << ":" << next;
            ++next;
            ++checked;
        }
        EXPECT_GT(checked, 20u) << path;
    }
}

// OpenCL C 1.2 has none (section 6.9 e), and NVIDIA's compiler refuses them; PoCL's does not say so.
TEST(KernelSource, HasNoVariadicMacros) {
    static const Pattern variadic(R"(^\s*#\s*define\s+\w+\([^)]*\.\.\.)");
    ASSERT_TRUE(variadic.is_in("#define F(a, ...) a")) << "the scan finds nothing";
    for (const EmbeddedKernel &file : embedded_kernels())
        for (const std::string &line : lines_of(file.text))
            EXPECT_FALSE(variadic.is_in(line)) << file.path << ": " << line;
}

TEST(KernelSource, OfAFileThatIsNotThereIsAnError) {
    try {
        kernel_source("kernels/stages/nowhere.cl");
        FAIL();
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::device);
        EXPECT_THAT(error.what(), HasSubstr("kernels/stages/nowhere.cl"));
    }
}

} // namespace
} // namespace gradus
