#include "judge_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "errors.hpp"
#include "run_figure.hpp"
#include "theory_arguments.hpp"

namespace dpd {

namespace {

// A quantity of point p. An exponent is the slope in logarithms from the point before.
std::optional<Estimate> estimate_at(Figure const& figure, std::size_t p, std::string_view name) {
    auto const& point = figure.points[p];
    bool const exponent = name.starts_with(exponent_prefix);
    if (exponent) name.remove_prefix(exponent_prefix.size());
    Quantity const* const quantity = find_quantity(point.quantities, name);
    if (!quantity) return {};
    if (!exponent) return quantity->estimate;
    auto const before = estimate_at(figure, p - 1, name);
    if (!before) return {};
    Estimate const& here = quantity->estimate;
    double const span = std::log(point.x / figure.points[p - 1].x);
    return Estimate{
        .value = std::log(here.value / before->value) / span,
        .error = std::hypot(here.error / here.value, before->error / before->value) / std::abs(span),
        .blocks = std::min(here.blocks, before->blocks)};
}

}  // namespace

std::optional<Comparison> compare_point(Figure const& figure, std::size_t p, Criterion const& criterion) {
    auto const& point = figure.points[p];
    auto const& curve = figure.curves[point.curve];
    bool const first = p == 0 || figure.points[p - 1].curve != point.curve;
    if (first && (criterion.theory == "previous" || criterion.quantity.starts_with(exponent_prefix)))
        return {};
    auto const estimate = estimate_at(figure, p, criterion.quantity);
    if (!estimate)
        throw InputError(fmt::format("figure {}, curve {}: its scene does not measure {}", figure.id,
                                     curve.name, criterion.quantity));
    Comparison comparison{.figure = figure.id, .curve = curve.name, .parameter = curve.parameter};
    comparison.x = point.x;
    comparison.criterion = criterion;
    comparison.estimate = *estimate;
    comparison.runs = point.runs.size();
    comparison.seconds = point.seconds;
    if (criterion.theory == "previous") {
        auto const previous = *estimate_at(figure, p - 1, criterion.quantity);
        comparison.theory = previous.value;
        comparison.theory_error = previous.error;
    } else if (criterion.theory == "value") {
        comparison.theory = criterion.value;
    } else if (criterion.theory.starts_with("curve:")) {
        auto const others = points_of(criterion.theory.substr(6), figure.curves, figure.points, point.x);
        Quantity const* const reference =
            others.empty() ? nullptr : find_quantity(others.front()->quantities, criterion.quantity);
        if (!reference)
            throw InputError(fmt::format("figure {}, curve {}: {} has no {} at {}", figure.id, curve.name,
                                         criterion.theory, criterion.quantity, point.x));
        comparison.theory = reference->estimate.value;
        comparison.theory_error = reference->estimate.error;
    } else if (criterion.theory.starts_with("quantity:")) {
        Quantity const* const reference =
            find_quantity(point.quantities, std::string_view(criterion.theory).substr(9));
        if (!reference)
            throw InputError(fmt::format("figure {}, curve {}: no {} at {}", figure.id, curve.name,
                                         criterion.theory, point.x));
        comparison.theory = reference->estimate.value;
        comparison.theory_error = reference->estimate.error;
    } else {
        auto const theory = theory_or_nothing(point.runs.front(), criterion.theory);
        if (!theory) return {};
        comparison.theory = *theory;
    }
    return comparison;
}

std::vector<Comparison> compare(Figure const& figure) {
    std::vector<Comparison> comparisons;
    for (std::size_t p = 0; p < figure.points.size(); ++p)
        for (auto const& criterion : figure.curves[figure.points[p].curve].criteria)
            if (auto comparison = compare_point(figure, p, criterion))
                comparisons.push_back(std::move(*comparison));
    return comparisons;
}

namespace {

// The measured value with the error of its difference from the theory (a measured reference has an error
// too).
Estimate against_theory(Comparison const& comparison) {
    Estimate estimate = comparison.estimate;
    estimate.error = std::hypot(estimate.error, comparison.theory_error);
    return estimate;
}

// How far the value lies on the allowed side of a bound, in units of the confidence interval's half width.
double clearance(Comparison const& comparison, double false_alarm) {
    Estimate const estimate = against_theory(comparison);
    double const side = comparison.criterion.relation == Relation::at_least ? 1.0 : -1.0;
    return side * (estimate.value - comparison.theory) /
           (critical_z(false_alarm, estimate.blocks) * estimate.error);
}

double false_alarm_of_one(std::size_t family) {
    return family_false_alarm / double(std::max<std::size_t>(1, family));
}

}  // namespace

std::size_t family_of(std::vector<Comparison> const& comparisons) {
    return static_cast<std::size_t>(std::count_if(comparisons.begin(), comparisons.end(),
                                                  [](auto const& c) { return !c.criterion.description; }));
}

Verdict judge(Comparison const& comparison, std::size_t family) {
    auto const& criterion = comparison.criterion;
    double const false_alarm = false_alarm_of_one(family);
    if (criterion.relation == Relation::differs) {
        Verdict const same =
            judge(against_theory(comparison), comparison.theory, criterion.tolerance, 0.0, false_alarm);
        return same == Verdict::disagrees ? Verdict::agrees
               : same == Verdict::agrees  ? Verdict::disagrees
                                          : Verdict::undecided;
    }
    if (criterion.relation != Relation::equal) {
        double const clear = clearance(comparison, false_alarm);
        if (clear > 1.0) return Verdict::agrees;
        // near the bound, or on the wrong side within the error, the sharpness decides as for an equality
        if (clear >= 0.0 &&
            against_theory(comparison).error <= criterion.resolution * std::abs(comparison.theory))
            return Verdict::agrees;
    }
    return judge(against_theory(comparison), comparison.theory, criterion.tolerance, criterion.resolution,
                 false_alarm);
}

double noticeable(Comparison const& comparison, std::size_t family) {
    if (comparison.theory == 0.0) return std::numeric_limits<double>::infinity();
    auto const& criterion = comparison.criterion;
    Estimate const estimate = against_theory(comparison);
    double const half_width = critical_z(false_alarm_of_one(family), estimate.blocks) * estimate.error;
    double const tolerance = criterion.relation == Relation::differs ? 0.0 : criterion.tolerance;
    return tolerance + half_width / std::abs(comparison.theory);
}

Kind kind_of(Comparison const& comparison, std::size_t family) {
    auto const& criterion = comparison.criterion;
    bool const too_blunt = comparison.theory != 0.0 && !(noticeable(comparison, family) <= blunt);
    if (criterion.description || too_blunt) return Kind::description;
    if (criterion.relation != Relation::equal) return Kind::bound;
    bool const measured = criterion.theory == "previous" || criterion.theory.starts_with("curve:") ||
                          criterion.theory.starts_with("quantity:");
    if (measured) return Kind::consistency;
    return criterion.tolerance > 0.0 ? Kind::closed_form : Kind::exact;
}

std::string_view verdict_text(Verdict verdict, Kind kind) {
    return kind == Kind::description && verdict == Verdict::agrees ? "described" : name_of(verdict);
}

double seconds_to_decide(Comparison const& comparison, std::size_t family) {
    auto const& criterion = comparison.criterion;
    double const false_alarm = false_alarm_of_one(family);
    if (judge(comparison, family) != Verdict::undecided) return 0.0;
    double factor = time_factor_to_decide(
        against_theory(comparison), comparison.theory, criterion.tolerance,
        criterion.relation == Relation::differs ? 0.0 : criterion.resolution, false_alarm);
    // a bound is also decided once the value clears it
    if (criterion.relation == Relation::at_most || criterion.relation == Relation::at_least)
        factor = std::min(factor, std::pow(clearance(comparison, false_alarm), -2));
    return comparison.seconds * (factor - 1.0);
}

}  // namespace dpd
