#include "until.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "analysis.hpp"
#include "errors.hpp"

namespace dpd {

double ErrorWanted::error() const {
    double const relative = estimate.error / std::abs(estimate.value);
    std::size_t const blocks = estimate.blocks + (estimate.slow_mode ? 1 : 0);
    return blocks < least_blocks || std::isnan(relative) ? std::numeric_limits<double>::infinity() : relative;
}

std::string ErrorWanted::text() const {
    std::string const has =
        std::isfinite(error()) ? fmt::format("{:.2g} %", 100.0 * error()) : "no error yet";
    return fmt::format("{} {} ({:g} % wanted)", quantity, has, 100.0 * wanted);
}

std::vector<ErrorWanted> errors_wanted(Scene const& scene, Record const& record) {
    std::vector<ErrorWanted> errors;
    if (!scene.until) return errors;
    auto const quantities = analyze(scene, {record});
    for (auto const& [name, wanted] : scene.until->errors) {
        Quantity const* const found = find_quantity(quantities, name);
        errors.push_back({name, wanted, found ? found->estimate : Estimate{}});
    }
    return errors;
}

bool is_over(Scene const& scene, std::uint64_t step, Record const& record) {
    if (step >= scene.steps()) return true;
    if (!scene.until || step <= scene.equilibration_steps) return false;
    std::uint64_t const measured = step - scene.equilibration_steps;
    if (measured % scene.production_steps != 0 || !std::has_single_bit(measured / scene.production_steps))
        return false;
    auto const errors = errors_wanted(scene, record);
    return std::all_of(errors.begin(), errors.end(), [](auto const& e) { return e.reached(); });
}

std::uint64_t expected_steps(Scene const& scene, std::uint64_t step, std::vector<ErrorWanted> const& errors) {
    if (!scene.until) return scene.steps();
    double needed = 0.0;
    auto const measured = double(step - std::min(step, scene.equilibration_steps));
    for (auto const& e : errors)
        if (std::isfinite(e.error())) needed = std::max(needed, measured * std::pow(e.error() / e.wanted, 2));
    std::uint64_t end = scene.production_steps;
    while (end < scene.until->longest && (double(end) < needed || double(end) < measured)) end *= 2;
    return scene.equilibration_steps + end;
}

std::string progress_text(std::vector<ErrorWanted> const& errors) {
    auto const worst = std::max_element(errors.begin(), errors.end(), [](auto const& a, auto const& b) {
        return a.error() / a.wanted < b.error() / b.wanted;
    });
    return worst == errors.end() ? "" : worst->text();
}

void check_errors_wanted(Scene const& scene, Record const& empty) {
    if (!scene.until) return;
    Record made_up = empty;
    // which quantities samples give does not depend on their values
    for (auto& [name, values] : made_up.series) {
        values.resize(std::size_t(curve_blocks) * (scene.sample.green_kubo_window + least_blocks));
        for (std::size_t k = 0; k < values.size(); ++k) values[k] = 1.0 + double(k % 2);
    }
    constexpr double enough = 1e30;  // origins in each block, so that none are joined
    for (auto& [name, curve] : made_up.curves) {
        curve.sum.setConstant(enough);
        curve.weight.setConstant(enough);
    }
    std::vector<std::string> names;
    for (auto const& quantity : analyze(scene, {made_up}))
        if (quantity.estimate.blocks >= least_blocks) names.push_back(quantity.name);
    for (auto const& [name, wanted] : scene.until->errors)
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw InputError(
                fmt::format("time.until.{}: is no quantity that this scene measures; allowed: {}", name,
                            names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace dpd
