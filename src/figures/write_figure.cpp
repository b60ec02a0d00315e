#include "write_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "comparison_json.hpp"
#include "errors.hpp"
#include "figure_text.hpp"
#include "files.hpp"
#include "judge_figure.hpp"
#include "picture.hpp"
#include "progress.hpp"
#include "theory/registry.hpp"
#include "theory_arguments.hpp"
#include "toml_reader.hpp"
#include "version.hpp"
#include "write_convergence.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

// Closed forms along each curve, for the lines of the plot.
std::string theory_lines(Figure const& figure, std::vector<Comparison> const& comparisons) {
    constexpr int samples = 100;
    constexpr double logarithmic_from = 8.0;  // ratio of the ends
    std::string text;
    for (std::size_t c = 0; c < figure.curves.size(); ++c) {
        auto const& curve = figure.curves[c];
        Scene const* base = nullptr;
        double low = INFINITY, high = -INFINITY;
        for (auto const& point : figure.points) {
            if (point.curve != c) continue;
            base = &point.runs.front();
            low = std::min(low, point.x);
            high = std::max(high, point.x);
        }
        if (!curve.line.empty()) low = curve.line[0], high = curve.line[1];
        if (!base || !(low < high)) continue;
        bool const logarithmic = low > 0.0 && high / low > logarithmic_from;
        std::vector<double> sampled;
        for (int s = 0; s <= samples; ++s) {
            double const t = double(s) / samples;
            sampled.push_back(logarithmic ? low * std::pow(high / low, t) : low + (high - low) * t);
        }
        for (auto const& criterion : curve.criteria) {
            auto const* const form = theory::find(criterion.theory);
            if (form == nullptr || !curve.record.empty()) continue;
            text += fmt::format("# {}\n", part_name(curve.name, criterion));
            // what is costly has been evaluated for the points, and is not elsewhere
            if (form->costly)
                for (auto const& made : comparisons) {
                    if (made.curve == curve.name &&
                        part_name(made.curve, made.criterion) == part_name(made.curve, criterion))
                        text += fmt::format("{:.10g} {:.10g}\n", made.x, made.theory);
                }
            else
                for (double const x : sampled) {
                    Scene const scene =
                        parse_scene(base->text, "theory line", {fmt::format("{}={}", curve.parameter, x)});
                    text += fmt::format("{:.10g} {:.10g}\n", x, theory_for(scene, criterion.theory));
                }
            text += "\n\n";
        }
    }
    return text;
}

// The comparisons, one part of the file per curve and criterion.
std::string compared(std::vector<Comparison> const& comparisons) {
    std::map<std::string, std::string> blocks;
    std::vector<std::string> order;
    std::size_t const family = family_of(comparisons);
    for (auto const& c : comparisons) {
        std::string const name = part_name(c.curve, c.criterion);
        if (!blocks.contains(name)) order.push_back(name);
        double const scale = c.theory != 0.0 ? 1.0 / c.theory : 1.0;
        blocks[name] +=
            fmt::format("{:.10g} {:.10g} {:.4g} {:.10g} {:.6g} {:.4g} {} {} {:.1f}\n", c.x, c.estimate.value,
                        c.estimate.error, c.theory, (c.estimate.value - c.theory) * scale,
                        std::hypot(c.estimate.error, c.theory_error) * std::abs(scale), c.estimate.blocks,
                        name_of(judge(c, family)), c.seconds);
    }
    std::string text;
    for (auto const& name : order) text += fmt::format("# {}\n{}\n\n", name, blocks[name]);
    return text;
}

// Everything measured, compared or not: x, value, standard error.
std::string all_quantities(Figure const& figure) {
    std::string text;
    for (std::size_t c = 0; c < figure.curves.size(); ++c) {
        std::map<std::string, std::string> of_curve;
        for (auto const& point : figure.points)
            if (point.curve == c)
                for (auto const& [quantity, estimate] : point.quantities)
                    of_curve[quantity] +=
                        fmt::format("{:.10g} {:.10g} {:.4g}\n", point.x, estimate.value, estimate.error);
        for (auto const& [quantity, rows] : of_curve)
            text += fmt::format("# all:{}:{}\n{}\n\n", figure.curves[c].name, quantity, rows);
    }
    return text;
}

// The positions of the points that keep them.
std::string configurations(Figure const& figure) {
    std::string text;
    for (auto const& point : figure.points) {
        if (point.configuration.size() == 0) continue;
        std::string rows = "# box";
        for (double const side : point.runs.front().length) rows += fmt::format(" {:.6g}", side);
        for (Eigen::Index p = 0; p < point.configuration.rows(); ++p) {
            rows += '\n';
            for (double const x : point.configuration.row(p)) rows += fmt::format("{:.4f} ", x);
        }
        text +=
            fmt::format("# configuration:{}:{:g}\n{}\n\n\n", figure.curves[point.curve].name, point.x, rows);
    }
    return text;
}

constexpr std::string_view measured_begins = "# all:";  // in the data file, after what is compared

}  // namespace

void rewrite_figure(Figure const& figure, std::vector<Comparison> const& comparisons, Written const& written,
                    std::filesystem::path const& output) {
    std::filesystem::create_directories(output / "data");
    auto const data = output / "data" / (figure.id + ".dat");
    auto const lines = output / "data" / (figure.id + ".theory.dat");
    std::string const head = fmt::format(
        "# {} figure {}, budget {}; dpdref {}, engine revision {}; run time {:.0f} s\n"
        "# columns: x, value, standard error, theory, relative deviation, its error, blocks, verdict, "
        "seconds\n\n\n",
        figure.paper, figure.number, written.budget, version, written.engine_revision, written.seconds);
    write_file(data, head + compared(comparisons) + written.measured);
    write_file(lines, theory_lines(figure, comparisons));

    Json json{{"figure", figure.id},
              {"paper", figure.paper},
              {"number", figure.number},
              {"budget", written.budget},
              {"engine_revision", written.engine_revision},
              {"seconds", written.seconds}};
    for (auto const& c : comparisons) json["comparisons"].push_back(to_json(c));
    write_file(output / "data" / (figure.id + ".json"), json.dump(1) + "\n");

    std::string const caption = fmt::format("{}. {} Run time {} ({} budget).", source_of(figure),
                                            figure.caption, duration_text(written.seconds), written.budget);
    std::string const definitions = fmt::format(
        "title_text = {}\ndata = {}\nlines = {}\ncaption = {}\ndirectory = {}\n", quoted(figure.title),
        quoted_path(data), quoted_path(lines), quoted(wrapped(caption)), quoted_path(figure.directory));
    draw(output / figure.id, figure.directory / "plot.gp", definitions);
    for (auto const& page : std::filesystem::directory_iterator(figure.directory)) {
        auto const& plot = page.path();
        if (plot.extension() == ".gp" && plot.stem() != "plot")
            draw(output / (figure.id + "-" + plot.stem().string()), plot, definitions);
    }
}

void write_figure(Figure const& figure, std::vector<Comparison> const& comparisons, std::string const& budget,
                  std::filesystem::path const& output) {
    rewrite_figure(figure, comparisons,
                   {.budget = budget,
                    .engine_revision = engine_revision,
                    .seconds = figure.seconds,
                    .measured = all_quantities(figure) + configurations(figure)},
                   output);
    write_convergence(figure, budget, output);
}

Written load_written(std::string const& id, std::filesystem::path const& output) {
    auto const file = output / "data" / (id + ".json"), data = output / "data" / (id + ".dat");
    for (auto const& needed : {file, data})
        if (!std::filesystem::exists(needed))
            throw InputError(
                fmt::format("{}: there is none; `dpdref figure {}` makes it", needed.string(), id));
    try {
        Json const content = Json::parse(read_file(file));
        Written written{.budget = content.at("budget"),
                        .engine_revision = content.at("engine_revision"),
                        .seconds = content.at("seconds")};
        for (auto const& json : content.at("comparisons"))
            written.comparisons.push_back(comparison_from_json(json));
        std::string const text = read_file(data);
        if (auto const begin = text.find(measured_begins); begin != std::string::npos)
            written.measured = text.substr(begin);
        return written;
    } catch (Json::exception const& error) {
        throw InputError(fmt::format("{}: {}", file.string(), error.what()));
    }
}

std::vector<Comparison> load_comparisons(std::filesystem::path const& output) {
    std::vector<Comparison> comparisons;
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (auto const& entry : std::filesystem::directory_iterator(output / "data", ignored))
        if (entry.path().extension() == ".json" && entry.path().stem() != "report")
            files.push_back(entry.path());
    // as `figure all` orders them
    std::sort(files.begin(), files.end(), [](auto const& a, auto const& b) { return a.stem() < b.stem(); });
    for (auto const& file : files) {
        try {
            Json const content = Json::parse(read_file(file));
            for (auto const& json : content.at("comparisons"))
                comparisons.push_back(comparison_from_json(json));
        } catch (Json::exception const& error) {
            throw InputError(fmt::format("{}: {}", file.string(), error.what()));
        }
    }
    return comparisons;
}

}  // namespace dpd
