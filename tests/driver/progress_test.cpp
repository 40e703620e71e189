#include "driver/phase_watch.h"
#include "driver/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

namespace gradus {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A file of its own that Progress prints to.
class Printed {
  public:
    ~Printed() { std::fclose(file); }
    std::string text() const {
        std::fflush(file);
        std::rewind(file);
        std::string text;
        for (int letter = std::fgetc(file); letter != EOF; letter = std::fgetc(file))
            text += char(letter);
        return text;
    }
    std::FILE *file = std::tmpfile();
};

ProgressState state(std::uint64_t done, double elapsed) {
    ProgressState state;
    state.done = done;
    state.total = 4000000;
    state.elapsed = elapsed;
    return state;
}

TEST(Progress, Durations) {
    EXPECT_EQ(format_duration(0), "0:00");
    EXPECT_EQ(format_duration(6.2), "0:07");
    EXPECT_EQ(format_duration(60), "1:00");
    EXPECT_EQ(format_duration(3723), "1:02:03");
}

TEST(Progress, Counts) {
    EXPECT_EQ(format_count(0), "0");
    EXPECT_EQ(format_count(999), "999");
    EXPECT_EQ(format_count(1000), "1.00 k");
    EXPECT_EQ(format_count(12345), "12.3 k");
    EXPECT_EQ(format_count(999999), "1.00 M");
    EXPECT_EQ(format_count(2.5e9), "2.50 G");
}

TEST(Progress, LineHasShareRateAndTimeLeft) {
    const std::string line = progress_line(state(1000000, 2), 0);
    EXPECT_EQ(line, " 25 %  1.00 M samples  500 k/s  0:02 elapsed  0:06 left");
    EXPECT_EQ(progress_line(state(1000000, 2), 8).substr(0, 10), "[==      ]");
    EXPECT_THAT(progress_line(state(0, 0), 0), Not(HasSubstr("left")));
}

TEST(Progress, PhasesThatLast) {
    Printed terminal, plain, quiet;
    {
        Progress progress(Progress::Mode::terminal, terminal.file);
        progress.phase("decoding pictures", 1.2);
        progress.phase_ended();
        progress.phase_ended();
    }
    EXPECT_EQ(terminal.text(), "\rdecoding pictures  0:01\x1b[K\r\x1b[K");
    {
        Progress progress(Progress::Mode::plain, plain.file, 5);
        for (const double seconds : {4.9, 5.0, 6.0})
            progress.phase("decoding pictures", seconds);
        progress.phase("building meshes", 5);
        progress.phase_ended();
    }
    EXPECT_EQ(plain.text(), "decoding pictures\nbuilding meshes\n");
    Progress(Progress::Mode::quiet, quiet.file).phase("decoding pictures", 100);
    EXPECT_EQ(quiet.text(), "");
}

TEST(PhaseWatch, TellsThoseThatAreFelt) {
    Printed printed;
    Progress progress(Progress::Mode::terminal, printed.file);
    Phases phases;
    {
        const PhaseWatch watch(phases, progress);
        const auto wait = [](int milliseconds) {
            std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        };
        const Phase outer(&phases, phase_names::build);
        in_phase(&phases, phase_names::meshes, [&] { wait(150); });
        // In pieces, too: what counts is all of its time.
        for (int i = 0; i < 10; ++i)
            in_phase(&phases, phase_names::pictures, [&] { wait(90); });
    }
    EXPECT_THAT(printed.text(), HasSubstr("decoding pictures  0:00"));
    EXPECT_THAT(printed.text(), Not(HasSubstr("building")));
    EXPECT_TRUE(printed.text().ends_with("\r\x1b[K")) << "the line is gone";
}

TEST(Phases, TimeIsOfTheInnermost) {
    Phases phases;
    EXPECT_FALSE(phases.current());
    {
        const Phase outer(&phases, phase_names::build);
        in_phase(&phases, phase_names::meshes, [] { std::this_thread::sleep_for(std::chrono::milliseconds(30)); });
        EXPECT_STREQ(phases.current()->name.key, "build");
    }
    in_phase(nullptr, phase_names::tree, [] {});
    const std::vector<Phases::Time> times = phases.times();
    ASSERT_EQ(times.size(), 2u);
    EXPECT_STREQ(times[0].name.key, "build");
    EXPECT_STREQ(times[1].name.key, "meshes");
    EXPECT_GE(times[1].seconds, 0.03);
    EXPECT_LT(times[0].seconds, times[1].seconds); // by a factor of thousands where nothing else runs
    EXPECT_FALSE(phases.current());
}

TEST(Progress, LineHasTheErrorAndWhatItTakes) {
    ProgressState now = state(1500000, 3);
    now.sample_limit = false;
    now.error_limit = 0.01;
    EXPECT_EQ(progress_line(now, 0), "  0 %  1.50 M samples  500 k/s  0:03 elapsed");
    now.error = 0.03; // three times the aim takes two doublings
    now.samples_of_error = 1000000;
    EXPECT_DOUBLE_EQ(progress_fraction(now), 0.375);
    EXPECT_EQ(progress_line(now, 0), " 37 %  1.50 M samples  500 k/s  0:03 elapsed  0:05 left  relMSE 0.03 of 0.01");
    now.error = 0.005;
    EXPECT_DOUBLE_EQ(progress_fraction(now), 1);
    now.error = 0;
    EXPECT_DOUBLE_EQ(progress_fraction(now), 0);
}

TEST(Progress, TheNearerLimitCounts) {
    ProgressState timed = state(1000000, 3);
    timed.time_limit = 4;
    EXPECT_DOUBLE_EQ(progress_fraction(timed), 0.75);
    timed.time_limit = 300;
    EXPECT_DOUBLE_EQ(progress_fraction(timed), 0.25);
    timed.sample_limit = false;
    EXPECT_DOUBLE_EQ(progress_fraction(timed), 0.01);
    timed.time_limit = 1;
    EXPECT_DOUBLE_EQ(progress_fraction(timed), 1);
}

TEST(Progress, PlainLinesComeNowAndThenAndAtBothEnds) {
    const Printed printed;
    EXPECT_EQ(Progress::choose_mode(false, printed.file), Progress::Mode::plain);
    Progress progress(Progress::Mode::plain, printed.file, 3600);
    for (int i = 0; i < 100; ++i)
        progress.update(state(std::uint64_t(i) * 10000, 1));
    progress.finish(state(4000000, 9));
    const std::string text = printed.text();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
    EXPECT_THAT(text, Not(HasSubstr("\r")));
    EXPECT_THAT(text, HasSubstr("100 %"));
}

TEST(Progress, ATerminalHasOneLineThatIsRedrawn) {
    const Printed printed;
    Progress progress(Progress::Mode::terminal, printed.file);
    progress.update(state(1000000, 1));
    progress.message("a message");
    progress.update(state(2000000, 1)); // too soon to be drawn
    progress.finish(state(4000000, 9));
    const std::string text = printed.text();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << "the message's and the last";
    EXPECT_THAT(text, HasSubstr("\r\x1b[Ka message\n"));
    EXPECT_THAT(text, Not(HasSubstr(" 50 %")));
    EXPECT_EQ(text.back(), '\n');
}

TEST(Progress, QuietPrintsNothing) {
    const Printed printed;
    EXPECT_EQ(Progress::choose_mode(true, printed.file), Progress::Mode::quiet);
    Progress progress(Progress::Mode::quiet, printed.file);
    progress.message("text");
    progress.compiled("kernel", 1, 2, 0.1);
    progress.update(state(1, 1));
    progress.finish(state(2, 2));
    EXPECT_EQ(printed.text(), "");
}

TEST(Progress, LinesOfSeveralThreadsStayWhole) {
    const Printed printed;
    Progress progress(Progress::Mode::plain, printed.file);
    std::vector<std::thread> threads;
    for (int thread = 0; thread < 4; ++thread)
        threads.emplace_back([&progress] {
            for (int i = 0; i < 50; ++i)
                progress.compiled("kernel", 3, 7, 0.5);
        });
    for (std::thread &thread : threads)
        thread.join();
    std::string expected;
    for (int i = 0; i < 200; ++i)
        expected += "compiled kernel in 0.50 s (3 of 7)\n";
    EXPECT_EQ(printed.text(), expected);
}

} // namespace
} // namespace gradus
