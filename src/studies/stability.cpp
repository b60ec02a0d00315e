#include "stability.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "budget.hpp"
#include "errors.hpp"
#include "files.hpp"
#include "integrators.hpp"
#include "names.hpp"
#include "picture.hpp"
#include "processor_time.hpp"
#include "run.hpp"
#include "simulation.hpp"
#include "theory/closed_forms.hpp"
#include "toml_reader.hpp"
#include "version.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;
constexpr double infinity = std::numeric_limits<double>::infinity();

// A mean kinetic temperature beyond so many times the set one makes a step useless.
constexpr double hot_factor = 2.0;

// A search ends long before, unless its range is absurd.
constexpr int most_bisections = 200;

}  // namespace

// --- bisection -------------------------------------------------------------------------------------------

double Edge::step() const { return std::sqrt(below) * std::sqrt(above); }

Edge edge_of(Trials const& trials, Outcome allowed) {
    Edge edge;
    for (auto const& [step, trial] : trials) {
        if (trial.outcome > allowed) {
            edge.above = step;
            break;
        }
        edge.below = step;
    }
    return edge;
}

bool monotonic(Trials const& trials) {
    return std::is_sorted(trials.begin(), trials.end(),
                          [](auto const& a, auto const& b) { return a.second.outcome < b.second.outcome; });
}

// [bisect]
Trials bisect(StepRange const& range, std::function<Trial(double)> const& trial) {
    Trials trials;
    trials.emplace(range.largest, trial(range.largest));
    for (Outcome const allowed : {Outcome::stable, Outcome::hot})
        for (int k = 0; k < most_bisections; ++k) {
            Edge const edge = edge_of(trials, allowed);
            double const below = std::max(edge.below, range.smallest);
            if (!(edge.above < infinity) || edge.above <= below * (1.0 + range.resolution)) break;
            double const middle = std::sqrt(below * edge.above);
            trials.emplace(middle, trial(middle));
        }
    return trials;
}
// [bisect]

// --- limits of one state ---------------------------------------------------------------------------------

namespace {

// The largest eigenvalue of a symmetric matrix, by Lanczos without reorthogonalization: its copies do no
// harm.
double largest_eigenvalue(Eigen::SparseMatrix<double> const& matrix) {
    constexpr Eigen::Index most = 150;
    Eigen::Index const size = std::min(most, matrix.rows());
    Eigen::VectorXd diagonal(size), off(size - 1);
    Eigen::VectorXd before = Eigen::VectorXd::Zero(matrix.rows()), now(matrix.rows());
    for (Eigen::Index k = 0; k < now.size(); ++k) now[k] = std::sin(double(1 + k * k));  // no symmetry
    now.normalize();
    double beta = 0.0;
    Eigen::Index done = 0;
    while (done < size) {
        Eigen::VectorXd next = matrix * now - beta * before;
        diagonal[done] = next.dot(now);
        next -= diagonal[done] * now;
        beta = next.norm();
        if (++done == size || beta == 0.0) break;
        off[done - 1] = beta;
        before = now;
        now = next / beta;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal.head(done), off.head(done - 1), Eigen::EigenvaluesOnly);
    return solver.eigenvalues().maxCoeff();
}

}  // namespace

template <int d>
FrozenLimits frozen_limits(Particles<d> const& particles, Box<d> const& box, double friction, Weight weight,
                           double repulsion) {
    using Block = Eigen::Matrix<double, d, d>;
    std::vector<Eigen::Triplet<double>> rates, hessian;
    auto const add = [](auto& matrix, Eigen::Index i, Eigen::Index j, Block const& block) {
        for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b) {
                double const value = block(a, b);
                matrix.emplace_back(d * i + a, d * i + b, value);
                matrix.emplace_back(d * j + a, d * j + b, value);
                matrix.emplace_back(d * i + a, d * j + b, -value);
                matrix.emplace_back(d * j + a, d * i + b, -value);
            }
    };
    for (Eigen::Index j = 0; j < particles.size(); ++j)
        for (Eigen::Index i = 0; i < j; ++i) {
            Vec<d> separation = (particles.position.row(i) - particles.position.row(j)).transpose();
            separation.array() -= box.length.array() * (separation.array() / box.length.array()).round();
            double const r = separation.norm();
            if (r >= 1.0 || r == 0.0) continue;
            Block const along = separation * separation.transpose() / (r * r);
            Block const across = Block::Identity() - along;
            add(rates, i, j, friction / particles.mass * weight_at(weight, r) * along);
            add(hessian, i, j, repulsion / particles.mass * (along - (1.0 - r) / r * across));
        }
    auto const size = d * particles.size();
    auto const largest = [&](auto const& triplets) {
        Eigen::SparseMatrix<double> matrix(size, size);
        matrix.setFromTriplets(triplets.begin(), triplets.end());
        return largest_eigenvalue(matrix);
    };
    FrozenLimits limits;
    if (friction > 0.0) limits.friction = 2.0 / largest(rates);
    if (repulsion > 0.0) limits.repulsion = 2.0 / std::sqrt(largest(hessian));
    return limits;
}

template FrozenLimits frozen_limits(Particles<2> const&, Box<2> const&, double, Weight, double);
template FrozenLimits frozen_limits(Particles<3> const&, Box<3> const&, double, Weight, double);

// --- trials ----------------------------------------------------------------------------------------------

std::vector<std::uint64_t> trace_steps(std::uint64_t steps) {
    constexpr double ratio = 1.03;
    std::vector<std::uint64_t> kept;
    for (std::uint64_t s = 1; s < steps; s = std::max(s + 1, static_cast<std::uint64_t>(double(s) * ratio)))
        kept.push_back(s);
    if (steps > 0) kept.push_back(steps);
    return kept;
}

std::uint64_t TrialLength::steps(double step) const {
    return static_cast<std::uint64_t>(std::ceil(std::clamp(time / step, double(fewest), double(most))));
}

namespace {

void stop_if(std::atomic<bool> const* stop) {
    if (stop && *stop)
        throw Interrupted("interrupted; finished bisections are kept, run the command again to go on");
}

template <int d>
Particles<d> end_of(Scene const& scene, std::atomic<bool> const* stop) {
    auto simulation = build<d>(scene, {});
    while (simulation.step < scene.steps()) {
        simulation.advance();
        stop_if(stop);
    }
    return simulation.particles;
}

template <int d>
Trial run_trial(Scene const& scene, Particles<d> const& start, std::atomic<bool> const* stop) {
    auto simulation = build<d>(scene, {});
    simulation.particles = start;
    Trial trial;
    trial.step = scene.time_step;
    std::vector<double> series;
    auto const record = [&] { series.push_back(kinetic_temperature(simulation.particles, simulation.box)); };
    try {
        while (simulation.step < scene.steps()) {
            simulation.advance();
            record();
            stop_if(stop);
        }
        std::vector<double> const second_half(series.begin() + std::ptrdiff_t(series.size() / 2),
                                              series.end());
        trial.kT = combine({&second_half, 1});
        if (trial.kT.value > hot_factor * scene.thermostat_kT()) trial.outcome = Outcome::hot;
    } catch (Diverged const&) {
        record();
        trial.outcome = Outcome::diverged;
    }
    trial.steps = series.size();
    for (auto const s : trace_steps(trial.steps)) trial.trace.push_back(series[s - 1]);
    return trial;
}

template <int d>
void find_edges_in(StabilityPoint& point, std::atomic<bool> const* stop) {
    Scene const before = parse_scene(point.start, "start");
    Particles<d> const start = end_of<d>(before, stop);
    point.frozen =
        frozen_limits<d>(start, build<d>(before, {}).box, point.friction, point.weight, point.repulsion);
    point.trials = bisect(point.range, [&](double step) {
        std::uint64_t const steps = point.length.steps(step);
        Scene const scene = parse_scene(
            point.scene, point.integrator,
            {fmt::format("time.step={}", step), fmt::format("time.duration={}", double(steps) * step)});
        return run_trial<d>(scene, start, stop);
    });
}

// --- storage ---------------------------------------------------------------------------------------------

double number_or_nan(Json const& json) {
    return json.is_number() ? json.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

double number_or_infinity(Json const& json) { return json.is_number() ? json.get<double>() : infinity; }

Json to_json(Trials const& trials, bool traces) {
    Json list = Json::array();
    for (auto const& [step, trial] : trials) {
        list.push_back({{"step", step},
                        {"outcome", name_of(trial.outcome)},
                        {"steps", trial.steps},
                        {"kT", trial.kT.value},
                        {"error", trial.kT.error},
                        {"blocks", trial.kT.blocks}});
        if (traces) list.back()["trace"] = trial.trace;
    }
    return list;
}

Trials trials_from_json(Json const& list) {
    Trials trials;
    for (auto const& json : list) {
        Trial trial;
        trial.step = json.at("step");
        auto const outcome = value_of<Outcome>(json.at("outcome").get<std::string>());
        if (!outcome) throw InputError("unknown outcome");
        trial.outcome = *outcome;
        trial.steps = json.at("steps");
        trial.kT.value = number_or_nan(json.at("kT"));
        trial.kT.error = number_or_nan(json.at("error"));
        trial.kT.blocks = json.at("blocks");
        for (auto const& kT : json.at("trace")) trial.trace.push_back(number_or_nan(kT));
        trials.emplace(trial.step, std::move(trial));
    }
    return trials;
}

bool restore(StabilityPoint& point, std::filesystem::path const& file) {
    if (!std::filesystem::exists(file)) return false;
    try {
        Json const json = Json::parse(read_file(file));
        point.trials = trials_from_json(json.at("trials"));
        point.frozen.friction = number_or_infinity(json.at("frozen_friction"));
        point.frozen.repulsion = number_or_infinity(json.at("frozen_repulsion"));
        point.seconds = json.at("seconds");
    } catch (std::exception const& error) {
        throw InputError(fmt::format("{}: {}; allowed: remove it", file.string(), one_line(error.what())));
    }
    return true;
}

void store(StabilityPoint const& point, std::filesystem::path const& file) {
    Json const json{{"engine_revision", engine_revision},
                    {"scene", point.scene},
                    {"start", point.start},
                    {"seconds", point.seconds},
                    {"frozen_friction", point.frozen.friction},
                    {"frozen_repulsion", point.frozen.repulsion},
                    {"trials", to_json(point.trials, true)}};
    write_file(file, json.dump() + "\n");
}

}  // namespace

std::string StabilityPoint::key() const {
    Scene hashed;
    hashed.text =
        fmt::format("stability\n{}\nstart\n{}\nsteps {} {} {}\nlength {} {} {}", scene, start, range.smallest,
                    range.largest, range.resolution, length.time, length.fewest, length.most);
    return hashed.key();
}

void find_edges(StabilityPoint& point, std::atomic<bool> const* stop) {
    double const from = thread_seconds();
    int const d = parse_scene(point.start, "start").dimension;
    d == 2 ? find_edges_in<2>(point, stop) : find_edges_in<3>(point, stop);
    point.seconds = thread_seconds() - from;
}

bool find_edges(std::vector<StabilityMap>& maps, CampaignOptions const& options) {
    std::vector<Task<StabilityPoint>> tasks;
    for (auto const& map : maps)
        for (auto const& point : map.points)
            tasks.push_back(
                {point.key(), 2.0 + point.density, [&point, &options](StabilityPoint& result, Report const&) {
                     auto const file = options.cache / (point.key() + ".json");
                     result = point;
                     if (restore(result, file)) return true;
                     find_edges(result, options.stop);
                     store(result, file);
                     return false;
                 }});
    auto const done = do_once("stability", tasks, options);
    if (!done) return false;
    for (auto& map : maps)
        for (auto& point : map.points) {
            StabilityPoint const& result = done->at(point.key());
            point.trials = result.trials;
            point.frozen = result.frozen;
            point.seconds = result.seconds;
        }
    return true;
}

// --- definition ------------------------------------------------------------------------------------------

namespace {

// The text of a scene at one point of the axes; the step is set by the search.
std::string scene_text(toml::table scene, Integrator const& integrator, double friction, double repulsion,
                       double density, std::uint64_t seed, std::string const& origin) {
    // the stages of a repulsion stay where it is zero: all points of an axis take the same steps
    constexpr double any = 1.0;
    for (auto const& setting : scene_settings(integrator, false, friction, any))
        override_key(scene, setting, origin);
    if (!integrator.repulsion.empty())
        override_key(scene, fmt::format("{}={}", integrator.repulsion, repulsion), origin);
    override_key(scene, fmt::format("seed={}", seed), origin);
    auto const d = scene["dimension"].value_or<std::int64_t>(3);
    double const side = std::pow(scene["particles"]["number"].value_or(0.0) / density, 1.0 / double(d));
    std::vector<double> const sides(std::size_t(d), side);
    override_key(scene, fmt::format("box.length=[{}]", fmt::join(sides, ", ")), origin);
    std::ostringstream text;
    text << scene;
    return text.str();
}

// The run whose end is where all trials of a point start.
struct StartRun {
    Integrator integrator;
    double friction = 0.0, step = 0.0, duration = 0.0;

    toml::table timed(toml::table scene, std::string const& origin) const {
        override_key(scene, fmt::format("time.step={}", step), origin);
        override_key(scene, fmt::format("time.duration={}", duration), origin);
        return scene;
    }
};

StartRun read_start(TomlReader&& table, std::vector<Integrator> const& known) {
    std::vector<std::string_view> names;
    for (auto const& integrator : known) names.push_back(integrator.name);
    auto const name = table.text("integrator", std::nullopt, names);
    StartRun const start{.integrator = *std::ranges::find(known, name, &Integrator::name),
                         .friction = table.number("friction", std::nullopt, positive),
                         .step = table.number("step", std::nullopt, positive),
                         .duration = table.number("duration", std::nullopt, positive)};
    table.finish();
    return start;
}

constexpr std::array<std::string_view, 3> axis_names{"friction", "repulsion", "density"};

}  // namespace

std::vector<StabilityMap> load_stability(std::filesystem::path const& path, std::string const& budget) {
    std::string const file = path.string();
    toml::table const document = parse_toml(read_file(path), file);
    TomlReader root(document, "", file);
    toml::table const& base = root.required_table("scene").raw();
    auto const definitions = find_above(path, "integrators.toml");
    if (!definitions) throw InputError(fmt::format("{}: there is no integrators.toml above it", file));
    auto const known_integrators = read_integrators(*definitions);
    auto const integrators = chosen_integrators(root, known_integrators);
    StartRun const start = read_start(root.required_table("start"), known_integrators);
    auto const weight = read_weight(root, std::nullopt);

    auto const [range, length] = read_budget(root, budget, [](TomlReader& table) {
        StepRange const r{.smallest = table.number("smallest", std::nullopt, positive),
                          .largest = table.number("largest", std::nullopt, positive),
                          .resolution = table.number("resolution", std::nullopt, positive)};
        TrialLength const l{.time = table.number("time", std::nullopt, positive),
                            .fewest = table.integer("fewest", std::nullopt, positive_integer),
                            .most = table.integer("most", std::nullopt, positive_integer)};
        if (!(r.smallest < r.largest)) table.fail("smallest", "is not below largest; allowed: less");
        if (l.fewest > l.most) table.fail("fewest", "is above most; allowed: at most that");
        return std::pair{r, l};
    });

    std::vector<std::string_view> known;
    for (auto const& integrator : integrators) known.push_back(integrator.name);

    std::vector<StabilityMap> maps;
    for (auto& table : root.tables("map")) {
        StabilityMap map;
        map.name = table.text("name", std::nullopt);
        map.curves = table.text("curves", "repulsion", axis_names);
        map.plots = table.texts("plots", std::vector<std::string>{});
        map.traces = table.boolean("traces", false);
        std::uint64_t const seed = table.integer("seed", 1, non_negative_integer);
        double const longer = table.number("longer", 1.0, positive);
        auto const chosen =
            table.texts("integrators", std::vector<std::string>(known.begin(), known.end()), known);
        std::array<std::vector<double>, 3> axes;
        auto quick = table.table("quick");
        for (std::size_t a = 0; a < axes.size(); ++a) {
            std::string const axis(axis_names[a]);
            Allowed const allowed = axis == "density" ? positive : non_negative;
            axes[a] = table.numbers(axis, std::nullopt, allowed);
            if (quick) {
                auto const fewer = quick->numbers(axis, axes[a], allowed);
                if (budget == "quick") axes[a] = fewer;
            }
        }
        if (quick) quick->finish();
        table.finish();
        if (budget == "quick" && !quick) continue;
        TrialLength const lasting{.time = longer * length.time,
                                  .fewest = static_cast<std::uint64_t>(longer * double(length.fewest)),
                                  .most = static_cast<std::uint64_t>(longer * double(length.most))};
        for (auto const& name : chosen) {
            auto const& integrator =
                integrators[std::size_t(std::find(known.begin(), known.end(), name) - known.begin())];
            for (double const density : axes[2])
                for (double const repulsion : axes[1])
                    for (double const friction : axes[0]) {
                        std::string const origin = fmt::format("{}: {}", file, name);
                        StabilityPoint point{
                            .integrator = name,
                            .friction = friction,
                            .repulsion = repulsion,
                            .density = density,
                            .scene = scene_text(base, integrator, friction, repulsion, density, seed, origin),
                            .start = scene_text(start.timed(base, origin), start.integrator, start.friction,
                                                repulsion, density, seed, origin),
                            .range = range,
                            .length = lasting,
                            .weight = weight};
                        if (friction > 0.0)
                            point.range.largest =
                                std::min(range.largest, integrator.largest_friction_step / friction);
                        // both scenes are checked before anything runs
                        parse_scene(point.start, fmt::format("{}: start", file));
                        Scene const scene =
                            parse_scene(point.scene, origin,
                                        {fmt::format("time.step={}", point.range.largest),
                                         fmt::format("time.duration={}", point.range.largest)});
                        double const n = (double(scene.particles) - 2.0) / scene.volume();
                        point.critical_step = friction > 0.0 ? theory::critical_step({.d = scene.dimension,
                                                                                      .n = n,
                                                                                      .m = scene.mass,
                                                                                      .gamma = friction,
                                                                                      .weight = weight})
                                                             : infinity;
                        point.harmonic_limit =
                            repulsion > 0.0
                                ? theory::harmonic_limit(
                                      {.d = scene.dimension, .n = scene.density(), .m = scene.mass},
                                      repulsion)
                                : infinity;
                        map.points.push_back(std::move(point));
                    }
        }
        maps.push_back(std::move(map));
    }
    root.finish();
    if (maps.empty())
        root.fail("map", fmt::format("is missing for budget {}; allowed: tables [[map]]", budget));
    return maps;
}

// --- output ----------------------------------------------------------------------------------------------

namespace {

double on_axis(StabilityPoint const& point, std::string const& axis) {
    return axis == "friction" ? point.friction : axis == "repulsion" ? point.repulsion : point.density;
}

// The largest step tried that is no worse than the edge allows, with a flag where that is the end of the
// range.
std::string edge_text(Edge const& edge, StepRange const& range) {
    if (!(edge.above < infinity)) return fmt::format("{:.6g} 1", range.largest);
    if (edge.below == 0.0) return fmt::format("{:.6g} -1", range.smallest);
    return fmt::format("{:.6g} 0", edge.step());
}

std::string data_of(StabilityMap const& map, std::string const& budget) {
    double seconds = 0.0;
    for (auto const& point : map.points) seconds += point.seconds;
    std::string text = fmt::format(
        "# stability map {}, budget {}; dpdref {}, engine revision {}; run time {:.0f} s\n"
        "# columns: friction, repulsion, density, usable step, flag, bounded step, flag, kT at the largest "
        "usable step, its error, critical step (MY1997 eq. 25), harmonic limit, frozen friction, frozen "
        "repulsion, seconds\n"
        "# flags: 0 an edge, 1 none up to this step, -1 bad down to this step\n\n\n",
        map.name, budget, version, engine_revision, seconds);
    std::vector<std::string> order;
    std::map<std::string, std::string> blocks;
    for (auto const& point : map.points) {
        std::string const name = fmt::format("{}:{:g}", point.integrator, on_axis(point, map.curves));
        if (!blocks.contains(name)) order.push_back(name);
        Edge const usable = edge_of(point.trials, Outcome::stable);
        auto const best = point.trials.find(usable.below);
        Estimate const kT = best == point.trials.end() ? Estimate{NAN, NAN} : best->second.kT;
        blocks[name] +=
            fmt::format("{:g} {:g} {:g} {} {} {:.6g} {:.3g} {:.6g} {:.6g} {:.6g} {:.6g} {:.2f}\n",
                        point.friction, point.repulsion, point.density, edge_text(usable, point.range),
                        edge_text(edge_of(point.trials, Outcome::hot), point.range), kT.value, kT.error,
                        point.critical_step, point.harmonic_limit, point.frozen.friction,
                        point.frozen.repulsion, point.seconds);
    }
    for (auto const& name : order) text += fmt::format("# {}\n{}\n\n", name, blocks[name]);
    if (!map.traces) return text;
    for (auto const& point : map.points) {
        Edge const usable = edge_of(point.trials, Outcome::stable),
                   bounded = edge_of(point.trials, Outcome::hot);
        for (auto const& [what, step] :
             {std::pair{"below", usable.below}, {"hot", usable.above}, {"diverged", bounded.above}}) {
            auto const trial = point.trials.find(step);
            if (trial == point.trials.end()) continue;
            text += fmt::format("# {}:{:g}:{} step {:.4g}\n", point.integrator, on_axis(point, map.curves),
                                what, step);
            auto const at = trace_steps(trial->second.steps);
            for (std::size_t k = 0; k < at.size(); ++k)
                text += fmt::format("{} {:.6g}\n", at[k], trial->second.trace[k]);
            text += "\n\n";
        }
    }
    return text;
}

Json json_of(StabilityMap const& map, std::string const& budget) {
    auto const edge = [](Edge const& e) { return Json{{"below", e.below}, {"above", e.above}}; };
    Json json{{"map", map.name}, {"budget", budget}, {"engine_revision", engine_revision}};
    for (auto const& point : map.points)
        json["points"].push_back({{"integrator", point.integrator},
                                  {"friction", point.friction},
                                  {"repulsion", point.repulsion},
                                  {"density", point.density},
                                  {"usable", edge(edge_of(point.trials, Outcome::stable))},
                                  {"bounded", edge(edge_of(point.trials, Outcome::hot))},
                                  {"largest_tried", point.range.largest},
                                  {"critical_step", point.critical_step},
                                  {"harmonic_limit", point.harmonic_limit},
                                  {"frozen_friction", point.frozen.friction},
                                  {"frozen_repulsion", point.frozen.repulsion},
                                  {"monotonic", monotonic(point.trials)},
                                  {"seconds", point.seconds},
                                  {"trials", to_json(point.trials, false)}});
    return json;
}

}  // namespace

void write_stability(std::vector<StabilityMap> const& maps, std::string const& budget,
                     std::filesystem::path const& directory, std::filesystem::path const& output) {
    std::filesystem::create_directories(output / "data");
    for (auto const& map : maps) {
        write_file(output / "data" / (map.name + ".dat"), data_of(map, budget));
        write_file(output / "data" / (map.name + ".json"), json_of(map, budget).dump(1) + "\n");
    }
    draw_stability(maps, directory, output);
}

void draw_stability(std::vector<StabilityMap> const& maps, std::filesystem::path const& directory,
                    std::filesystem::path const& output) {
    for (auto const& map : maps)
        if (auto const data = output / "data" / (map.name + ".dat"); !std::filesystem::exists(data))
            throw InputError(fmt::format("{}: there is none; `dpdref stability` makes it", data.string()));
    for (auto const& map : maps)
        for (auto const& plot : map.plots)
            draw(output / plot, directory / (plot + ".gp"),
                 fmt::format("data = {}\nscripts = {}\n", quoted_path(output / "data"),
                             quoted_path(directory)),
                 800, 900);
}

}  // namespace dpd
