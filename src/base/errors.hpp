/// @file
/// The ways in which dpdref gives up, each with one clear line.
#pragma once

#include <stdexcept>
#include <string>

namespace dpd {

/// The text on one line, for messages: a control character becomes a space.
inline std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

/// Bad input: what, where, what is allowed. Exit code 2.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file that is not what it was when it was written, or holds what cannot be.
struct Damaged : InputError {
    using InputError::InputError;
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
