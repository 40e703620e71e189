// What a render tells while it runs: one line that is redrawn on a terminal, a plain line now and then elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>

namespace gradus {

/// Where a render stands. A limit of 0 is none.
struct ProgressState {
    std::uint64_t done = 0, total = 0;  ///< samples
    double elapsed = 0;                 ///< seconds
    double time_limit = 0;              ///< seconds
    bool sample_limit = true;           ///< false: `total` is no aim, the other limits end the render
    double error_limit = 0;             ///< estimated relMSE
    std::optional<double> error{};      ///< where it is known
    std::uint64_t samples_of_error = 0; ///< at which it was
};

/// "0:07", "12:34" or "1:02:03".
std::string format_duration(double seconds);
/// Four characters or so with a unit: "950", "12.3 k", "4.56 M", "1.20 G".
std::string format_count(double count);
/// The part of the render that is done, 0 to 1: of the samples, of the time or of the samples that the error may take,
/// whichever is nearer its end. Errors are taken to fall as one over the samples, and looked at as these double.
double progress_fraction(const ProgressState &state);
/// Percent, samples, rate, time elapsed, time left and error. With `bar_width` > 0 it begins with a bar of that many
/// columns.
std::string progress_line(const ProgressState &state, int bar_width);

/// Safe to call from several threads.
class Progress {
  public:
    enum class Mode { quiet, plain, terminal };
    /// quiet where asked for; else by what `out` is.
    static Mode choose_mode(bool quiet, std::FILE *out);

    explicit Progress(Mode mode, std::FILE *out = stderr, double plain_interval = 5.0);

    /// A line of its own, above the line that is redrawn.
    void message(const std::string &text);
    /// A line for a kernel that was compiled: `ready` of `total` are there now.
    void compiled(const std::string &kernel, std::size_t ready, std::size_t total, double seconds);
    /// What is being done before the render, and for how long, in seconds: on a terminal a line that is redrawn,
    /// elsewhere one line for each phase that lasts.
    void phase(const std::string &text, double seconds);
    /// The line goes.
    void phase_ended();
    Mode mode() const { return mode_; }
    /// To be called after each batch; prints only when enough time has passed.
    void update(const ProgressState &state);
    /// The last line.
    void finish(const ProgressState &state);

  private:
    void draw(const ProgressState &state);
    void clear_line();

    const Mode mode_;
    std::FILE *const out_;
    const double plain_interval_;
    std::mutex mutex_;
    bool drawn_ = false, started_ = false;
    std::string told_phase_; ///< the last that a plain line told
    std::chrono::steady_clock::time_point last_;
};

} // namespace gradus
