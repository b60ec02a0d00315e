/// @file
/// Numbers as users write them.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace dpd {

/// The number that a text is as a whole, which may not be finite; nothing for any other text.
inline std::optional<double> number_in(std::string_view text) {
    double number = 0.0;
    char const* const end = text.data() + text.size();
    auto const [stop, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc{} || stop != end) return std::nullopt;
    return number;
}

}  // namespace dpd
