#include "channel.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <map>

#include "elementary.hpp"
#include "records.hpp"
#include "sums.hpp"
#include "theory/closed_forms.hpp"
#include "transport.hpp"

namespace dpd {
namespace {

// One bin of a plane Poiseuille flow: height above the lower wall, and the direction in which the fluid is
// driven.
struct ChannelBin {
    Eigen::Index bin;
    double z, direction;
};

// The bins of a profile that lie in the channel: between walls, or in one of two opposed flows, each half a
// box wide. None without a flow.
std::vector<ChannelBin> channel_bins(Scene const& scene, Curve const& profile) {
    std::vector<ChannelBin> bins;
    if (!scene.stage<BodyForce>() || (scene.wall == 0.0 && !scene.opposed_flows())) return bins;
    double const width = scene.channel_width();
    for (std::size_t b = 0; b < profile.x.size(); ++b) {
        bool const upper = scene.opposed_flows() && profile.x[b] >= width;
        double const z = upper ? profile.x[b] - width : profile.x[b] - scene.wall;
        if (z > 0.0 && z < width) bins.push_back({Eigen::Index(b), z, upper ? -1.0 : 1.0});
    }
    return bins;
}

// Least squares: c of u = c f.
double fit(Eigen::ArrayXd const& f, Eigen::ArrayXd const& u) { return sum_of(f * u) / sum_of_squares(f); }

// Least squares: slope and value at f = 0 of a straight line in f.
struct Line {
    double slope, offset;
};
Line fit_line(Eigen::ArrayXd const& f, Eigen::ArrayXd const& u) {
    double const mean = mean_of(f);
    double const slope = fit(f - mean, u);
    return {slope, mean_of(u) - slope * mean};
}

// The power-law profile that fits best; index 1 is the parabola. PK2006 sect. IV.
struct PowerLaw {
    double maximum = 0.0, index = 1.0;
};
PowerLaw fit_power_law(Eigen::ArrayXd const& z, Eigen::ArrayXd const& u, double width) {
    auto const shape = [&](double index) -> Eigen::ArrayXd {
        return z.unaryExpr(
            [=](double height) { return theory::power_law_velocity(1.0, index, width, height); });
    };
    constexpr double least = 0.05, most = 20.0;
    constexpr int bits = 24;  // of a minimum that is flat: more is noise
    auto const [log_index, residual] = boost::math::tools::brent_find_minima(
        [&](double x) {
            Eigen::ArrayXd const f = shape(exponential(x));
            return sum_of_squares(u - fit(f, u) * f);
        },
        logarithm(least), logarithm(most), bits);
    static_cast<void>(residual);
    double const index = exponential(log_index);
    return {fit(shape(index), u), index};
}

}  // namespace

void add_channel(Scene const& scene, std::vector<Record> const& records, AddQuantity const& add) {
    auto const velocities = curves_of(records, "velocity_profile");
    auto const densities = curves_of(records, "density_profile");
    if (velocities.empty()) return;
    double const width = scene.channel_width(), n = scene.density();
    auto const bins = channel_bins(scene, *velocities.front());
    auto const* const driven = scene.stage<BodyForce>();
    if (bins.size() < 4 || !driven || driven->acceleration == 0.0) return;
    auto const size = static_cast<Eigen::Index>(bins.size());
    Eigen::ArrayXd z(size);
    for (Eigen::Index k = 0; k < size; ++k) z[k] = bins[std::size_t(k)].z;
    Eigen::ArrayXd const parabola = z * (width - z);
    double const force = scene.mass * driven->acceleration;

    // f(profile in the direction of the flow), for each block
    auto const over = [&](std::vector<Curve const*> const& curves, bool directed, auto&& f) {
        std::vector<std::vector<double>> runs;
        for (Curve const* const curve : curves) {
            auto& values = runs.emplace_back();
            for (Eigen::Index block = 0; block < curve->sum.cols(); ++block) {
                Eigen::ArrayXd u(size);
                bool whole = true;
                for (Eigen::Index k = 0; k < size; ++k) {
                    auto const& at = bins[std::size_t(k)];
                    double const weight = curve->weight(at.bin, block);
                    whole &= weight > 0.0;
                    u[k] = (directed ? at.direction : 1.0) * curve->sum(at.bin, block) / weight;
                }
                if (whole) values.push_back(f(u));
            }
        }
        return pool(runs);
    };
    Estimate const viscosity =
        over(velocities, true, [&](Eigen::ArrayXd const& u) { return n * force / (2.0 * fit(parabola, u)); });
    auto const of_flow = [&](auto&& f) {
        return of_profile(scene, records, width, viscosity.value, over(velocities, true, f));
    };
    add("poiseuille_viscosity", of_profile(scene, records, width, viscosity.value, viscosity));
    Estimate const fastest =
        of_flow([&](Eigen::ArrayXd const& u) { return fit_power_law(z, u, width).maximum; });
    add("maximum_velocity", fastest);
    // the mode changes the profile's height, hardly its shape, nor what the parabola leaves at the wall
    add("power_law_index",
        over(velocities, true, [&](Eigen::ArrayXd const& u) { return fit_power_law(z, u, width).index; }));
    add("slip", over(velocities, true, [&](Eigen::ArrayXd const& u) {
            auto const line = fit_line(parabola, u);
            return line.offset / (line.slope * width * width / 4.0);
        }));
    add("bulk_density", over(densities, false, [&](Eigen::ArrayXd const& density) {
            double sum = 0.0, count = 0.0;
            for (Eigen::Index k = 0; k < size; ++k)
                if (std::abs(z[k] / width - 0.5) < 0.25) sum += density[k], count += 1.0;
            return sum / (count * n);
        }));
    add("density_peak",
        over(densities, false, [&](Eigen::ArrayXd const& density) { return density.maxCoeff() / n; }));
    if (!scene.coarse_graining || scene.coarse_graining->viscosity == 0.0) return;
    double const eta = scene.coarse_graining->viscosity;
    Eigen::ArrayXd expected(size);
    for (Eigen::Index k = 0; k < size; ++k)
        expected[k] = theory::poiseuille_velocity(n, force, eta, width, z[k]);
    double const maximum = theory::poiseuille_maximum_velocity(n, force, eta, width);
    add("navier_stokes_deviation", of_flow([&](Eigen::ArrayXd const& u) {
            return std::sqrt(sum_of_squares(u - expected) / double(size)) / maximum;
        }));
    auto const fastest_over = [&](double speed) {
        Estimate ratio = fastest;
        ratio.value /= speed;
        ratio.error /= speed;
        return ratio;
    };
    add("navier_stokes_ratio", fastest_over(maximum));
    theory::CoarseGraining const map{.Nm = scene.coarse_graining->atoms_per_particle};
    double const kT = scene.thermostat_kT();
    add("mach_number",
        fastest_over(theory::groot_warren_sound_speed({.n = n, .m = scene.mass, .kT = kT},
                                                      theory::conservative_coefficient(map, kT), map.alpha)));
}

Curve channel_profile(Scene const& scene, Curve const& velocity) {
    double length = 1.0, speed = 1.0;
    if (scene.coarse_graining && scene.coarse_graining->viscosity > 0.0) {
        theory::CoarseGraining const map{.Nm = scene.coarse_graining->atoms_per_particle};
        length = theory::cutoff_radius(map);
        speed = length / theory::time_unit(map, scene.coarse_graining->viscosity);
    }
    std::map<double, std::vector<ChannelBin>> by_height;
    for (auto const& bin : channel_bins(scene, velocity))
        by_height[std::round(bin.z * 1e9) * 1e-9].push_back(bin);
    Curve profile;
    profile.resize(by_height.size());
    Eigen::Index to = 0;
    for (auto const& [z, bins] : by_height) {
        profile.x[std::size_t(to)] = z * length;
        for (auto const& from : bins) {
            profile.sum.row(to) += from.direction * speed * velocity.sum.row(from.bin);
            profile.weight.row(to) += velocity.weight.row(from.bin);
        }
        ++to;
    }
    return profile;
}

}  // namespace dpd
