/// @file
/// The parameters of a code as they were given.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "conventions.hpp"
#include "errors.hpp"
#include "number.hpp"

namespace dpd {

/// A code's parameters as given, with the defaults of its keys.
class Given {
public:
    /// InputError for a name that the code does not have or that comes twice.
    Given(Code const& code, Assignments const& given) : code_(code), given_(given) {
        for (auto it = given.begin(); it != given.end(); ++it) {
            key(it->first);
            if (std::any_of(given.begin(), it, [&](auto const& other) { return other.first == it->first; }))
                throw InputError(fmt::format("{}: {}: given twice", code.name, it->first));
        }
    }

    /// Whether a parameter was given or has a default.
    bool has(std::string_view name) const { return !text(name).empty(); }

    /// Empty where the key may be missing and is.
    std::string text(std::string_view name) const {
        for (auto const& [given, value] : given_)
            if (given == name) return value;
        auto const& k = key(name);
        if (k.fallback.empty())
            throw InputError(fmt::format("{}: {}: is missing; it is: {}", code_.name, name, k.meaning));
        return std::string(k.fallback == "-" ? "" : k.fallback);
    }

    /// A finite number, > 0, or >= 0 where the key says so.
    double number(std::string_view name) const {
        auto const number = number_in(text(name));
        if (!number || !std::isfinite(*number) || *number < 0.0 || (*number == 0.0 && !key(name).may_be_zero))
            refuse(name, key(name).may_be_zero ? "a number >= 0" : "a number > 0");
        return *number;
    }

    /// A weight function by its name, with the parameter `exponent` where that is `power`.
    Weight weight(std::string_view name) const {
        auto const kind = value_of<Weight::Kind>(text(name));
        if (!kind) refuse(name, name_list<Weight::Kind>());
        bool const takes_exponent = std::ranges::find(code_.keys, "exponent", &Key::name) != code_.keys.end();
        if (*kind != Weight::power) {
            if (takes_exponent && has("exponent")) refuse("exponent", "none; it is of weight power alone");
            return *kind;
        }
        if (!has("exponent"))
            throw InputError(fmt::format("{}: exponent: is missing; weight power needs it", code_.name));
        double const exponent = number("exponent");
        if (exponent > largest_exponent) refuse("exponent", fmt::format("0 to {}", largest_exponent));
        return power_weight(exponent);
    }

    /// The value is one that the code has and dpdref does not, or none at all.
    [[noreturn]] void refuse(std::string_view name, std::string_view allowed) const {
        throw InputError(
            fmt::format("{}: {}: '{}' is not allowed; allowed: {}", code_.name, name, text(name), allowed));
    }

    /// The code's name, for messages.
    std::string_view code() const { return code_.name; }

private:
    Key const& key(std::string_view name) const {
        auto const found = std::ranges::find(code_.keys, name, &Key::name);
        if (found != code_.keys.end()) return *found;
        std::vector<std::string_view> names;
        for (auto const& k : code_.keys) names.push_back(k.name);
        throw InputError(
            fmt::format("{}: {}: unknown key; allowed: {}", code_.name, name, fmt::join(names, ", ")));
    }

    Code const& code_;
    Assignments const& given_;
};

}  // namespace dpd
