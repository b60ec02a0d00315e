/// @file
/// Progress and the time left, on standard error: one line that is kept up to date on a terminal, elsewhere a
/// new line now and then.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace dpd {

/// A line on standard error that does not stop the work: "dpdref: warning: ...".
void warn(std::string const& text);

class Progress {
public:
    /// Where standard error is no terminal, a line is written after each `interval`; shorter work is silent.
    explicit Progress(std::string title, std::chrono::duration<double> interval = std::chrono::seconds(30));
    ~Progress();

    /// `fraction` of the work is done; safe to call from several threads.
    void operator()(double fraction);

    /// What the lines say besides from now on.
    void tell(std::string const& text);

private:
    std::string title_, told_;
    bool terminal_;
    std::chrono::duration<double> interval_;  ///< between two lines, or two states of one
    std::chrono::steady_clock::time_point start_, last_;
    double first_ = -1.0;  ///< fraction found done at the start, by an earlier run
    std::mutex mutex_;
};

/// "2:05", "1:02:05", "0.3 s"
std::string duration_text(double seconds);

}  // namespace dpd
