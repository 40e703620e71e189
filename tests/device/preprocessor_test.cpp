// The preprocessor of kernel sources against the compiler's own, and by hand.
#include "runtime/device/preprocessor.h"

#include "runtime/device/kernel_source.h"
#include "tests/device/stage_files.h"
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>
#include <vector>

namespace gradus {
namespace {

/// Its tokens with a space between each two; "not understood".
std::string result_of(const std::string &text, const std::vector<std::string> &definitions = {}) {
    const auto source = preprocessed(text, definitions);
    if (!source)
        return "not understood";
    std::string result;
    for (const SourceToken &token : source->tokens) {
        result += result.empty() ? "" : " ";
        result += token.kind == SourceToken::Kind::pragma ? "#pragma" : "";
        result += token.spelling;
    }
    return result;
}

/// And pragmas of either writing the same.
std::string without_space(const std::string &text) {
    std::string result;
    std::copy_if(text.begin(), text.end(), std::back_inserter(result),
                 [](unsigned char c) { return !std::isspace(c); });
    constexpr std::string_view operation = "_Pragma(\"", directive = "#pragma";
    for (std::size_t at = 0; (at = result.find(operation, at)) != std::string::npos;) {
        result.erase(result.find("\")", at), 2);
        result.replace(at, operation.size(), directive);
    }
    return result;
}

/// GRADUS_PROGRAM is the compiler that built this.
class PreprocessorOfCompiler : public ProgramTest {
  protected:
    std::string result_of_compiler(const std::string &text, const std::vector<std::string> &definitions) const {
        std::ofstream(at("kernel.c")) << text;
        std::vector<std::string> arguments = {"-E", "-P", "-undef", "-x", "c", "-D__OPENCL_VERSION__=120"};
        for (const std::string &definition : definitions)
            arguments.push_back("-D" + definition);
        arguments.push_back("kernel.c");
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out;
    }
};

TEST_F(PreprocessorOfCompiler, ReadsEveryKernelAsThisDoes) {
    int value = 0;
    std::size_t most = 0;
    for (const std::string &path : testing::stage_files()) {
        const KernelSource &source = kernel_source(path);
        std::vector<std::string> definitions = {"WORK_GROUP_SIZE=64", "BSDF=roughdielectric_ggx",
                                                "GRADUS_DECLARE_BUILTINS"};
        for (const std::string &trait : source.traits)
            definitions.push_back(trait + "=" + std::to_string(value));
        value = (value + 1) % 3;
        const std::string expected = without_space(result_of_compiler(source.text, definitions));
        const std::string result = without_space(result_of(source.text, definitions));
        const auto difference = std::mismatch(result.begin(), result.end(), expected.begin(), expected.end());
        const auto place = difference.first - result.begin();
        EXPECT_TRUE(result == expected) << path << " differs at ..."
                                        << result.substr(static_cast<std::size_t>(std::max(place - 60L, 0L)), 120);
        most = std::max(most, result.size());
    }
    EXPECT_GT(most, 50'000u);
}

TEST(Preprocessor, ExpandsAsTheStandardSays) {
    EXPECT_EQ(result_of("#define f(a) a*g\n#define g f\nf(2)(9)"), "2 * f ( 9 )"); // one of the two that C leaves open
    EXPECT_EQ(result_of("#define z z[0]\n#define f(a) z + a\nf(f(z))"), "z [ 0 ] + z [ 0 ] + z [ 0 ]");
    EXPECT_EQ(result_of("#define AT(t, c) t##_##c\n#define t x\nAT(t, t) AT(path,y)"), "t_t path_y");
    EXPECT_EQ(result_of("#define f() 1\nf f() f ( )"), "f 1 1");
    EXPECT_EQ(result_of("#define f(a, ...) a; __VA_ARGS__\nf(1, 2, (3, 4)) f(1)"), "1 ; 2 , ( 3 , 4 ) 1 ;");
    EXPECT_EQ(result_of("#define f (1)\nf"), "( 1 )") << "a space before the parenthesis";
    EXPECT_EQ(result_of("#define f(a) [a]\nf(1,\n#line 1 \"x\"\n2)"), "not understood") << "one parameter";
    EXPECT_EQ(result_of("#define f(a) [a]\nf((1,\n2))"), "[ ( 1 , 2 ) ]");
    EXPECT_EQ(result_of("#define a b\n#undef a\na"), "a");
    EXPECT_EQ(result_of("a /* b\n c */ d // e\nf", {"a=1", "f"}), "1 d 1");
    EXPECT_EQ(result_of("1.5e-3f+0x1F-.5 a+++b->c"), "1.5e-3f + 0x1F - .5 a ++ + b -> c");
    EXPECT_EQ(result_of("#define long \\\n 1 + \\\n 2\nlong"), "1 + 2");
    EXPECT_EQ(result_of("a // b \\\n c\nd"), "a d") << "a comment that goes on";
}

TEST(Preprocessor, DecidesConditions) {
    const auto holds = [](const std::string &condition) {
        return result_of("#if " + condition + "\nyes\n#else\nno\n#endif", {"ONE=1", "TWO=2", "BOTH=(ONE+TWO)"});
    };
    for (const char *condition : {"ONE",
                                  "!NONE",
                                  "TWO == 2 && ONE != TWO",
                                  "NONE || ONE",
                                  "defined ONE && defined(TWO) && !defined(NONE)",
                                  "BOTH * 2 == 6",
                                  "1 + 2 * 3 == 7",
                                  "-1 < 0",
                                  "(ONE | TWO) == 3",
                                  "TWO & 3",
                                  "1 << 4 == 16",
                                  "7 % 4 == 3",
                                  "ONE ? TWO : NONE",
                                  "0x10u == 16",
                                  "010 == 8",
                                  "10 - 4 - 3 == 3",
                                  "__OPENCL_VERSION__ >= 120",
                                  "~0 == -1",
                                  "(6 ^ 3) == 5",
                                  "9 / 2 == 4",
                                  "16 >> 2 == 4",
                                  "2 >= 2 && 2 <= 2 && 2 > 1"})
        EXPECT_EQ(holds(condition), "yes") << condition;
    for (const char *condition : {"NONE", "defined NONE", "TWO == 1 || NONE", "1 - 1", "!ONE", "ONE ? NONE : TWO"})
        EXPECT_EQ(holds(condition), "no") << condition;
    EXPECT_EQ(result_of("#if 0\na\n#elif 1\nb\n#elif 1\nc\n#else\nd\n#endif"), "b");
    EXPECT_EQ(result_of("#if 0\n#if 1\na\n#else\nb\n#endif\n#error no\n#define x y\n'\n#else\nx\n#endif"), "x");
    EXPECT_EQ(result_of("#if 0\na /* it's\n#endif */\n#endif\nb"), "b");
    EXPECT_EQ(result_of("#if 0\na // b /* c\n#endif\nd /* */"), "d");
    EXPECT_EQ(result_of("#if 0 // no /*\na\n#endif // /*\nb /* */"), "b");
    EXPECT_EQ(result_of("#ifdef ONE\na\n#endif\n#ifndef ONE\nb\n#endif", {"ONE"}), "a");
}

TEST(Preprocessor, LeavesWhatItDoesNotKnowToTheCompiler) {
    for (const char *text : {"#error no",
                             "#include <a>",
                             "#if 1",
                             "#endif",
                             "#else",
                             "#if 1 +\n#endif",
                             "#if 1 2\n#endif",
                             "#if 1.5\n#endif",
                             "#if 1 / 0\n#endif",
                             "#if (-9223372036854775807 - 1) / -1\n#endif",
                             "#if (-9223372036854775807 - 1) % -1\n#endif",
                             "#if 9223372036854775807 + 1\n#endif",
                             "#if -(-9223372036854775807 - 1)\n#endif",
                             "#if 4611686018427387904 * 2\n#endif",
                             "#if 1 << 64\n#endif",
                             "#if 1 << 63\n#endif",
                             "#if 1 >> -1\n#endif",
                             "#if -1 < 0u\n#endif",
                             "#if 1u - 2 > 0\n#endif",
                             "#if ~0U\n#endif",
                             "#if (1\n#endif",
                             "#define f(a) #a\nf(1)",
                             "#define f(a) x##a\nf()",
                             "#define f(a\n",
                             "#define f(a) a\nf(1",
                             "#define f(a) a\nf(1, 2)",
                             "\"no end\n",
                             "/* no end",
                             "#define",
                             "#ifdef\n#endif",
                             "#line x",
                             "#define j a##+\nj"})
        EXPECT_EQ(result_of(text), "not understood") << text;
    EXPECT_EQ(result_of("", {"f(a)=a"}), "not understood");
}

TEST(Preprocessor, KnowsTheFileAndTheLineOfEachToken) {
    const auto source = preprocessed(
        "a\n#define f(x) x \\\n x\n#line 10 \"one\"\n\n/*\n*/ b\n#line 5 \"two\"\nf(\nc) d\n#pragma p q", {});
    ASSERT_TRUE(source);
    std::string places;
    for (const SourceToken &token : source->tokens)
        places += std::string(token.spelling) + " " + std::string(token.file) + ":" + std::to_string(token.line) + "; ";
    EXPECT_EQ(places, "a :1; b one:12; c two:5; c two:5; d two:6;  p q two:7; ");
}

} // namespace
} // namespace gradus
