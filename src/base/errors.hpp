/// @file
/// The ways in which dpdref gives up, each with one clear line.
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

/// The work was asked to stop and has left what it needs to go on. Exit code 130.
struct Interrupted : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace dpd
