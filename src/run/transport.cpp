#include "transport.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include "records.hpp"
#include "sums.hpp"

namespace dpd {

namespace {

// Neighbouring blocks joined until each has so many origins (times particles); what is left over goes to the
// last one.
Curve joined(Curve const& curve, double origins) {
    Curve result = curve;
    result.sum.setZero();
    result.weight.setZero();
    Eigen::Index const longest = curve.weight.rows() - 1;
    Eigen::Index to = 0;
    double left = sum_of(curve.weight.row(longest));
    for (Eigen::Index block = 0; block < curve.sum.cols(); ++block) {
        result.sum.col(to) += curve.sum.col(block);
        result.weight.col(to) += curve.weight.col(block);
        left -= curve.weight(longest, block);
        if (result.weight(longest, to) >= origins && left >= origins) ++to;
    }
    return result;
}

}  // namespace

// Displacements that start up to half a longest lag L apart share increments, which for a random walk makes
// the variance between blocks of duration B smaller by 5/32 L/B (docs/measuring.md). [diffusion]
Estimate diffusion_constant(Scene const& scene, std::vector<Record> const& records) {
    auto const curves = curves_of(records, "mean_square_displacement");
    if (curves.empty()) return {};
    CorrelationParameters const& lags = scene.sample.mean_square_displacement.value();
    double const in_longest_lag =
        double(scene.particles) * double(lags.spacing * lags.lags / lags.origin_spacing);
    std::vector<Curve> blocks;
    double origins = 0.0;
    for (auto const* curve : curves) {
        blocks.push_back(joined(*curve, in_longest_lag));
        origins += sum_of(curve->weight.bottomRows<1>());
    }
    std::vector<Curve const*> pointers;
    for (auto const& curve : blocks) pointers.push_back(&curve);
    Estimate result = by_block(pointers, [&](Curve const& curve, Eigen::ArrayXd const& mean) {
        auto const last = mean.size() - 1, first = last / 2;
        return (mean[last] - mean[first]) / (2.0 * diffusing_components(scene) *
                                             (curve.x[std::size_t(last)] - curve.x[std::size_t(first)]));
    });
    // whole runs share nothing
    if (result.blocks > curves.size())
        result.error /= std::sqrt(1.0 - 5.0 / 32.0 * in_longest_lag * double(result.blocks) / origins);
    return result;
}
// [diffusion]

// Least-squares slope of the velocity profile over the imposed shear rate.
double relative_slope(Curve const& curve, Eigen::ArrayXd const& mean, double shear_rate) {
    Eigen::Map<Eigen::ArrayXd const> const y(curve.x.data(), mean.size());
    Eigen::ArrayXd const centred = y - mean_of(y);
    return sum_of(centred * mean) / sum_of_squares(centred) / shear_rate;
}

Estimate of_profile(Scene const& scene, std::vector<Record> const& records, double width, double viscosity,
                    Estimate const& of_blocks) {
    auto const profiles = curves_of(records, "velocity_profile");
    double samples = 0.0, blocks = 0.0;  // of all runs
    for (Curve const* const profile : profiles) {
        samples += sum_of(profile->weight.rowwise().sum()) / double(scene.particles);
        blocks += double((profile->weight.colwise().sum() > 0.0).count());
    }
    if (!scene.sample.profile || !(viscosity > 0.0) || blocks == 0.0) return of_blocks;
    double const block = samples / blocks * double(scene.sample.profile->interval) * scene.time_step;
    double const lifetime =
        scene.density() * scene.mass * width * width / (std::numbers::pi * std::numbers::pi * viscosity);
    return of_slow_mode(of_blocks, profiles.size(), block / lifetime);
}

std::vector<Curve> temperature_profiles(Scene const& scene, std::vector<Record> const& records) {
    std::vector<Curve> profiles;
    auto const velocities = curves_of(records, "velocity_profile");
    for (Curve const* const square : curves_of(records, "velocity_squared_profile")) {
        Curve const& velocity = *velocities[profiles.size()];
        Curve profile = *square;
        Eigen::Map<Eigen::ArrayXd const> const y(profile.x.data(), profile.sum.rows());
        for (Eigen::Index block = 0; block < profile.sum.cols(); ++block) {
            Eigen::ArrayXd const flow = velocity.sum.col(block) / velocity.weight.col(block) -
                                        scene.shear_rate * (y - 0.5 * scene.length[1]);
            profile.sum.col(block) = scene.mass / scene.dimension *
                                     (profile.sum.col(block) / profile.weight.col(block) - flow.square());
            profile.weight.col(block) = (profile.weight.col(block) > 0.0).cast<double>();
        }
        profile.sum = (profile.weight > 0.0).select(profile.sum, 0.0);
        profiles.push_back(std::move(profile));
    }
    return profiles;
}

namespace {

// The mean square of a stress summed over a window of time, for every start of it and each eighth of the
// series: <G^2>, G(t) = dt sum of sigma. It grows as 2 kT eta t/V once t exceeds the memory of the stress.
std::vector<double> mean_square_impulse(std::vector<double> const& stress, double dt, std::size_t window) {
    std::vector<double> means;
    std::size_t const length = stress.size() / curve_blocks;
    for (std::size_t block = 0; block < curve_blocks && length > window; ++block) {
        auto const from = stress.begin() + std::ptrdiff_t(block * length);
        double impulse = dt * std::accumulate(from, from + std::ptrdiff_t(window), 0.0), sum = 0.0;
        std::size_t const origins = length - window;
        for (std::size_t k = 0; k < origins; ++k) {
            sum += impulse * impulse;
            impulse += dt * (from[std::ptrdiff_t(k + window)] - from[std::ptrdiff_t(k)]);
        }
        means.push_back(sum / double(origins));
    }
    return means;
}

// The stress that all of the fluid carries, the pairs' noise included, at each step of a run.
std::vector<double> total_stress(Record const& record) {
    std::vector<double> total = record.series.at("kinetic_stress");
    for (char const* name : {"collision_stress", "potential_stress"})
        if (auto const part = record.series.find(name); part != record.series.end())
            for (std::size_t k = 0; k < total.size(); ++k) total[k] += part->second[k];
    return total;
}

}  // namespace

// The shear viscosity of a fluid at rest from the growth of <G^2> over the second half of the window. The
// stress counts whole impulses, noise too, so that it is the momentum that crosses planes in a step and no
// term has to be added by hand, as it has to where forces are sampled at an instant (M. H. Ernst & R. Brito,
// Europhys. Lett. 73 (2006) 183). E. Helfand, Phys. Rev. 119 (1960) 1.
// [green kubo]
Estimate green_kubo_viscosity(Scene const& scene, std::vector<Record> const& records) {
    std::size_t const window = scene.sample.green_kubo_window;
    double const per_time = scene.volume() / (scene.thermostat_kT() * double(window) * scene.time_step);
    std::vector<std::vector<double>> runs;
    for (auto const& record : records) {
        auto& values = runs.emplace_back();
        auto const stress = total_stress(record);
        auto const whole = mean_square_impulse(stress, scene.time_step, window),
                   half = mean_square_impulse(stress, scene.time_step, window / 2);
        for (std::size_t block = 0; block < whole.size(); ++block)
            values.push_back((whole[block] - half[block]) * per_time);
    }
    return pool(runs);
}
// [green kubo]

}  // namespace dpd
