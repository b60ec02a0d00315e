/// @file
/// What a run costs, whatever else the machine does.
#pragma once

#include <ctime>

namespace dpd {

/// Processor time of the calling thread so far, in seconds.
inline double thread_seconds() {
    std::timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

}  // namespace dpd
