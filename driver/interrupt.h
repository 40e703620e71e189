// Ctrl-C and its like as a flag, so that a render ends with a valid image.
#pragma once

namespace gradus {

/// Gives SIGINT, SIGTERM and SIGHUP back to nobody where the process was started to ignore them: the compiler within an
/// OpenCL implementation takes them for itself when it is loaded.
void ignore_what_was_ignored();

/// From now on a thread of its own takes SIGINT, SIGTERM and SIGHUP, and all others, which are started later, have them
/// blocked, as have the programs that these start: an OpenCL implementation's linker, which Ctrl-C and `timeout` send
/// their signals to as well, does its work to the end. To be called before there are other threads. Without a thread to
/// spare, all is as it was.
void take_signals_in_a_thread();

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
