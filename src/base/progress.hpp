/// @file
/// A line of progress with the time left, on a terminal only.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace dpd {

class Progress {
public:
    /// Silent unless standard error is a terminal.
    explicit Progress(std::string title);
    ~Progress();

    /// `fraction` of the work is done; safe to call from several threads.
    void operator()(double fraction);

private:
    std::string title_;
    bool terminal_;
    std::chrono::steady_clock::time_point start_, last_;
    double first_ = -1.0;  ///< fraction found done at the start, by an earlier run
    std::mutex mutex_;
};

/// "2:05", "1:02:05", "0.3 s"
std::string duration_text(double seconds);

}  // namespace dpd
