#include "write_convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "figure_text.hpp"
#include "files.hpp"
#include "picture.hpp"
#include "version.hpp"

namespace dpd {
namespace {

constexpr std::size_t most_shown = 7;  // colours that stay distinct

// The curves of the companion picture, the most telling ones first.
std::vector<Convergence const*> shown_of(std::vector<Convergence> const& convergence) {
    auto const checks = [](Convergence const* c) {
        return c->criterion.quantity.find("temperature") != std::string::npos;
    };
    // one criterion per curve; a temperature, which most curves check, only where there is nothing else
    std::vector<Convergence const*> shown;
    for (auto const& c : convergence) {
        if (c.states.empty()) continue;
        if (shown.empty() || shown.back()->curve != c.curve)
            shown.push_back(&c);
        else if (checks(shown.back()) && !checks(&c))
            shown.back() = &c;
    }
    std::stable_partition(shown.begin(), shown.end(), [&](auto const* c) { return !checks(c); });
    if (shown.size() > most_shown) shown.resize(most_shown);
    return shown;
}

// What a curve of the companion picture is, in words.
std::string legend(FigureCurve const& curve, Convergence const& c) {
    std::string const& theory = c.criterion.theory;
    std::string text = fmt::format(
        "{}: {} against {}", curve.name, c.criterion.quantity,
        theory == "value" ? fmt::format("{:g}", c.criterion.value) : theory.substr(theory.find(':') + 1));
    std::replace(text.begin(), text.end(), '_', ' ');
    if (c.floor_resolved)
        text += fmt::format(", floor {:.3g} ± {:.2g} %", 100.0 * c.floor, 100.0 * c.floor_error);
    return text;
}

}  // namespace

void write_convergence(Figure const& figure, std::string const& budget, std::filesystem::path const& output) {
    auto const shown = shown_of(figure.convergence);
    if (shown.empty()) return;
    std::string const name = figure.id + ".convergence";
    auto const data = output / "data" / (name + ".dat");
    std::string text = fmt::format(
        "# {} figure {}, budget {}; dpdref {}, engine revision {}\n"
        "# columns: seconds, rms relative error, rms relative deviation, points; of a floor: seconds, floor, "
        "its standard error, resolved\n\n\n",
        figure.paper, figure.number, budget, version, engine_revision);
    for (auto const& c : figure.convergence) {
        if (c.states.empty()) continue;
        std::string const part = part_name(figure.curves[c.curve].name, c.criterion);
        text += fmt::format("# {}\n", part);
        for (auto const& state : c.states)
            text += fmt::format("{:.6g} {:.4g} {:.4g} {}\n", state.seconds, state.error, state.deviation,
                                state.points);
        text += fmt::format("\n\n# floor:{}\n{:.6g} {:.4g} {:.2g} {:d}\n\n\n", part, c.states.back().seconds,
                            c.floor, c.floor_error, c.floor_resolved);
    }
    write_file(data, text);
    auto const plot = find_above(figure.directory, "convergence.gp");
    if (!plot) return;

    std::vector<std::string> parts, titles;
    double least = INFINITY, first = INFINITY, last = 0.0;  // smallest error; range of the run time
    for (Convergence const* const c : shown) {
        auto const& curve = figure.curves[c->curve];
        parts.push_back(quoted(part_name(curve.name, c->criterion)));
        titles.push_back(quoted(legend(curve, *c)));
        first = std::min(first, c->states.front().seconds);
        last = std::max(last, c->states.back().seconds);
        for (auto const& state : c->states)
            if (state.error > 0.0) least = std::min(least, state.error);
    }
    std::string const caption = fmt::format(
        "{}: error against run time ({} budget). Symbols: root mean square, over a curve's "
        "points, of the relative deviation from the theory; dashed: of the relative standard error; "
        "grey: falling as the inverse root of the run time. Bars at the right: floor, the part of the "
        "deviation that the error does not explain. Of each curve the first criterion, of a temperature "
        "only where there is no other; at most {}; all are in the data.",
        source_of(figure), budget, most_shown);
    draw(output / name, *plot,
         fmt::format("title_text = {}\ndata = {}\ncaption = {}\ncurves = {}\narray part[curves] = [{}]\n"
                     "array legend[curves] = [{}]\nleast = {:g}\nfirst = {:g}\nlast = {:g}\n",
                     quoted(figure.title), quoted_path(data), quoted(wrapped(caption)), shown.size(),
                     fmt::join(parts, ", "), fmt::join(titles, ", "), least, first, last));
}

}  // namespace dpd
