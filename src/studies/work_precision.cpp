#include "work_precision.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "budget.hpp"
#include "files.hpp"
#include "integrators.hpp"
#include "picture.hpp"
#include "processor_time.hpp"
#include "progress.hpp"
#include "run.hpp"
#include "toml_reader.hpp"
#include "version.hpp"

namespace dpd {
namespace {

void append(std::vector<std::string>& to, std::vector<std::string> const& more) {
    to.insert(to.end(), more.begin(), more.end());
}

struct Measurement {
    std::vector<std::string> settings;
    double interval = 0.0, radial_interval = 0.0;  // time between samples
};

}  // namespace

std::vector<Observable> const& study_observables() {
    static std::vector<Observable> const observables{
        {"kinetic_temperature", "kinetic temperature", false, 1.0},
        {"configurational_temperature", "configurational temperature", false, 1.0},
        {"pressure", "pressure", false, {}},
        {"potential_energy", "potential energy", false, {}},
        {"g(r)", "radial distribution g(r)", false, {}},
        {"diffusion_constant", "diffusion constant", false, {}},
        {"viscosity", "viscosity", true, {}}};
    return observables;
}

std::vector<Study> load_studies(std::filesystem::path const& directory, std::string const& budget) {
    auto const file = directory / "study.toml";
    toml::table const document = parse_toml(read_file(file), file.string());
    TomlReader root(document, "", file.string());
    std::string const title = root.text("title", std::nullopt);
    std::ostringstream scene_text;
    scene_text << root.required_table("scene").raw();

    std::map<bool, Measurement> measurements;
    for (bool const sheared : {false, true}) {
        auto table = root.required_table(sheared ? "sheared" : "at_rest");
        Measurement& m = measurements[sheared];
        m.interval = table.number("sample_interval", std::nullopt, positive);
        if (!sheared)
            m.radial_interval = table.number("radial_distribution_interval", std::nullopt, positive);
        m.settings = settings_of(table, "settings");
        table.finish();
    }
    struct Effort {
        double duration_scale = 1.0, smallest_step = 0.0;
    };
    auto const effort = read_budget(root, budget, [](TomlReader& table) {
        return Effort{.duration_scale = table.number("duration_scale", 1.0, positive),
                      .smallest_step = table.number("smallest_step", 0.0, non_negative)};
    });
    auto const definitions = find_above(file, "integrators.toml");
    if (!definitions)
        throw InputError(fmt::format("{}: there is no integrators.toml there or above", directory.string()));
    auto const integrators = chosen_integrators(root, read_integrators(*definitions));

    std::vector<Study> studies;
    for (auto& fluid : root.tables("fluid")) {
        Study study;
        study.name = fluid.text("name", std::nullopt);
        study.title = fmt::format("{}: {}", title, fluid.text("title", std::nullopt));
        double const friction = fluid.number("friction", std::nullopt, non_negative),
                     repulsion = fluid.number("repulsion", std::nullopt, non_negative);
        auto steps = fluid.numbers("steps", std::nullopt, positive);
        auto const reference_steps = fluid.numbers("reference_steps", std::nullopt, positive);
        std::string const reference = fluid.text("reference", std::nullopt);
        double const duration = fluid.number("duration", std::nullopt, positive),
                     reference_duration = fluid.number("reference_duration", std::nullopt, positive);
        study.table_step = fluid.number("table_step", std::nullopt, positive);
        std::erase_if(steps, [&effort](double step) { return step < effort.smallest_step; });
        if (std::find(steps.begin(), steps.end(), study.table_step) == steps.end())
            fluid.fail("table_step", "is none of the budget's steps; allowed: one of them");
        fluid.finish();
        auto const add = [&](Integrator const& integrator, double step, bool is_reference, bool sheared) {
            auto const& m = measurements.at(sheared);
            auto const in_steps = [&](double time) { return std::max(1L, std::lround(time / step)); };
            auto overrides = scene_settings(integrator, sheared, friction, repulsion);
            append(overrides,
                   {fmt::format("time.step={}", step),
                    fmt::format("time.duration={}",
                                effort.duration_scale * (is_reference ? reference_duration : duration)),
                    fmt::format("sample.interval={}", in_steps(m.interval))});
            append(overrides, m.settings);
            if (!sheared)
                overrides.push_back(
                    fmt::format("sample.radial_distribution.interval={}", in_steps(m.radial_interval)));
            StudyRun run{.integrator = integrator.name,
                         .reference = is_reference,
                         .sheared = sheared,
                         .step = step,
                         .scene = parse_scene(scene_text.str(),
                                              fmt::format("{} ({}, {}, step {})", file.string(), study.name,
                                                          integrator.name, step),
                                              overrides)};
            run.scene.seed = is_reference ? 2 : 1;  // independent of what is compared with it
            study.runs.push_back(std::move(run));
        };
        for (auto const& integrator : integrators) {
            study.integrators.push_back(integrator.name);
            if (integrator.other_dynamics) study.other_dynamics.push_back(integrator.name);
            for (bool const sheared : {false, true}) {
                for (double const step : steps)
                    if (step >= integrator.least_step) add(integrator, step, false, sheared);
                if (integrator.name == reference)
                    for (double const step : reference_steps) add(integrator, step, true, sheared);
            }
        }
        if (std::none_of(study.runs.begin(), study.runs.end(), [](auto const& run) { return run.reference; }))
            fluid.fail("reference", fmt::format("{} is no integrator; allowed: {}", reference,
                                                fmt::join(study.integrators, ", ")));
        studies.push_back(std::move(study));
    }
    root.finish();
    return studies;
}

// --- runs ------------------------------------------------------------------------------------------------

namespace {

// Processor time of one step of a scene, its sampling included: the least of a few short runs, less what
// it takes to set one up.
double measure_cost(Scene const& scene) {
    constexpr int repetitions = 3;
    constexpr std::uint64_t few = 20, many = 140;
    auto const least = [&](std::uint64_t production) {
        Scene part = scene;
        part.equilibration_steps = part.sample.equilibration = few;
        part.production_steps = production;
        part.sample.steps = part.steps();
        double best = INFINITY;
        for (int repetition = 0; repetition < repetitions; ++repetition) {
            double const start = thread_seconds();
            run(part);
            best = std::min(best, thread_seconds() - start);
        }
        return best;
    };
    return (least(many) - least(few)) / double(many - few);
}

// The cost of a step, measured once per cache.
double cost_of_step(Scene const& scene, std::filesystem::path const& cache) {
    auto const file = cache / (scene.key() + ".cost");
    double cost = 0.0;
    if (std::ifstream(file) >> cost) return cost;
    cost = measure_cost(scene);
    auto const part = cache / (scene.key() + ".cost.part");
    std::ofstream(part) << cost << '\n';
    std::filesystem::rename(part, file);
    return cost;
}

}  // namespace

bool run_studies(std::vector<Study>& studies, CampaignOptions const& options) {
    struct Measured {
        RunResult result;
        bool diverged = false;
        double seconds_per_step = 0.0;
    };
    std::vector<Task<Measured>> tasks;
    for (auto const& study : studies)
        for (auto const& one : study.runs)
            tasks.push_back(
                {one.scene.key(), double(one.scene.steps()),
                 [&scene = one.scene, &options](Measured& measured, Report const& report) {
                     auto const file = options.cache / (scene.key() + ".h5");
                     try {
                         measured.result =
                             run(scene,
                                 {.output = file, .cache = true, .stop = options.stop, .progress = report});
                         measured.seconds_per_step = cost_of_step(scene, options.cache);
                     } catch (Diverged const&) {
                         measured.diverged = true;
                     }
                     return measured.result.from_cache;
                 }});
    auto const done = do_once("work and precision", tasks, options);
    if (!done) return false;
    for (auto& study : studies)
        for (auto& one : study.runs) {
            Measured const& measured = done->at(one.scene.key());
            one.diverged = measured.diverged;
            one.seconds_per_step = measured.seconds_per_step;
            if (one.diverged) continue;
            one.record = measured.result.record;
            one.quantities = analyze(one.scene, {one.record});
        }
    return true;
}

// --- errors ----------------------------------------------------------------------------------------------

namespace {

// Weighted least squares for y = sum of c_k f_k(x), the errors known: coefficients and their covariance.
struct Fit {
    Eigen::VectorXd coefficients;
    Eigen::MatrixXd covariance;
    double chi_squared = 0.0;
};
Fit weighted_fit(Eigen::MatrixXd f, Eigen::VectorXd y, Eigen::VectorXd const& errors) {
    f.array().colwise() /= errors.array();
    y.array() /= errors.array();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> const solve(f);
    Fit fit;
    fit.coefficients = solve.solve(y);
    fit.covariance = (f.transpose() * f).inverse();
    fit.chi_squared = (y - f * fit.coefficients).squaredNorm();
    return fit;
}

}  // namespace

Limit limit_of_step_zero(std::vector<double> const& steps, std::vector<Estimate> const& values) {
    auto const n = static_cast<Eigen::Index>(steps.size());
    Eigen::MatrixXd f(n, 2);
    Eigen::VectorXd y(n), errors(n);
    Limit limit;
    // a bin of g(r) in which a run has found no pair has no scatter; where none has, there is nothing to fit
    double largest_error = 0.0;
    for (auto const& value : values) largest_error = std::max(largest_error, value.error);
    if (largest_error == 0.0) return limit;
    for (Eigen::Index k = 0; k < n; ++k) {
        auto const& value = values[std::size_t(k)];
        f.row(k) << 1.0, std::pow(steps[std::size_t(k)], 2);
        y[k] = value.value;
        errors[k] = value.error > 0.0 ? value.error : largest_error;
        limit.estimate.blocks = k == 0 ? value.blocks : std::min(limit.estimate.blocks, value.blocks);
    }
    Fit const fit = weighted_fit(f, y, errors);
    limit.estimate.value = fit.coefficients[0];
    limit.estimate.error = std::sqrt(fit.covariance(0, 0));
    limit.chi_squared = fit.chi_squared;
    limit.degrees_of_freedom = steps.size() - 2;
    return limit;
}

double ErrorLaw::bias(double step) const {
    Eigen::VectorXd powers(covariance.rows());
    double value = 0.0;
    for (Eigen::Index k = 0; k < powers.size(); ++k) {
        powers[k] = std::pow(step, double(k + 1));
        value += coefficients[std::size_t(k)] * powers[k];
    }
    return std::sqrt(value * value + powers.dot(covariance * powers));
}

// In standard errors: from here on a deviation tells of the step, not of chance.
constexpr double clear_of_noise = 4.0;

ErrorLaw fit_error_law(std::vector<Deviation> const& deviations) {
    constexpr double small = 0.05;  // relative; beyond it no expansion in the step is expected to hold
    constexpr std::size_t most_terms = 3, most_order_points = 4;
    std::vector<Deviation> used;
    for (auto const& d : deviations)
        if (std::abs(d.value) < small && d.error > 0.0) used.push_back(d);
    ErrorLaw law;
    if (used.empty()) return law;
    std::sort(used.begin(), used.end(), [](auto const& a, auto const& b) { return a.step < b.step; });
    auto const n = static_cast<Eigen::Index>(used.size());
    auto const terms =
        static_cast<Eigen::Index>(std::min(most_terms, std::max<std::size_t>(1, used.size() - 1)));
    Eigen::MatrixXd f(n, terms);
    Eigen::VectorXd y(n), errors(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        auto const& d = used[std::size_t(k)];
        for (Eigen::Index power = 0; power < terms; ++power)
            f(k, power) = std::pow(d.step, double(power + 1));
        y[k] = d.value;
        errors[k] = d.error;
    }
    Fit const fit = weighted_fit(f, y, errors);
    law.coefficients.assign(fit.coefficients.begin(), fit.coefficients.end());
    law.covariance = fit.covariance;

    std::erase_if(used, [](auto const& d) { return std::abs(d.value) < clear_of_noise * d.error; });
    used.resize(std::min(used.size(), most_order_points));
    law.order_points = used.size();
    if (used.size() < 2) return law;
    auto const m = static_cast<Eigen::Index>(used.size());
    Eigen::MatrixXd line(m, 2);
    Eigen::VectorXd logarithm(m), relative(m);
    for (Eigen::Index k = 0; k < m; ++k) {
        auto const& d = used[std::size_t(k)];
        line.row(k) << 1.0, std::log(d.step);
        logarithm[k] = std::log(std::abs(d.value));
        relative[k] = d.error / std::abs(d.value);
    }
    Fit const slope = weighted_fit(line, logarithm, relative);
    law.order = slope.coefficients[1];
    law.order_error = std::sqrt(slope.covariance(1, 1));
    return law;
}

double seconds_to_reach(double target, double bias, double variance_time, double seconds_per_time) {
    double const left = target * target - bias * bias;
    return left > 0.0 ? variance_time / left * seconds_per_time : INFINITY;
}

// --- output ----------------------------------------------------------------------------------------------

namespace {

// All that is known of an integrator and an observable.
struct MethodErrors {
    std::string integrator;
    Observable const* observable = nullptr;
    std::vector<Deviation> deviations;
    ErrorLaw law;
    double reference_error = 0.0;  // relative
    double variance_time = 0.0;

    // Of a run at a step that was tried, as it is used to choose one.
    double bias(Deviation const& at) const {
        return std::hypot(reference_error, std::max(law.bias(at.step), std::abs(at.value) - 2.0 * at.error));
    }
    double seconds_per_time(Deviation const& at) const { return at.seconds / at.duration; }

    // The step that reaches a target first; none if none does. Over less than `shortest` in time there is no
    // mean to speak of, and the variance is not that of independent samples.
    std::pair<double, double> cheapest(double target) const {
        constexpr double shortest = 1.0;
        std::pair<double, double> best{INFINITY, 0.0};
        for (auto const& d : deviations) {
            double const seconds = seconds_to_reach(target, bias(d), variance_time, seconds_per_time(d));
            best = std::min(best, {std::max(seconds, shortest * seconds_per_time(d)), d.step});
        }
        return best;
    }

    // Bias and statistics together after so many seconds, at the step that is best for them.
    double total_error(double seconds) const {
        double least = INFINITY;
        for (auto const& d : deviations)
            least = std::min(least,
                             std::sqrt(std::pow(bias(d), 2) + variance_time * seconds_per_time(d) / seconds));
        return least;
    }
};

Estimate estimate_of(StudyRun const& run, std::string const& quantity) {
    Quantity const* const found = find_quantity(run.quantities, quantity);
    return found ? found->estimate : Estimate{};
}

CurveEstimate radial_distribution(StudyRun const& run) {
    return curve_of(run.scene, {run.record}, "radial_distribution");
}

// Limits of step zero, by observable and, for g(r), by bin.
struct Reference {
    std::map<std::string, Limit> limits;
    std::vector<Limit> radial;
};

Reference reference_of(Study const& study) {
    Reference reference;
    auto const limit = [&](bool sheared, auto&& value) {
        std::vector<double> steps;
        std::vector<Estimate> values;
        for (auto const& run : study.runs)
            if (run.reference && run.sheared == sheared && !run.diverged) {
                steps.push_back(run.step);
                values.push_back(value(run));
            }
        if (steps.size() < 2)
            throw InputError(fmt::format("study {}: the reference runs diverged", study.name));
        return limit_of_step_zero(steps, values);
    };
    for (auto const& o : study_observables()) {
        if (o.exact)
            reference.limits[o.quantity].estimate = {.value = *o.exact, .error = 0.0, .blocks = 1};
        else if (o.quantity != "g(r)")
            reference.limits[o.quantity] =
                limit(o.sheared, [&](StudyRun const& run) { return estimate_of(run, o.quantity); });
    }
    std::size_t bins = 0;
    for (auto const& run : study.runs)
        if (run.reference && !run.sheared) bins = radial_distribution(run).x.size();
    for (std::size_t bin = 0; bin < bins; ++bin)
        reference.radial.push_back(
            limit(false, [&](StudyRun const& run) { return radial_distribution(run).y[bin]; }));
    return reference;
}

// Root mean square over the bins of what g(r) is off by, over the root mean square of g(r), the noise taken
// off; its error from the noise of the bins, taken as independent.
Deviation radial_deviation(CurveEstimate const& g, std::vector<Limit> const& reference) {
    double square = 0.0, own_noise = 0.0, noise = 0.0, variance = 0.0, norm = 0.0;
    for (std::size_t bin = 0; bin < g.y.size(); ++bin) {
        double const limit = reference[bin].estimate.value, difference = g.y[bin].value - limit;
        double const own = std::pow(g.y[bin].error, 2),
                     both = own + std::pow(reference[bin].estimate.error, 2);
        square += difference * difference;
        own_noise += own;
        noise += both;
        variance += 2.0 * both * both + 4.0 * both * std::max(0.0, difference * difference - both);
        norm += limit * limit;
    }
    double const excess = std::max(0.0, square - noise) / norm, spread = std::sqrt(variance) / norm;
    Deviation deviation;
    deviation.value = std::sqrt(excess);
    // the error of a root, which at zero is the root of the error
    deviation.error = std::sqrt(excess + spread) - deviation.value;
    deviation.statistical = std::sqrt(own_noise / norm);
    return deviation;
}

std::vector<MethodErrors> errors_of(Study const& study, Reference const& reference) {
    std::vector<MethodErrors> all;
    for (auto const& o : study_observables())
        for (auto const& integrator : study.integrators) {
            bool const other = std::find(study.other_dynamics.begin(), study.other_dynamics.end(),
                                         integrator) != study.other_dynamics.end();
            if (other && (o.quantity == "diffusion_constant" || o.quantity == "viscosity")) continue;
            MethodErrors method{.integrator = integrator, .observable = &o, .deviations = {}, .law = {}};
            for (auto const& run : study.runs) {
                if (run.integrator != integrator || run.reference || run.diverged || run.sheared != o.sheared)
                    continue;
                Deviation d;
                if (o.quantity == "g(r)") {
                    d = radial_deviation(radial_distribution(run), reference.radial);
                } else {
                    Estimate const& limit = reference.limits.at(o.quantity).estimate;
                    Estimate const measured = estimate_of(run, o.quantity);
                    d.value = measured.value / limit.value - 1.0;
                    d.statistical = measured.error / std::abs(limit.value);
                    method.reference_error = limit.error / std::abs(limit.value);
                    d.error = std::hypot(d.statistical, method.reference_error * (1.0 + d.value));
                }
                d.step = run.step;
                d.duration = double(run.scene.production_steps) * run.step;
                d.seconds = run.seconds_per_step * double(run.scene.production_steps);
                if (std::isfinite(d.error)) method.deviations.push_back(d);
            }
            method.law = fit_error_law(method.deviations);
            // where a bias is larger than what is measured, its scatter is not that of the fluid in question
            double weight = 0.0;
            for (auto const& d : method.deviations)
                if (std::abs(d.value) < 0.3) {
                    method.variance_time += d.statistical * d.statistical * d.duration;
                    weight += 1.0;
                }
            if (weight == 0.0) continue;
            method.variance_time /= weight;
            all.push_back(std::move(method));
        }
    return all;
}

constexpr std::array targets{0.01, 0.001};

// The cheapest integrators for an observable and a target, the best first.
struct Offer {
    double seconds = INFINITY, step = 0.0;
    std::string integrator;
};
std::vector<Offer> offers(std::vector<MethodErrors> const& methods, std::string const& quantity,
                          double target) {
    std::vector<Offer> list;
    for (auto const& method : methods)
        if (method.observable->quantity == quantity)
            if (auto const [seconds, step] = method.cheapest(target); std::isfinite(seconds))
                list.push_back({seconds, step, method.integrator});
    std::sort(list.begin(), list.end(), [](auto const& a, auto const& b) { return a.seconds < b.seconds; });
    return list;
}

std::string cheapest_table(std::vector<MethodErrors> const& methods) {
    std::string table = "| observable |";
    for (double const target : targets)
        table += fmt::format(" {:g} %: integrator, step, processor time | the next |", 100.0 * target);
    table += "\n|---|";
    for (std::size_t t = 0; t < targets.size(); ++t) table += "---|---|";
    for (auto const& o : study_observables()) {
        table += fmt::format("\n| {} |", o.label);
        for (double const target : targets) {
            auto const list = offers(methods, o.quantity, target);
            for (std::size_t place = 0; place < 2; ++place)
                table += place < list.size() ? fmt::format(" {}, {:g}, {:.2g} s |", list[place].integrator,
                                                           list[place].step, list[place].seconds)
                                             : std::string(" none |");
        }
    }
    return table + "\n";
}

// A table with a row per integrator and a column per observable; `cell` may have nothing to say.
template <class Cell>
std::string table_of(Study const& study, std::vector<MethodErrors> const& methods,
                     std::string const& first_row, Cell&& cell) {
    std::string table = "| integrator |", rule = "\n|---|";
    for (auto const& o : study_observables()) {
        table += fmt::format(" {} |", o.label);
        rule += "---|";
    }
    table += rule + first_row;
    for (auto const& integrator : study.integrators) {
        table += fmt::format("\n| {} |", integrator);
        for (auto const& o : study_observables()) {
            auto const found = std::find_if(methods.begin(), methods.end(), [&](MethodErrors const& m) {
                return m.integrator == integrator && m.observable == &o;
            });
            std::string const text = found != methods.end() ? cell(*found) : std::string();
            table += fmt::format(" {} |", text.empty() ? "–" : text);
        }
    }
    return table + "\n";
}

// The limits of step zero, and the orders seen where two deviations or more are clear of noise.
std::string order_table(Study const& study, Reference const& reference,
                        std::vector<MethodErrors> const& methods) {
    std::string limits = "\n| limit of step zero |";
    for (auto const& o : study_observables()) {
        auto const found = reference.limits.find(o.quantity);
        if (found == reference.limits.end())
            limits += " |";
        else if (auto const& estimate = found->second.estimate; estimate.error > 0.0)
            limits += fmt::format(" {:.6g} ± {:.1g} |", estimate.value, estimate.error);
        else
            limits += fmt::format(" {:g}, exact |", estimate.value);
    }
    return table_of(study, methods, limits, [](MethodErrors const& m) {
        return m.law.order_points >= 2 ? fmt::format("{:.1f} ± {:.1f}", m.law.order, m.law.order_error)
                                       : std::string();
    });
}

std::string deviation_table(Study const& study, std::vector<MethodErrors> const& methods) {
    return table_of(study, methods, "", [&](MethodErrors const& m) {
        for (auto const& d : m.deviations)
            if (d.step == study.table_step)
                return fmt::format("{:+.2f} ± {:.2f}", 100.0 * d.value, 100.0 * d.error);
        return std::string();
    });
}

std::string data_of(Study const& study, Reference const& reference,
                    std::vector<MethodErrors> const& methods) {
    std::string text = "# limit of step zero: observable, value, error, chi^2, degrees of freedom\n";
    for (auto const& o : study_observables())
        if (auto const found = reference.limits.find(o.quantity); found != reference.limits.end())
            text += fmt::format("{} {:.8g} {:.3g} {:.3g} {}\n", o.quantity, found->second.estimate.value,
                                found->second.estimate.error, found->second.chi_squared,
                                found->second.degrees_of_freedom);
    text += "\n\n# diverged: integrator, step, sheared\n";
    for (auto const& run : study.runs)
        if (run.diverged)
            text += fmt::format("\"{}\" {:g} {}\n", run.integrator, run.step, run.sheared ? 1 : 0);
    text += "\n\n# order: integrator, observable, order, error, points\n";
    for (auto const& m : methods)
        text += fmt::format("\"{}\" {} {:.3f} {:.3f} {}\n", m.integrator, m.observable->quantity, m.law.order,
                            m.law.order_error, m.law.order_points);
    for (auto const& m : methods) {
        text += fmt::format(
            "\n\n# error:{}:{}: step, relative deviation, its error, seconds, expected bias, statistical "
            "error\n",
            m.integrator, m.observable->quantity);
        for (auto const& d : m.deviations)
            text += fmt::format("{:g} {:.6g} {:.3g} {:.4g} {:.4g} {:.3g}\n", d.step, d.value, d.error,
                                d.seconds, m.bias(d), d.statistical);
    }
    for (auto const& m : methods) {
        text += fmt::format("\n\n# total:{}:{}: seconds, bias and statistics\n", m.integrator,
                            m.observable->quantity);
        for (double seconds = 0.01; seconds < 1.001e5; seconds *= std::pow(10.0, 0.125))
            text += fmt::format("{:.4g} {:.4g}\n", seconds, m.total_error(seconds));
    }
    return text;
}

}  // namespace

void write_study(Study const& study, std::string const& budget, std::filesystem::path const& directory,
                 std::filesystem::path const& output) {
    std::filesystem::create_directories(output / "data");
    Reference const reference = reference_of(study);
    auto const methods = errors_of(study, reference);
    double seconds = 0.0;
    for (auto const& run : study.runs) seconds += run.seconds_per_step * double(run.scene.steps());
    auto const data = output / "data" / (study.name + ".dat");
    std::string const origin = fmt::format("dpdref {}, engine revision {}; {} budget, processor time {}",
                                           version, engine_revision, budget, duration_text(seconds));
    write_file(data, fmt::format("# {}; {}\n\n\n", study.title, origin) + data_of(study, reference, methods));
    std::string const table = fmt::format(
        "Cheapest integrators:\n\n{}\nDeviations at step {:g} in per cent:\n\n{}\nLimits of step zero, and "
        "orders "
        "seen:\n\n{}",
        cheapest_table(methods), study.table_step, deviation_table(study, methods),
        order_table(study, reference, methods));
    write_file(output / "data" / (study.name + ".md"), table);
    fmt::print("{}\n\n{}\n", study.title, table);
    draw_study(study, directory, output);
}

void draw_study(Study const& study, std::filesystem::path const& directory,
                std::filesystem::path const& output) {
    auto const data = output / "data" / (study.name + ".dat");
    if (!std::filesystem::exists(data))
        throw InputError(fmt::format("{}: there is none; `dpdref work-precision` makes it", data.string()));
    std::string names, observables, labels;
    for (auto const& name : study.integrators) names += (names.empty() ? "" : ",") + quoted(name);
    for (auto const& o : study_observables()) {
        observables += (observables.empty() ? "" : ",") + quoted(o.quantity);
        labels += (labels.empty() ? "" : ",") + quoted(o.label);
    }
    std::string const definitions = fmt::format(
        "script_directory = {}\ndata = {}\ntitle_text = {}\narray names[{}] = [{}]\n"
        "array observables[{}] = [{}]\narray labels[{}] = [{}]\n",
        quoted_path(directory), quoted_path(data), quoted(study.title), study.integrators.size(), names,
        study_observables().size(), observables, study_observables().size(), labels);
    for (char const* picture : {"step", "time", "total"})
        draw(output / fmt::format("{}-{}", study.name, picture), directory / (std::string(picture) + ".gp"),
             definitions, 1000, 1250);
}

}  // namespace dpd
