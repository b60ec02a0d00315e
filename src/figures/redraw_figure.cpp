#include "redraw_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "errors.hpp"
#include "theory/registry.hpp"
#include "theory_arguments.hpp"
#include "write_convergence.hpp"
#include "write_figure.hpp"

namespace dpd {
namespace {

// The point of the definition that a comparison was made at; none for a bin of a measured curve.
Point const* point_of(Figure const& definition, Comparison const& c) {
    for (auto const& point : definition.points)
        if (definition.curves[point.curve].name == c.curve && point.x == c.x) return &point;
    return nullptr;
}

// One criterion at one point, of which `made` are the comparisons before. A closed form is evaluated anew.
std::optional<Comparison> compare_again(Figure const& definition, std::vector<Comparison> const& made,
                                        Criterion const& criterion) {
    auto const of_quantity = [&](Comparison const& c) { return c.criterion.quantity == criterion.quantity; };
    auto before = std::find_if(made.begin(), made.end(), [&](Comparison const& c) {
        return of_quantity(c) && c.criterion.theory == criterion.theory;
    });
    bool const is_new = before == made.end();
    if (is_new && (criterion.theory == "previous" || criterion.quantity.starts_with(exponent_prefix)))
        return {};
    if (is_new) before = std::find_if(made.begin(), made.end(), of_quantity);
    Point const* const point = point_of(definition, made.front());
    bool const closed_form = point != nullptr && theory::find(criterion.theory) != nullptr;
    if (before == made.end() || (is_new && !closed_form))
        throw InputError(fmt::format("figure {}, curve {}: {} against {} needs the runs: `dpdref figure {}`",
                                     definition.id, made.front().curve, criterion.quantity, criterion.theory,
                                     definition.id));
    auto again = *before;
    again.criterion = criterion;
    if (criterion.theory == "value") again.theory = criterion.value;
    if (closed_form) {
        auto const theory = theory_or_nothing(point->runs.front(), criterion.theory);
        if (!theory) return {};
        again.theory = *theory;
        again.theory_error = 0.0;
    }
    return again;
}

}  // namespace

std::vector<Comparison> redraw_figure(Figure const& definition, std::filesystem::path const& output) {
    Written const written = load_written(definition.id, output);
    std::vector<Comparison> comparisons, of_point;
    auto const finish_point = [&] {
        if (of_point.empty()) return;
        auto const curve = std::find_if(definition.curves.begin(), definition.curves.end(),
                                        [&](auto const& one) { return one.name == of_point.front().curve; });
        if (curve != definition.curves.end())
            for (auto const& criterion : curve->criteria)
                if (auto again = compare_again(definition, of_point, criterion))
                    comparisons.push_back(std::move(*again));
        of_point.clear();
    };
    for (auto const& made : written.comparisons) {
        if (!of_point.empty() && (of_point.front().curve != made.curve || of_point.front().x != made.x))
            finish_point();
        of_point.push_back(made);
    }
    finish_point();
    rewrite_figure(definition, comparisons, written, output);
    Figure companion = definition;
    companion.convergence = load_convergence(definition, output);
    draw_convergence(companion, written.budget, output);
    return comparisons;
}

}  // namespace dpd
