#include "write_convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <cctype>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "figure_text.hpp"
#include "files.hpp"
#include "picture.hpp"
#include "theory/registry.hpp"
#include "version.hpp"

namespace dpd {
namespace {

constexpr std::size_t most_shown = 7;                  // colours that stay distinct
constexpr std::string_view floor_begins = "# floor:";  // in the data file

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

// What something is held against, in words.
std::string reference_text(Criterion const& criterion) {
    if (criterion.theory == "value") return fmt::format("{:g}", criterion.value);
    auto const* const form = theory::find(criterion.theory);
    if (form == nullptr) return criterion.theory.substr(criterion.theory.find(':') + 1);
    if (form->paper == "ours") return "dpdref's own theory";
    bool const numbered = std::isdigit(static_cast<unsigned char>(form->equation.front())) != 0;
    return fmt::format("{}{} {}", form->paper, numbered ? " eq." : ",", form->equation);
}

// What a curve of the companion picture is, in words.
std::string legend(FigureCurve const& curve, Convergence const& c) {
    std::string quantity = c.criterion.quantity;
    boost::replace_first(quantity, exponent_prefix, "exponent of ");
    boost::replace_all(quantity, "_", " ");
    for (auto const& [plain, name] : {std::pair{"schmidt", "Schmidt"},
                                      {"poiseuille", "Poiseuille"},
                                      {"navier stokes", "Navier-Stokes"},
                                      {"green kubo", "Green-Kubo"}})
        boost::replace_first(quantity, plain, name);
    std::string text = fmt::format("{}: {} against {}", curve.name, quantity,
                                   boost::replace_all_copy(reference_text(c.criterion), "_", " "));
    if (c.floor_resolved) {
        // two digits of the error
        double const floor = 100.0 * c.floor, error = 100.0 * c.floor_error;
        int const digits = error > 0.0 ? std::max(0, 1 - int(std::floor(std::log10(error)))) : 2;
        text += fmt::format(", floor {:.{}f} ± {:.{}f} %", floor, digits, error, digits);
    }
    return text;
}

std::filesystem::path data_file(Figure const& figure, std::filesystem::path const& output) {
    return output / "data" / (figure.id + ".convergence.dat");
}

}  // namespace

void write_convergence(Figure const& figure, std::string const& budget, std::filesystem::path const& output) {
    if (shown_of(figure.convergence).empty()) return;
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
        text += fmt::format("\n\n{}{}\n{:.6g} {:.4g} {:.2g} {:d}\n\n\n", floor_begins, part,
                            c.states.back().seconds, c.floor, c.floor_error, c.floor_resolved);
    }
    write_file(data_file(figure, output), text);
    draw_convergence(figure, budget, output);
}

std::vector<Convergence> load_convergence(Figure const& figure, std::filesystem::path const& output) {
    std::vector<Convergence> convergence;
    auto const file = data_file(figure, output);
    if (!std::filesystem::exists(file)) return convergence;
    std::map<std::string, std::pair<std::size_t, Criterion>> known;  // by the names of their parts
    for (std::size_t c = 0; c < figure.curves.size(); ++c)
        for (auto const& criterion : figure.curves[c].criteria)
            known[part_name(figure.curves[c].name, criterion)] = {c, criterion};
    std::istringstream lines(read_file(file));
    std::string line;
    bool of_floor = false, wanted = false;
    while (std::getline(lines, line)) {
        if (line.starts_with("# ")) {
            of_floor = line.starts_with(floor_begins);
            if (of_floor) continue;
            auto const part = known.find(line.substr(2));
            wanted = part != known.end();
            if (wanted)
                convergence.push_back(
                    {.curve = part->second.first, .criterion = part->second.second, .states = {}});
        } else if (std::istringstream numbers(line); wanted && of_floor) {
            auto& c = convergence.back();
            numbers >> line >> c.floor >> c.floor_error >> c.floor_resolved;
        } else if (Convergence::State state;
                   wanted && numbers >> state.seconds >> state.error >> state.deviation >> state.points) {
            convergence.back().states.push_back(state);
        }
    }
    return convergence;
}

void draw_convergence(Figure const& figure, std::string const& budget, std::filesystem::path const& output) {
    auto const shown = shown_of(figure.convergence);
    auto const plot = find_above(figure.directory, "convergence.gp");
    if (shown.empty() || !plot) return;

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
    draw(output / (figure.id + ".convergence"), *plot,
         fmt::format("title_text = {}\ndata = {}\ncaption = {}\ncurves = {}\narray part[curves] = [{}]\n"
                     "array legend[curves] = [{}]\nleast = {:g}\nfirst = {:g}\nlast = {:g}\n",
                     quoted(figure.title), quoted_path(data_file(figure, output)), quoted(wrapped(caption)),
                     shown.size(), fmt::join(parts, ", "), fmt::join(titles, ", "), least, first, last));
}

}  // namespace dpd
