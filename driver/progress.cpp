#include "driver/progress.h"

#include "runtime/seconds_since.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sys/ioctl.h>
#include <unistd.h>

namespace gradus {
namespace {

constexpr double redraw_interval = 0.1; // seconds

int terminal_columns(std::FILE *out) {
    struct winsize size = {};
    return ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

} // namespace

std::string format_duration(double seconds) {
    const auto whole = static_cast<std::uint64_t>(std::clamp(std::ceil(seconds - 1e-9), 0.0, 1e15));
    const std::uint64_t hours = whole / 3600, minutes = whole / 60 % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60)
                     : fmt::format("{}:{:02}", minutes, whole % 60);
}

std::string format_count(double count) {
    const char *units[] = {"", " k", " M", " G", " T", " P"};
    std::size_t unit = 0;
    while (count >= 999.5 && unit < 5) {
        count /= 1000;
        ++unit;
    }
    const int decimals = unit == 0 || count >= 99.95 ? 0 : count >= 9.995 ? 1 : 2;
    return fmt::format("{:.{}f}{}", count, decimals, units[unit]);
}

double progress_fraction(const ProgressState &state) {
    double fraction = 0;
    if (state.sample_limit && state.total > 0)
        fraction = double(state.done) / double(state.total);
    if (state.error_limit > 0 && state.error && *state.error > 0) {
        const double doublings = std::max(0.0, std::ceil(std::log2(*state.error / state.error_limit)));
        fraction = std::max(fraction, double(state.done) / (double(state.samples_of_error) * std::exp2(doublings)));
    }
    if (state.time_limit > 0)
        fraction = std::max(fraction, state.elapsed / state.time_limit);
    return std::clamp(fraction, 0.0, 1.0);
}

std::string progress_line(const ProgressState &state, int bar_width) {
    const double fraction = progress_fraction(state);
    const double rate = state.elapsed > 0 ? double(state.done) / state.elapsed : 0;
    std::string line;
    if (bar_width > 0) {
        const int filled = static_cast<int>(fraction * bar_width);
        line = fmt::format("[{}{}] ", std::string(filled, '='), std::string(bar_width - filled, ' '));
    }
    line += fmt::format("{:3.0f} %  {} samples  {}/s  {} elapsed", std::floor(fraction * 100), format_count(state.done),
                        format_count(rate), format_duration(std::floor(state.elapsed)));
    if (fraction > 0 && fraction < 1)
        line += fmt::format("  {} left", format_duration(state.elapsed * (1 - fraction) / fraction));
    if (state.error_limit > 0 && state.error)
        line += fmt::format("  relMSE {:.2g} of {:.2g}", *state.error, state.error_limit);
    return line;
}

Progress::Mode Progress::choose_mode(bool quiet, std::FILE *out) {
    if (quiet)
        return Mode::quiet;
    return isatty(fileno(out)) ? Mode::terminal : Mode::plain;
}

Progress::Progress(Mode mode, std::FILE *out, double plain_interval)
    : mode_(mode), out_(out), plain_interval_(plain_interval) {}

void Progress::clear_line() {
    if (drawn_)
        std::fputs("\r\x1b[K", out_);
    drawn_ = false;
}

void Progress::message(const std::string &text) {
    if (mode_ == Mode::quiet)
        return;
    const std::lock_guard lock(mutex_);
    clear_line();
    std::fputs(fmt::format("{}\n", text).c_str(), out_);
    std::fflush(out_);
}

void Progress::compiled(const std::string &kernel, std::size_t ready, std::size_t total, double seconds) {
    message(fmt::format("compiled {} in {:.2f} s ({} of {})", kernel, seconds, ready, total));
}

void Progress::phase(const std::string &text, double seconds) {
    if (mode_ == Mode::quiet)
        return;
    const std::lock_guard lock(mutex_);
    if (mode_ == Mode::terminal) {
        const std::string line = fmt::format("{}  {}", text, format_duration(std::floor(seconds)));
        const auto columns = static_cast<std::size_t>(terminal_columns(out_));
        std::fputs(fmt::format("\r{}\x1b[K", line.substr(0, columns - 1)).c_str(), out_);
        drawn_ = true;
    } else if (seconds >= plain_interval_ && text != told_phase_) {
        std::fputs(fmt::format("{}\n", text).c_str(), out_);
        told_phase_ = text;
    }
    std::fflush(out_);
}

void Progress::phase_ended() {
    const std::lock_guard lock(mutex_);
    clear_line();
    if (mode_ != Mode::quiet)
        std::fflush(out_);
}

void Progress::draw(const ProgressState &state) {
    if (mode_ == Mode::terminal) {
        std::string line = progress_line(state, 20);
        const auto columns = static_cast<std::size_t>(terminal_columns(out_));
        if (line.size() >= columns)
            line = progress_line(state, 0).substr(0, columns - 1);
        std::fputs(fmt::format("\r{}\x1b[K", line).c_str(), out_);
        drawn_ = true;
    } else {
        std::fputs(fmt::format("{}\n", progress_line(state, 0)).c_str(), out_);
    }
    std::fflush(out_);
}

void Progress::update(const ProgressState &state) {
    if (mode_ == Mode::quiet)
        return;
    const std::lock_guard lock(mutex_);
    const double interval = mode_ == Mode::terminal ? redraw_interval : plain_interval_;
    if (started_ && seconds_since(last_) < interval)
        return;
    started_ = true;
    last_ = std::chrono::steady_clock::now();
    draw(state);
}

void Progress::finish(const ProgressState &state) {
    if (mode_ == Mode::quiet)
        return;
    const std::lock_guard lock(mutex_);
    draw(state);
    if (mode_ == Mode::terminal) {
        std::fputs("\n", out_);
        std::fflush(out_);
        drawn_ = false;
    }
}

} // namespace gradus
