/// @file
/// Asked to stop: SIGINT, SIGTERM, SIGHUP.
#pragma once

#include <atomic>

namespace dpd {

/// From now on those signals ask to stop. What does not end within a second, a long step or a pipe that is
/// read, ends the program then: exit code 130, one line; files are whole all the time. A second signal ends
/// it at once. A write to a closed output, or to a file beyond the size that is allowed, is an error
/// of that write. SIGHUP is left alone where it is ignored (nohup).
void catch_signals();

/// Whether one has come.
std::atomic<bool> const& stop_requested();

/// While one lives, the program is not ended in the middle: a file is being written.
class Unhurried {
public:
    /// Signals wait from here on.
    Unhurried();
    ~Unhurried();
    Unhurried(Unhurried const&) = delete;
    Unhurried& operator=(Unhurried const&) = delete;
};

}  // namespace dpd
