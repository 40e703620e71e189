// Ctrl-C and its like as a flag, so that a render ends with a valid image.
#pragma once

namespace gradus {

/// Gives SIGINT, SIGTERM and SIGHUP back to nobody where the process was started to ignore them: the compiler within an
/// OpenCL implementation takes them for itself when it is loaded.
void ignore_what_was_ignored();

/// While an object of it lives, the first SIGINT, SIGTERM or SIGHUP only sets a flag. What follows within 0.3 s belongs
/// to the same wish and does nothing; later a second SIGINT or SIGTERM ends the process at once, as it would without
/// the object, and a SIGHUP still does nothing. Signals that the process was started to ignore stay ignored (nohup, a
/// shell's background jobs). One object at a time.
class InterruptWatch {
  public:
    InterruptWatch();
    ~InterruptWatch();
    InterruptWatch(const InterruptWatch &) = delete;
    InterruptWatch &operator=(const InterruptWatch &) = delete;

    bool requested() const;
    /// From now on the first signal writes this line to stderr at once: for work that does not look at requested().
    /// The text must stay where it is.
    void answer(const char *line);
};

} // namespace gradus
