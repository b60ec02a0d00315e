#include "integrals_of_g.hpp"

#include "records.hpp"
#include "theory/closed_forms.hpp"

namespace dpd {

void add_integrals_of_g(Scene const& scene, std::vector<Record> const& records, AddQuantity const& add) {
    auto const curves = curves_of(records, "radial_distribution");
    auto const over_g = [&](auto&& f) {
        return by_block(curves, [&](Curve const& curve, Eigen::ArrayXd const& mean) {
            double const width = 2.0 * curve.x[0];
            return f([&](double r) {
                auto const bin = static_cast<Eigen::Index>(r / width);
                return bin < mean.size() ? mean[bin] : 1.0;
            });
        });
    };
    theory::Gas gas{.d = scene.dimension, .n = scene.density(), .m = scene.mass, .kT = scene.thermostat_kT()};
    if (auto const* const s1 = scene.stage<Shardlow>(); s1 && s1->friction > 0.0) {
        gas.rc = s1->cutoff;
        theory::Shardlow const thermostat{.gamma = s1->friction, .weight = s1->weight, .scheme = s1->scheme};
        add("dpd_relaxation_rate",
            over_g([&](auto const& g) { return theory::relaxation_rate(gas, thermostat, g); }));
        add("collision_viscosity_by_g", over_g([&](auto const& g) {
                return theory::collision_viscosity(gas, thermostat, scene.time_step, g);
            }));
    }
    auto const* const repulsion = scene.soft();
    if (repulsion && repulsion->strength > 0.0 && gas.kT > 0.0) {
        gas.rc = repulsion->cutoff;
        theory::Soft const soft{.a = repulsion->strength / gas.kT};
        double const a = repulsion->strength / repulsion->cutoff;
        add("pressure_by_g", over_g([&](auto const& g) { return theory::virial_pressure(gas, a, g); }));
        add("speed_of_sound_by_g",
            over_g([&](auto const& g) { return theory::virial_sound_speed(gas, a, g); }));
        add("repulsion_constant", over_g([&](auto const& g) { return theory::repulsion_constant(gas, g); }));
        add("potential_viscosity_per_rate",
            over_g([&](auto const& g) { return theory::potential_viscosity(gas, soft, 1.0, g); }));
    }
}

}  // namespace dpd
