#include "analysis.hpp"

#include <algorithm>
#include <cmath>

#include "channel.hpp"
#include "elementary.hpp"
#include "integrals_of_g.hpp"
#include "records.hpp"
#include "sums.hpp"
#include "transport.hpp"

namespace dpd {

namespace {

double largest_of(std::vector<std::vector<double>> const& series) {
    double largest = 0.0;
    for (auto const& run : series)
        for (double const value : run) largest = std::max(largest, value);
    return largest;
}

}  // namespace

std::vector<Quantity> analyze(Scene const& scene, std::vector<Record> const& records) {
    std::vector<Quantity> quantities;
    auto const add = [&](std::string name, Estimate estimate) {
        if (estimate.blocks > 0) quantities.push_back({std::move(name), estimate});
    };
    for_each_series([&](auto const& row) {
        std::string const name(row.name);
        auto const series = series_of(records, name);
        if (row.analysis == Analysis::mean) add(name, combine(series));
        if (row.analysis == Analysis::largest && !series.empty())
            add("largest_" + name, {.value = largest_of(series), .error = 0.0, .blocks = 1});
    });
    add("configurational_temperature",
        ratio_of(series_of(records, "force_squared"), series_of(records, "laplacian")));

    auto kinetic = series_of(records, "kinetic_stress"), collision = series_of(records, "collision_stress"),
         potential = series_of(records, "potential_stress");
    // the same mean with a smaller error
    if (auto friction = series_of(records, "friction_stress"); !friction.empty()) collision = friction;
    if (scene.shear_rate != 0.0) {
        auto total = kinetic, rest = kinetic;
        for (std::size_t r = 0; r < total.size(); ++r)
            for (std::size_t k = 0; k < total[r].size(); ++k) {
                kinetic[r][k] /= scene.shear_rate;
                collision[r][k] /= scene.shear_rate;
                rest[r][k] = collision[r][k];
                if (!potential.empty()) rest[r][k] += potential[r][k] /= scene.shear_rate;
                total[r][k] = kinetic[r][k] + rest[r][k];
            }
        add("kinetic_viscosity", combine(kinetic));
        add("collision_viscosity", combine(collision));
        add("potential_viscosity", combine(potential));
        add("viscosity", combine(total));
        // of what pairs carry over what particles carry
        add("viscosity_ratio", ratio_of(rest, kinetic));
    } else {
        add("kinetic_stress", combine(kinetic));
        add("collision_stress", combine(collision));
        add("potential_stress", combine(potential));
    }
    if (scene.sample.green_kubo_window > 0) add("green_kubo_viscosity", green_kubo_viscosity(scene, records));
    if (scene.shear_rate != 0.0) {
        Quantity const* const viscosity = find_quantity(quantities, "viscosity");
        add("profile_slope",
            of_profile(
                scene, records, 0.5 * scene.length[1], viscosity ? viscosity->estimate.value : 0.0,
                by_block(curves_of(records, "velocity_profile"), [&](auto const& curve, auto const& mean) {
                    return relative_slope(curve, mean, scene.shear_rate);
                })));
    }
    add("pair_density",
        by_block(curves_of(records, "radial_distribution"), [&](auto const& curve, auto const& mean) {
            // share of pairs within the range over that of a uniform gas
            double found = 0.0, uniform = 0.0;
            for (Eigen::Index bin = 0; bin < mean.size(); ++bin) {
                double const shell =
                    power(double(bin + 1), scene.dimension) - power(double(bin), scene.dimension);
                found += mean[bin] * shell;
                uniform += shell;
            }
            static_cast<void>(curve);
            return found / uniform;
        }));
    add("diffusion_constant", diffusion_constant(scene, records));
    int const components = diffusing_components(scene);
    add("green_kubo_diffusion_constant",
        by_block(curves_of(records, "velocity_autocorrelation"), [&](auto const& curve, auto const& mean) {
            // the trapezium rule is exact for free streaming in steps of the spacing
            return (sum_of(mean) - 0.5 * mean[0] - 0.5 * mean[mean.size() - 1]) * (curve.x[1] - curve.x[0]) /
                   components;
        }));
    // first moment over the square of the integral: 1 for an exponential
    add("correlation_moment",
        by_block(curves_of(records, "velocity_autocorrelation"), [&](auto const& curve, auto const& mean) {
            Eigen::Map<Eigen::ArrayXd const> const t(curve.x.data(), mean.size());
            double const integral = sum_of(mean) - 0.5 * mean[0] - 0.5 * mean[mean.size() - 1];
            return mean[0] * sum_of(t * mean) / (t[1] * integral * integral);
        }));
    std::vector<Curve> const temperatures = temperature_profiles(scene, records);
    std::vector<Curve const*> profiles;
    for (auto const& profile : temperatures) profiles.push_back(&profile);
    add("profile_temperature",
        by_block(profiles, [](auto const&, auto const& mean) { return mean_of(mean); }));
    // share of cos(4 pi y/L), along which two opposed flows dissipate
    add("temperature_modulation", by_block(profiles, [&](auto const& curve, auto const& mean) {
            double share = 0.0;
            for (Eigen::Index bin = 0; bin < mean.size(); ++bin)
                share += mean[bin] * cosine_of_turn(2.0 * curve.x[std::size_t(bin)] / scene.length[1]);
            return 2.0 * share / sum_of(mean);
        }));
    for (char const* name : {"global_q4", "local_q4", "global_q6", "local_q6"})
        add(name, combine(series_of(records, name)));
    add_channel(scene, records, add);
    // In a driven flow this temperature counts the flow's energy, too: a small part of its fluctuations, but
    // as slow as the flow, so that blocking sees it late. Its error is made as those of the velocity profile
    // are.
    if (Quantity const* const viscosity = find_quantity(quantities, "poiseuille_viscosity"))
        for (auto& [name, estimate] : quantities)
            if (name == "kinetic_temperature") {
                auto runs = series_of(records, name);
                for (auto& run : runs) run = equal_blocks(run, std::size_t(curve_blocks));
                Estimate slow =
                    of_profile(scene, records, scene.channel_width(), viscosity->estimate.value, pool(runs));
                slow.value = estimate.value;
                if (slow.blocks > 0) estimate = slow;
            }
    add_integrals_of_g(scene, records, add);
    return quantities;
}

CurveEstimate curve_of(Scene const& scene, std::vector<Record> const& records, std::string const& name) {
    std::vector<Curve> derived =
        name == "temperature_profile" ? temperature_profiles(scene, records) : std::vector<Curve>{};
    if (name == "channel_profile")
        for (Curve const* const velocity : curves_of(records, "velocity_profile"))
            derived.push_back(channel_profile(scene, *velocity));
    auto curves = curves_of(records, name);
    for (auto const& curve : derived) curves.push_back(&curve);
    CurveEstimate result;
    if (curves.empty()) return result;
    result.x = curves.front()->x;
    double const components = name == "velocity_autocorrelation" ? diffusing_components(scene) : 1.0;
    for (std::size_t bin = 0; bin < result.x.size(); ++bin) {
        std::vector<std::vector<double>> runs;
        for (Curve const* const curve : curves) {
            runs.push_back(curve->block_means(Eigen::Index(bin)));
            for (double& mean : runs.back()) mean /= components;
        }
        result.y.push_back(pool(runs));
    }
    return result;
}

Quantity const* find_quantity(std::vector<Quantity> const& quantities, std::string_view name) {
    auto const found =
        std::find_if(quantities.begin(), quantities.end(), [&](auto const& q) { return q.name == name; });
    return found == quantities.end() ? nullptr : &*found;
}

}  // namespace dpd
