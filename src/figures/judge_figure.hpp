/// @file
/// Comparing what a figure's points measured with its criteria, and the verdicts.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "figure.hpp"
#include "statistics.hpp"

namespace dpd {

/// Compares every point of a figure with its criteria. InputError for a quantity that was not measured.
std::vector<Comparison> compare(Figure const& figure);

/// Point p against one criterion, as `compare` does; nothing where it needs a point before and there is none.
std::optional<Comparison> compare_point(Figure const& figure, std::size_t p, Criterion const& criterion);

/// Probability that any comparison of a report disagrees by chance although all are true.
inline constexpr double family_false_alarm = 0.01;

/// How many comparisons share that: all but descriptions, which were set after looking and never agree.
std::size_t family_of(std::vector<Comparison> const& comparisons);

/// Verdict of one among `family` comparisons.
Verdict judge(Comparison const& comparison, std::size_t family);

/// What a comparison can say.
enum class Kind {
    exact,        ///< no tolerance but the error
    closed_form,  ///< within a tolerance that was stated beforehand
    bound,        ///< the theory is a limit on one side: a value beyond it disagrees, however near; or two
                  ///< values that must differ
    consistency,  ///< two simulations
    description,  ///< the tolerance was set after looking, or a deviation below `blunt` would not be noticed
};

constexpr std::string_view name_of(Kind kind) {
    switch (kind) {
        case Kind::exact:
            return "exact";
        case Kind::closed_form:
            return "closed form";
        case Kind::bound:
            return "bound";
        case Kind::consistency:
            return "consistency";
        case Kind::description:
            return "description";
    }
    return {};
}

/// A comparison that would notice nothing below this relative deviation describes, and is not called
/// agreement.
inline constexpr double blunt = 0.25;

Kind kind_of(Comparison const& comparison, std::size_t family);

/// The smallest deviation that would have been noticed, relative to the theory: tolerance and critical t
/// times the standard error. From a bound it is counted towards the wrong side. Infinity where the theory is
/// zero.
double noticeable(Comparison const& comparison, std::size_t family);

/// The verdict in words: "described" where a description does not disagree and is decided.
std::string_view verdict_text(Verdict verdict, Kind kind);

/// Seconds more that would decide an undecided comparison.
double seconds_to_decide(Comparison const& comparison, std::size_t family);

}  // namespace dpd
