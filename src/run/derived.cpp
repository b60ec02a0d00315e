#include "derived.hpp"

#include <algorithm>
#include <cmath>

#include "elementary.hpp"
#include "theory/closed_forms.hpp"

namespace dpd {
namespace {

Estimate estimate_of(std::vector<Quantity> const& quantities, std::string_view name) {
    Quantity const* const found = find_quantity(quantities, name);
    return found ? found->estimate : Estimate{};
}

// Adds f(arguments) where all arguments are known; its error from theirs, taken as independent, by finite
// differences.
template <class F>
void add_function(std::vector<Quantity>& quantities, std::string name, std::vector<Estimate> const& arguments,
                  F&& f) {
    if (find_quantity(quantities, name)) return;
    Estimate result;
    std::vector<double> at;
    for (auto const& argument : arguments) {
        if (argument.blocks == 0) return;
        at.push_back(argument.value);
        result.blocks = at.size() == 1 ? argument.blocks : std::min(result.blocks, argument.blocks);
    }
    result.value = f(at);
    double variance = 0.0;
    for (std::size_t a = 0; a < at.size(); ++a) {
        auto shifted = at;
        shifted[a] += arguments[a].error;
        variance += power(f(shifted) - result.value, 2);
    }
    result.error = std::sqrt(variance);
    quantities.push_back({std::move(name), result});
}

}  // namespace

void add_function(std::vector<Quantity>& quantities, std::string name,
                  std::vector<std::string> const& arguments,
                  std::function<double(std::vector<double> const&)> const& f) {
    std::vector<Estimate> estimates;
    for (auto const& argument : arguments) estimates.push_back(estimate_of(quantities, argument));
    add_function(quantities, std::move(name), estimates, f);
}

void derive(Scene const& scene, std::vector<Quantity>& quantities) {
    auto const value = [&](std::string_view name) { return estimate_of(quantities, name); };
    double const n = scene.density(), kT = scene.thermostat_kT();
    add_function(quantities, "potential_relaxation_rate",
                 {value("potential_viscosity"), value("potential_viscosity_per_rate")},
                 [](auto const& x) { return x[0] / x[1]; });
    add_function(quantities, "kinetic_viscosity_by_rates",
                 {value("potential_relaxation_rate"), value("dpd_relaxation_rate")},
                 [&](auto const& x) { return theory::kinetic_viscosity(n, kT, x[0], x[1]); });
    add_function(quantities, "schmidt_number", {value("viscosity"), value("diffusion_constant")},
                 [&](auto const& x) { return x[0] / (n * scene.mass * x[1]); });
    if (!scene.coarse_graining) return;
    // eq. 4 with the viscosity that was measured
    theory::CoarseGraining const map{.Nm = scene.coarse_graining->atoms_per_particle};
    theory::Channel const channel;
    add_function(quantities, "time_unit", {value("viscosity")},
                 [&](auto const& x) { return theory::time_unit(map, x[0]); });
    add_function(quantities, "predicted_velocity", {value("viscosity")}, [&](auto const& x) {
        return theory::poiseuille_maximum_velocity(map.n,
                                                   theory::force_in_dpd_units(map, x[0], channel.force), x[0],
                                                   theory::length_in_dpd_units(map, channel.width));
    });
    add_function(quantities, "predicted_mach_number", {value("viscosity")}, [&](auto const& x) {
        return theory::mach_number(map, x[0], kT, channel.force, channel.width);
    });
    if (scene.coarse_graining->force > 0.0)
        add_function(quantities, "force_ratio", {value("viscosity")}, [&](auto const& x) {
            return scene.mass * scene.stage<BodyForce>()->acceleration /
                   theory::force_in_dpd_units(map, x[0], scene.coarse_graining->force);
        });
}

void derive_from_densities(Scene const& scene, double densities, Estimate const& below, Estimate const& above,
                           std::vector<Quantity>& quantities) {
    double const kT = scene.thermostat_kT();
    add_function(quantities, "pressure_slope", {below, above},
                 [&](auto const& x) { return (x[1] - x[0]) / densities; });
    Estimate const slope = estimate_of(quantities, "pressure_slope");
    add_function(quantities, "inverse_compressibility", {slope}, [&](auto const& x) { return x[0] / kT; });
    if (scene.coarse_graining)
        add_function(quantities, "inverse_compressibility_per_atom", {slope},
                     [&](auto const& x) { return x[0] / (kT * scene.coarse_graining->atoms_per_particle); });
    add_function(quantities, "speed_of_sound", {slope},
                 [&](auto const& x) { return std::sqrt(std::max(0.0, x[0]) / scene.mass); });
}

void derive_at_lag(Scene const& scene, std::vector<Quantity>& quantities, double t) {
    auto const value = [&](std::string_view name) { return estimate_of(quantities, name); };
    double const kT = scene.thermostat_kT(), m = scene.mass;
    add_function(quantities, "exponential_decay", {value("green_kubo_diffusion_constant")},
                 [&](auto const& x) { return kT / m * std::exp(-t * kT / (m * x[0])); });
    bool const cube = std::all_of(scene.length.begin(), scene.length.end(),
                                  [&](double side) { return side == scene.length.front(); });
    if (!cube || t <= 0.0) return;
    theory::Gas const gas{.d = scene.dimension, .n = scene.density(), .m = m, .kT = kT};
    add_function(quantities, "hydrodynamic_tail",
                 {value("viscosity"), value("green_kubo_diffusion_constant")}, [&](auto const& x) {
                     return theory::velocity_autocorrelation_tail_in_box(gas, x[0], x[1],
                                                                         scene.length.front(), t);
                 });
}

}  // namespace dpd
