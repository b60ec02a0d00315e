/// @file
/// The two ways in which dpdref gives up, each with one clear line.
#pragma once

#include <stdexcept>

namespace dpd {

/// Bad input: what, where, what is allowed. Exit code 2.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The simulation left the numbers: at which step, which quantity, what to try. Exit code 3.
struct Diverged : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace dpd
