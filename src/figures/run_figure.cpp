#include "run_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <set>

#include "convergence.hpp"
#include "derived.hpp"
#include "errors.hpp"

namespace dpd {
namespace {

template <class Visit>
void for_each_run(Point const& point, Visit&& visit) {
    for (auto const* const runs : {&point.runs, &point.at_rest})
        for (Scene const& scene : *runs) visit(scene);
}

// Rough cost of a run, in pair and particle visits: good enough to start the longest first and to tell the
// time that is left. With `until` the geometric mean of the least and the greatest that it can be.
double cost_of(Scene const& scene) {
    double const ball = scene.dimension == 2 ? std::numbers::pi : 4.0 * std::numbers::pi / 3.0;
    double const pairs = 0.5 * scene.density() * ball * std::pow(scene.cutoff(), scene.dimension);
    auto const* const verlet = scene.stage<Verlet>();
    double const substeps = verlet ? double(verlet->substeps) : 1.0;
    double const measured = scene.until
                                ? std::sqrt(double(scene.production_steps) * double(scene.until->longest))
                                : double(scene.production_steps);
    return (double(scene.equilibration_steps) + measured) * substeps * double(scene.particles) *
           (4.0 + pairs);
}

// A measured curve as points, one per bin that is asked for. False if there is none.
bool append_bins(std::vector<Point>& points, FigureCurve const& curve, Point const& run,
                 std::vector<Record> const& records) {
    auto const [x, y] = curve_of(run.runs.front(), records, curve.record);
    std::vector<std::size_t> bins;
    for (std::size_t bin = 0; bin < x.size(); bin += curve.every)
        if (x[bin] >= curve.from && x[bin] <= curve.to && y[bin].blocks > 0) bins.push_back(bin);
    for (std::size_t const bin : bins) {
        Point point = run;
        point.x = x[bin];
        point.quantities.push_back({curve.record, y[bin]});
        point.seconds = run.seconds / double(bins.size());
        if (bin != bins.front()) point.configuration.resize(0, 0);
        points.push_back(std::move(point));
    }
    return !bins.empty();
}

}  // namespace

// The points of a curve at x; its only point, if it has one, stands for all x.
std::vector<Point const*> points_of(std::string const& name, std::vector<FigureCurve> const& curves,
                                    std::vector<Point> const& points, double x) {
    std::vector<Point const*> found;
    for (auto const& point : points)
        if (!name.empty() && curves[point.curve].name == name) found.push_back(&point);
    if (found.size() > 1) std::erase_if(found, [x](Point const* point) { return point->x != x; });
    return found;
}

namespace {

// Takes the stress of the runs at rest, whose mean is zero, off that of the same runs in shear: where both
// meet the same noise, what is left fluctuates less.
void subtract_noise(std::vector<Record>& sheared, std::vector<Record> const& at_rest) {
    for (std::size_t r = 0; r < at_rest.size(); ++r)
        for (auto& [name, values] : sheared[r].series) {
            if (!name.ends_with("_stress")) continue;
            auto const& noise = at_rest[r].series.at(name);
            for (std::size_t k = 0; k < noise.size(); ++k) values[k] -= noise[k];
        }
}

// Adds the quantities of the joined curve's point at the same x (or of its only one) that the point lacks.
void join(std::string const& name, std::vector<FigureCurve> const& curves, std::vector<Point> const& points,
          Point& point) {
    for (Point const* const partner : points_of(name, curves, points, point.x)) {
        for (auto const& quantity : partner->quantities)
            if (!find_quantity(point.quantities, quantity.name)) point.quantities.push_back(quantity);
        point.seconds += partner->seconds;
    }
    if (auto const& others = curves[point.curve].slope_between; !others.empty()) {
        auto const below = points_of(others[0], curves, points, point.x),
                   above = points_of(others[1], curves, points, point.x);
        auto const pressure = [](Point const& at) {
            Quantity const* const found = find_quantity(at.quantities, "pressure");
            return found ? found->estimate : Estimate{};
        };
        if (!below.empty() && !above.empty()) {
            derive_from_densities(
                point.runs.front(),
                above.front()->runs.front().density() - below.front()->runs.front().density(),
                pressure(*below.front()), pressure(*above.front()), point.quantities);
            point.seconds += below.front()->seconds + above.front()->seconds;
        }
    }
    derive(point.runs.front(), point.quantities);
    if (curves[point.curve].record == "velocity_autocorrelation")
        derive_at_lag(point.runs.front(), point.quantities, point.x);
}

// Run time up to a fraction of the production: a step costs the same throughout.
double seconds_until(Scene const& scene, RunResult const& result, double fraction) {
    double const before = double(scene.equilibration_steps), measured = result.duration / scene.time_step;
    return result.seconds * ((before + fraction * measured) / (before + measured));
}

// Run time behind the points of curve c, of joined points too; each run counts once.
double seconds_of(Figure const& figure, std::size_t c, Results const& results, double fraction) {
    auto const& curve = figure.curves[c];
    std::vector<std::string> joined = curve.slope_between;
    joined.push_back(curve.join);
    std::map<std::string, double> seconds;
    auto const count = [&](Point const& point) {
        for_each_run(point, [&](Scene const& scene) {
            std::string const key = scene.key();
            seconds[key] = seconds_until(scene, *results.at(key), fraction);
        });
    };
    for (auto const& point : figure.points) {
        if (point.curve != c) continue;
        count(point);
        for (auto const& name : joined)
            for (Point const* const partner : points_of(name, figure.curves, figure.points, point.x))
                count(*partner);
    }
    double sum = 0.0;
    for (auto const& [key, of_run] : seconds) sum += of_run;
    return sum;
}

}  // namespace

Figure measured(Figure const& planned, Results const& results, double fraction) {
    bool const whole = fraction == 1.0;
    Figure figure = planned;
    std::vector<Point> points;
    std::set<std::string> counted;
    auto const records_of = [&](std::vector<Scene> const& runs, Point& point) {
        std::vector<Record> records;
        for (auto const& scene : runs) {
            auto const& result = *results.at(scene.key());
            double const seconds = seconds_until(scene, result, fraction);
            records.push_back(first_part(result.record, fraction));
            point.seconds += seconds;
            if (counted.insert(scene.key()).second) figure.seconds += seconds;
        }
        return records;
    };
    for (auto& point : figure.points) {
        std::vector<Record> records = records_of(point.runs, point);
        subtract_noise(records, records_of(point.at_rest, point));
        point.quantities = analyze(point.runs.front(), records);
        point.configuration = records.front().configuration;
        auto const& curve = figure.curves[point.curve];
        if (curve.record.empty())
            points.push_back(point);
        else if (!append_bins(points, curve, point, records) && whole)
            throw InputError(fmt::format("curve {}: its scene does not measure {}, or not from {:g} to {:g}",
                                         curve.name, curve.record, curve.from, curve.to));
    }
    for (auto& point : points) {
        try {
            join(figure.curves[point.curve].join, figure.curves, points, point);
        } catch (std::logic_error const&) {
            // a closed form refuses a viscosity that is not yet positive
            if (whole) throw;
        }
    }
    figure.points = std::move(points);
    for (std::size_t c = 0; c < figure.curves.size(); ++c)
        figure.curves[c].seconds = seconds_of(figure, c, results, fraction);
    return figure;
}

namespace {

// What a campaign has of its figures so far.
class Progressing {
public:
    Progressing(std::vector<Figure>& figures, std::function<void(Figure const&)> const& finished)
        : figures_(figures), finished_(finished), missing_(figures.size()) {
        for (std::size_t f = 0; f < figures.size(); ++f)
            for (auto const& point : figures[f].points)
                for_each_run(point, [&](Scene const& scene) { missing_[f].insert(scene.key()); });
    }

    // Takes a result; measures the figures that lacked it alone.
    void take(std::string const& key, RunResult const& result) {
        std::scoped_lock const lock(mutex_);
        results_[key] = &result;
        for (std::size_t f = 0; f < figures_.size(); ++f) {
            if (missing_[f].erase(key) == 0 || !missing_[f].empty()) continue;
            Figure& figure = figures_[f];
            auto convergence = converge(figure, results_);
            figure = measured(figure, results_);
            figure.convergence = std::move(convergence);
            if (finished_) finished_(figure);
        }
    }

private:
    std::vector<Figure>& figures_;
    std::function<void(Figure const&)> const& finished_;
    std::vector<std::set<std::string>> missing_;  // keys of the runs that each figure lacks
    Results results_;
    std::mutex mutex_;
};

}  // namespace

std::optional<RunTime> run_points(std::vector<Figure>& figures, CampaignOptions const& options,
                                  std::function<void(Figure const&)> const& finished) {
    Progressing progressing(figures, finished);
    std::vector<Task<RunResult>> tasks;
    for (auto const& figure : figures)
        for (auto const& point : figure.points)
            for_each_run(point, [&](Scene const& scene) {
                std::string const key = scene.key();
                tasks.push_back(
                    {key, cost_of(scene),
                     [scene, key, &options, &progressing](RunResult& result, Report const& report) {
                         result = run(scene, {.output = options.cache / (key + ".h5"),
                                              .cache = true,
                                              .stop = options.stop,
                                              .progress = report});
                         if (!options.shard) progressing.take(key, result);
                         return result.from_cache;
                     }});
            });
    auto const results = do_once(figures.size() == 1 ? figures.front().id : "figures", tasks, options);
    if (!results) return {};
    RunTime run_time;
    for (auto const& [key, result] : *results) {
        ++run_time.runs;
        run_time.seconds += result.seconds;
    }
    return run_time;
}

}  // namespace dpd
