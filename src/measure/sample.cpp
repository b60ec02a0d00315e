#include "sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "elementary.hpp"

namespace dpd {

void Curve::resize(std::size_t bins) {
    x.resize(bins);
    sum.setZero(static_cast<Eigen::Index>(bins), curve_blocks);
    weight.setZero(static_cast<Eigen::Index>(bins), curve_blocks);
}

void Curve::double_blocks() {
    for (Eigen::ArrayXXd* const part : {&sum, &weight}) {
        for (Eigen::Index block = 0; block < curve_blocks / 2; ++block)
            part->col(block) = (part->col(2 * block) + part->col(2 * block + 1)).eval();
        part->rightCols(curve_blocks / 2).setZero();
    }
}

std::vector<double> Curve::block_means(Eigen::Index bin) const {
    std::vector<double> means;
    for (Eigen::Index block = 0; block < sum.cols(); ++block)
        if (weight(bin, block) > 0.0) means.push_back(sum(bin, block) / weight(bin, block));
    return means;
}

// Scalars and curves in the H5MD layout of observables; `sum` and `weight` of a curve are ours.
void Record::archive(Archive& archive) {
    for (auto& [name, values] : series) archive("observables/" + name + "/value", values);
    for (auto& [name, curve] : curves) {
        archive("observables/" + name + "/x", curve.x);
        archive("observables/" + name + "/sum", curve.sum);
        archive("observables/" + name + "/weight", curve.weight);
    }
    if (configuration.size() > 0) archive("observables/configuration/value", configuration);
}

template <int d>
Recorder<d>::Recorder(SampleParameters parameters, Simulation<d> const& simulation)
    : parameters_(std::move(parameters)),
      time_step_(simulation.time_step),
      particles_(simulation.particles.size()) {
    // The blocks begin short and double until they span the run, so that a run that ends after half as many
    // steps, or a quarter, has summed the same numbers in the same order: both begin with the same odd
    // number of steps.
    span_ = production() >> std::countr_zero(production());
    auto& series = record_.series;
    for_each_series([&](auto const& row) {
        if (parameters_.observables.contains(row.observable) &&
            (!row.needs_potential || simulation.potential_sums))
            series[std::string(row.name)];
    });
    auto const curve = [&](std::string const& name, std::size_t bins, double first, double spacing) {
        Curve& added = record_.curves[name];
        added.resize(bins);
        for (std::size_t b = 0; b < bins; ++b) added.x[b] = first + spacing * double(b);
    };
    if (auto const& p = parameters_.profile) {
        double const width = simulation.box.length[1] / double(p->bins);
        for (char const* name : {"velocity_profile", "density_profile"})
            curve(name, p->bins, 0.5 * width, width);
        if (p->temperature) curve("velocity_squared_profile", p->bins, 0.5 * width, width);
    }
    if (auto const& p = parameters_.radial_distribution) {
        double const width = p->range / double(p->bins);
        curve("radial_distribution", p->bins, 0.5 * width, width);
        wide_search_.cutoff = p->range;
        wide_search_.check(simulation.box);
    }
    if (auto const& p = parameters_.bond_order) {
        for (char const* name : {"global_q4", "local_q4", "global_q6", "local_q6"}) series[name];
        bond_search_.cutoff = p->range;
        bond_search_.check(simulation.box);
    }
    if (parameters_.configuration) record_.configuration.setZero(Eigen::Index{simulation.particles.fluid}, d);
    auto const correlation = [&](std::string const& name, CorrelationParameters const& p) {
        curve(name, p.lags + 1, 0.0, double(p.spacing) * simulation.time_step);
    };
    if (auto const& p = parameters_.mean_square_displacement) correlation("mean_square_displacement", *p);
    if (auto const& p = parameters_.velocity_autocorrelation) correlation("velocity_autocorrelation", *p);
}

template <int d>
Eigen::Index Recorder<d>::block_of(std::uint64_t step) const {
    return static_cast<Eigen::Index>((step - parameters_.equilibration) * curve_blocks / span_);
}

template <int d>
void Recorder<d>::operator()(Simulation<d>& simulation) {
    if (simulation.step < parameters_.equilibration) return;
    std::uint64_t const step = simulation.step - parameters_.equilibration;
    for (; step >= span_; span_ *= 2)
        for (auto& [name, curve] : record_.curves) curve.double_blocks();
    auto& series = record_.series;
    if (step % parameters_.interval == 0) {
        Instant<d> now(simulation);
        for_each_series([&](auto const& row) {
            if (auto const found = series.find(row.name); found != series.end())
                found->second.push_back(row.value(now));
        });
    }
    Eigen::Index const block = block_of(simulation.step);
    if (parameters_.profile && step % parameters_.profile->interval == 0) sample_profile(simulation, block);
    if (parameters_.radial_distribution && step % parameters_.radial_distribution->interval == 0)
        sample_radial_distribution(simulation, block);
    if (parameters_.bond_order && step % parameters_.bond_order->interval == 0) sample_bond_order(simulation);
    if (parameters_.configuration && step % parameters_.interval == 0)
        for (Eigen::Index p = 0; p < simulation.particles.size(); ++p)
            if (!simulation.particles.frozen(p))
                record_.configuration.row(simulation.particles.id[p]) = simulation.particles.position.row(p);
    int const components = parameters_.components;
    if (auto const& p = parameters_.mean_square_displacement)
        correlate(
            simulation, *p, "mean_square_displacement", displacement_origins_,
            [&](auto& unwrapped) {
                unwrapped = simulation.particles.position;
                for (int axis = 0; axis < d; ++axis)
                    unwrapped.col(axis) += simulation.box.length[axis] *
                                           simulation.particles.image.col(axis).template cast<double>();
            },
            [=](auto const& now, auto const& then) {
                return sum_of_squares((now - then).rightCols(components));
            });
    if (auto const& p = parameters_.velocity_autocorrelation)
        correlate(
            simulation, *p, "velocity_autocorrelation", velocity_origins_,
            [&](auto& velocity) { velocity = simulation.particles.velocity; },
            [=](auto const& now, auto const& then) { return sum_of((now * then).rightCols(components)); });
}

template <int d>
void Recorder<d>::sample_profile(Simulation<d> const& simulation, Eigen::Index block) {
    Curve& velocity = record_.curves["velocity_profile"];
    Curve& density = record_.curves["density_profile"];
    auto const bins = static_cast<Eigen::Index>(velocity.x.size());
    double const bins_per_length = double(bins) / simulation.box.length[1];
    auto const& particles = simulation.particles;
    for (Eigen::Index p = 0; p < particles.size(); ++p) {
        if (particles.frozen(p)) continue;
        auto const bin =
            std::min(static_cast<Eigen::Index>(particles.position(p, 1) * bins_per_length), bins - 1);
        velocity.sum(bin, block) += particles.velocity(p, 0);
        velocity.weight(bin, block) += 1.0;
        density.sum(bin, block) += double(bins) / simulation.box.volume();
    }
    density.weight.col(block) += 1.0;
    if (!parameters_.profile->temperature) return;
    // relative to the imposed flow; what else flows is taken off in the analysis
    Curve& square = record_.curves["velocity_squared_profile"];
    for (Eigen::Index p = 0; p < particles.size(); ++p) {
        if (particles.frozen(p)) continue;
        double const y = particles.position(p, 1);
        auto const bin = std::min(static_cast<Eigen::Index>(y * bins_per_length), bins - 1);
        Vec<d> u = particles.velocity.row(p).matrix().transpose();
        u[0] -= simulation.box.flow_velocity(y);
        square.sum(bin, block) += sum_of_squares(u);
        square.weight(bin, block) += 1.0;
    }
}

// [radial distribution]
template <int d>
void Recorder<d>::sample_radial_distribution(Simulation<d> const& simulation, Eigen::Index block) {
    wide_search_.find(simulation.particles, simulation.box, simulation.time, {}, wide_pairs_);
    Curve& g = record_.curves["radial_distribution"];
    auto const bins = static_cast<Eigen::Index>(g.x.size());
    double const per_range = double(bins) / wide_search_.cutoff;
    auto const n = double(simulation.particles.size());
    double const pairs_per_volume = 0.5 * n * (n - 1.0) / simulation.box.volume();
    double const unit_ball = d == 2 ? std::numbers::pi : 4.0 * std::numbers::pi / 3.0;
    for (std::size_t k = 0; k < wide_pairs_.count; ++k)
        g.sum(std::min(static_cast<Eigen::Index>(wide_pairs_.distance[k] * per_range), bins - 1), block) +=
            1.0;
    for (Eigen::Index bin = 0; bin < bins; ++bin)
        g.weight(bin, block) += pairs_per_volume * unit_ball *
                                (power(double(bin + 1) / per_range, d) - power(double(bin) / per_range, d));
}
// [radial distribution]

namespace {

// The 2l+1 real spherical harmonics of directions, in powers of their components and so without angles;
// normalized so that the squares of one direction sum to 1.
class Harmonics {
public:
    explicit Harmonics(int l) : l_(l) {
        for (int m = 0; m <= l; ++m) {
            double ratio = m == 0 ? 1.0 : 2.0;  // (l-m)!/(l+m)!, for m and -m
            for (int k = l - m + 1; k <= l + m; ++k) ratio /= k;
            norm_.push_back(std::sqrt(ratio));
        }
    }
    Eigen::ArrayXd operator()(double x, double y, double z) const {
        Eigen::ArrayXd result(2 * l_ + 1);
        double cosine = 1.0, sine = 0.0, first = 1.0;  // (x + iy)^m; (2m-1)!!
        for (int m = 0; m <= l_; ++m) {
            double before = 0.0, legendre = first;  // P_k^m(z) over (1 - z^2)^(m/2)
            for (int k = m + 1; k <= l_; ++k) {
                double const next = ((2 * k - 1) * z * legendre - (k + m - 1) * before) / (k - m);
                before = legendre;
                legendre = next;
            }
            double const scale = norm_[std::size_t(m)] * legendre;
            result[l_ - m] = scale * sine;
            result[l_ + m] = scale * cosine;
            double const turned = cosine * x - sine * y;
            sine = cosine * y + sine * x;
            cosine = turned;
            first *= 2 * m + 1;
        }
        return result;
    }

private:
    int l_;
    std::vector<double> norm_;
};

}  // namespace

BondOrder bond_order(Particles<3> const& particles, PairList<3> const& pairs, int l) {
    Harmonics const harmonics(l);
    Eigen::Index const rows = particles.size();
    Eigen::ArrayXXd sum = Eigen::ArrayXXd::Zero(2 * l + 1, rows);  // a column for each particle
    Eigen::ArrayXd bonds = Eigen::ArrayXd::Zero(rows), total = Eigen::ArrayXd::Zero(2 * l + 1);
    double total_bonds = 0.0;
    for (std::size_t k = 0; k < pairs.count; ++k) {
        Eigen::ArrayXd const y = harmonics(pairs.unit[0][k], pairs.unit[1][k], pairs.unit[2][k]);
        auto const i = pairs.i[k], j = pairs.j[k];
        sum.col(i) += y;
        sum.col(j) += y;  // even l: the same in both directions
        bonds[i] += 1.0;
        bonds[j] += 1.0;
        if (particles.frozen(i) || particles.frozen(j)) continue;
        total += y;
        total_bonds += 1.0;
    }
    auto const norm = [](auto const& q) { return std::sqrt(sum_of_squares(q)); };
    BondOrder order;
    if (total_bonds > 0.0) order.global = norm(total / total_bonds);
    for (Eigen::Index p = 0; p < rows; ++p)
        if (bonds[p] > 0.0) sum.col(p) /= bonds[p];
    Eigen::ArrayXXd average = sum;  // over a particle and its neighbours
    for (std::size_t k = 0; k < pairs.count; ++k) {
        average.col(pairs.i[k]) += sum.col(pairs.j[k]);
        average.col(pairs.j[k]) += sum.col(pairs.i[k]);
    }
    for (Eigen::Index p = 0; p < rows; ++p)
        if (!particles.frozen(p))
            order.local += norm(average.col(p) / (1.0 + bonds[p])) / double(particles.fluid);
    return order;
}

template <int d>
void Recorder<d>::sample_bond_order(Simulation<d> const& simulation) {
    if constexpr (d == 3) {
        bond_search_.find(simulation.particles, simulation.box, simulation.time, {}, wide_pairs_);
        auto& series = record_.series;
        for (int const l : {4, 6}) {
            auto const order = bond_order(simulation.particles, wide_pairs_, l);
            series[fmt::format("global_q{}", l)].push_back(order.global);
            series[fmt::format("local_q{}", l)].push_back(order.local);
        }
    }
}

template <int d>
template <class Value, class Product>
void Recorder<d>::correlate(Simulation<d> const& simulation, CorrelationParameters const& parameters,
                            std::string const& name, std::vector<Origin>& origins, Value value,
                            Product product) {
    std::uint64_t const step = simulation.step - parameters_.equilibration;
    if (step % parameters.spacing != 0) return;
    Field<d> by_row, now(simulation.particles.size(), d);
    value(by_row);
    for (Eigen::Index p = 0; p < by_row.rows(); ++p) now.row(simulation.particles.id[p]) = by_row.row(p);

    std::uint64_t const longest = parameters.spacing * parameters.lags;
    // an origin starts only where its last lag still fits into the run, and counts once that is reached, so
    // that all lags have equal weight
    if (step % parameters.origin_spacing == 0 && simulation.step + longest < parameters_.steps)
        origins.push_back({simulation.step, now, Eigen::ArrayXd::Zero(Eigen::Index(parameters.lags + 1))});
    for (auto& origin : origins) {
        auto const lag = static_cast<Eigen::Index>((simulation.step - origin.step) / parameters.spacing);
        origin.products[lag] = product(now, origin.value);
    }
    if (origins.empty() || simulation.step - origins.front().step < longest) return;
    Curve& curve = record_.curves[name];
    Eigen::Index const block = block_of(origins.front().step);
    curve.sum.col(block) += origins.front().products;
    curve.weight.col(block) += double(simulation.particles.fluid);
    origins.erase(origins.begin());
}

template <int d>
void Recorder<d>::archive_origins(Archive& archive, std::string const& name, std::vector<Origin>& origins) {
    std::uint64_t count = origins.size();
    archive("checkpoint/" + name + "/origins", count);
    if (count > parameters_.steps) archive.refuse("checkpoint/" + name + "/origins", "are more than steps");
    origins.resize(count);
    for (std::size_t o = 0; o < origins.size(); ++o) {
        archive(fmt::format("checkpoint/{}/{}/step", name, o), origins[o].step);
        archive(fmt::format("checkpoint/{}/{}/value", name, o), origins[o].value);
        archive(fmt::format("checkpoint/{}/{}/products", name, o), origins[o].products);
        if (origins[o].step < parameters_.equilibration || origins[o].step >= parameters_.steps ||
            origins[o].value.rows() != particles_ ||
            origins[o].products.size() != record_.curves.at(name).sum.rows())
            archive.refuse("checkpoint/" + name, "has an origin that is not of this run");
    }
}

// A record that was read has the bins and blocks of its scene, and as many samples of each observable.
template <int d>
void Recorder<d>::check(Archive const& archive, Record const& expected) const {
    auto const same_size = [](auto const& a, auto const& b) {
        return a.rows() == b.rows() && a.cols() == b.cols();
    };
    for (auto const& [name, curve] : record_.curves) {
        auto const& as = expected.curves.at(name);
        if (curve.x.size() != as.x.size() || !same_size(curve.sum, as.sum) ||
            !same_size(curve.weight, as.weight))
            archive.refuse("observables/" + name, "has not the bins of the scene");
    }
    std::optional<std::size_t> samples;
    for_each_series([&](auto const& row) {
        auto const found = record_.series.find(row.name);
        if (found == record_.series.end()) return;
        if (samples.value_or(found->second.size()) != found->second.size())
            archive.refuse("observables/" + found->first, "has not as many samples as the others");
        samples = found->second.size();
    });
    if (!same_size(record_.configuration, expected.configuration))
        archive.refuse("observables/configuration", "is not one position per particle");
}

template <int d>
void Recorder<d>::finish() {
    displacement_origins_.clear();
    velocity_origins_.clear();
}

template <int d>
void Recorder<d>::archive(Archive& archive) {
    if (archive.reading()) {
        Record const expected = record_;
        record_.archive(archive);
        check(archive, expected);
    } else {
        record_.archive(archive);
        for (auto const& [name, values] : record_.series)
            archive.describe_time("observables/" + name, parameters_.equilibration, parameters_.interval,
                                  time_step_);
    }
    archive("checkpoint/blocks/span", span_);
    if (span_ == 0 || production() % span_ != 0 || !std::has_single_bit(production() / span_))
        archive.refuse("checkpoint/blocks/span", "is not that of a run of this length");
    if (parameters_.mean_square_displacement)
        archive_origins(archive, "mean_square_displacement", displacement_origins_);
    if (parameters_.velocity_autocorrelation)
        archive_origins(archive, "velocity_autocorrelation", velocity_origins_);
}

template class Recorder<2>;
template class Recorder<3>;

}  // namespace dpd
