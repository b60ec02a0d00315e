#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "errors.hpp"

namespace dpd {

void warn(std::string const& text) { fmt::print(stderr, "dpdref: warning: {}\n", one_line(text)); }

std::string duration_text(double seconds) {
    if (!std::isfinite(seconds)) return "unknown";
    if (seconds < 10.0) return fmt::format("{:.1f} s", seconds);
    auto const whole = static_cast<long>(seconds + 0.5);
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

Progress::Progress(std::string title, std::chrono::duration<double> interval)
    : title_(std::move(title)),
      terminal_(::isatty(STDERR_FILENO) == 1),
      interval_(terminal_ ? std::chrono::milliseconds(200) : interval),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
    if (terminal_) fmt::print(stderr, "\r\033[K");
}

void Progress::tell(std::string const& text) {
    std::scoped_lock const lock(mutex_);
    told_ = text.empty() ? "" : ", " + text;
}

void Progress::operator()(double fraction) {
    std::scoped_lock const lock(mutex_);
    auto const now = std::chrono::steady_clock::now();
    if (first_ < 0.0) first_ = fraction;
    if (now - last_ < interval_) return;
    last_ = now;
    double const elapsed = std::chrono::duration<double>(now - start_).count();
    double const done = fraction - first_;
    auto const left = done > 0.0 ? duration_text(elapsed * (1.0 - fraction) / done) : std::string("?");
    if (terminal_)
        fmt::print(stderr, "\r\033[K{} {:5.1f} %  {} left{}", title_, 100.0 * fraction, left, told_);
    else
        fmt::print(stderr, "{}: {:.1f} % done after {}, {} left{}\n", title_, 100.0 * fraction,
                   duration_text(elapsed), left, told_);
    std::fflush(stderr);
}

}  // namespace dpd
