// Marsh & Yeomans 1997: the temperature of explicit DPD at finite step; derived in theory/MY1997.md.

#include <stdexcept>

#include "integrals.hpp"
#include "rows.hpp"

namespace dpd::theory {
namespace {

void require_matched(ExplicitDpd const& fluid, double dt) {
    require_positive({{"n", fluid.n}, {"dt", dt}});
    if (fluid.random_weight)
        throw std::domain_error(
            "frozen neighbours have one temperature for matched weights only, w_R^2 = w_D");
}

}  // namespace

// [explicit integrals]
double A1(ExplicitDpd const& fluid) {
    require_positive({{"m", fluid.m}, {"gamma", fluid.gamma}});
    return fluid.gamma * integral_of_weight(fluid.d, fluid.rc, fluid.weight) / (fluid.m * fluid.d);
}

double A2(ExplicitDpd const& fluid) {
    require_positive({{"m", fluid.m}, {"gamma", fluid.gamma}});
    return 2.0 * square(fluid.gamma / fluid.m) * integral_of_squared_weight(fluid.d, fluid.rc, fluid.weight) /
           fluid.d;
}

double A3(ExplicitDpd const& fluid) {
    require_positive({{"sigma", fluid.sigma}});
    double const w_R2 = fluid.random_weight
                            ? integral_of_squared_weight(fluid.d, fluid.rc, *fluid.random_weight)
                            : integral_of_weight(fluid.d, fluid.rc, fluid.weight);
    return square(fluid.sigma) * w_R2 / fluid.d;
}
// [explicit integrals]

// [explicit temperature]
double temperature_at_finite_step(ExplicitDpd const& fluid, double dt) {
    require_positive({{"n", fluid.n}, {"dt", dt}});
    double const a1 = A1(fluid);
    double const damping = a1 * (2.0 - a1 * fluid.n * dt) - A2(fluid) * dt;
    if (!(damping > 0.0))
        throw std::domain_error("no temperature: the step dt is at or beyond the critical step " +
                                std::to_string(critical_step(fluid)) + " (my25)");
    return A3(fluid) / (fluid.m * damping);
}
// [explicit temperature]

// [frozen neighbours]
double temperature_with_frozen_neighbours(ExplicitDpd const& fluid, double dt) {
    require_matched(fluid, dt);
    double const a1 = A1(fluid);
    return A3(fluid) / (2.0 * fluid.m * a1) * (1.0 + 0.5 * fluid.n * a1 * dt);
}

double temperature_of_the_mean_mode(ExplicitDpd const& fluid, double dt) {
    require_matched(fluid, dt);
    double const a1 = A1(fluid), left = 1.0 - 0.5 * fluid.n * a1 * dt;
    if (!(left > 0.0)) throw std::domain_error("no temperature: the mean mode is unstable, n A1 dt >= 2");
    return A3(fluid) / (2.0 * fluid.m * a1 * left);
}
// [frozen neighbours]

// [critical]
double critical_step(ExplicitDpd const& fluid) {
    require_positive({{"n", fluid.n}});
    double const a1 = A1(fluid);
    return 2.0 * a1 / (fluid.n * a1 * a1 + A2(fluid));
}

double critical_density(ExplicitDpd const& fluid, double dt) {
    require_positive({{"dt", dt}});
    double const a1 = A1(fluid);
    double const a2 = A2(fluid);
    double const density = (2.0 * a1 - a2 * dt) / (a1 * a1 * dt);
    if (!(density > 0.0))
        throw std::domain_error("no critical density: at or beyond the step 2 A1/A2 = " +
                                std::to_string(2.0 * a1 / a2) + " no density is stable");
    return density;
}
// [critical]

// --- the rows of the registry ------------------------------------------------------------------------------

namespace {

ExplicitDpd explicit_dpd(Arguments const& a, double n, double sigma) {
    return {.d = a.d(),
            .n = n,
            .m = a["m"],
            .gamma = a["gamma"],
            .sigma = sigma,
            .rc = a["rc"],
            .weight = a.weight(),
            .random_weight = a.random_weight()};
}

// Temperature.
std::vector<ClosedForm> temperature_rows() {
    return {
        {"my22",
         "MY1997",
         "22",
         "temperature kT of explicit DPD at finite step",
         "A3/(m (A1 (2 - A1 n dt) - A2 dt))",
         {"d", "n", "m", "gamma", "sigma", "rc", "dt", "weight", "exponent", "random_weight"},
         {},
         [](Arguments const& a) {
             return temperature_at_finite_step(explicit_dpd(a, a["n"], a["sigma"]), a["dt"]);
         }},
        {"my22-frozen",
         "MY1997",
         "22, frozen",
         "kT if neighbours never change, first order",
         "A3/(2 m A1) (1 + n A1 dt/2)",
         {"d", "n", "m", "gamma", "sigma", "rc", "dt", "weight", "exponent"},
         {},
         [](Arguments const& a) {
             return temperature_with_frozen_neighbours(explicit_dpd(a, a["n"], a["sigma"]), a["dt"]);
         }},
        {"my22-mean-mode",
         "MY1997",
         "22, mean mode",
         "kT of a mode of the mean rate, bound of both limits",
         "A3/(2 m A1 (1 - n A1 dt/2))",
         {"d", "n", "m", "gamma", "sigma", "rc", "dt", "weight", "exponent"},
         {},
         [](Arguments const& a) {
             return temperature_of_the_mean_mode(explicit_dpd(a, a["n"], a["sigma"]), a["dt"]);
         }},
    };
}

// The integrals that it is made of.
std::vector<ClosedForm> integral_rows() {
    return {
        {"my23-A1",
         "MY1997",
         "23",
         "A1, decay rate of a momentum per density",
         "gamma [w_D]/(m d)",
         {"d", "m", "gamma", "rc", "weight", "exponent"},
         {"n", "sigma", "dt", "random_weight"},
         [](Arguments const& a) { return A1(explicit_dpd(a, unused, unused)); }},
        {"my23-A2",
         "MY1997",
         "23",
         "A2, second-order term of a single partner",
         "2 gamma^2 [w_D^2]/(m^2 d)",
         {"d", "m", "gamma", "rc", "weight", "exponent"},
         {"n", "sigma", "dt", "random_weight"},
         [](Arguments const& a) { return A2(explicit_dpd(a, unused, unused)); }},
        {"my23-A3",
         "MY1997",
         "23",
         "A3, momentum fed in by the noise",
         "sigma^2 [w_R^2]/d",
         {"d", "sigma", "rc", "weight", "exponent", "random_weight"},
         {"n", "m", "gamma", "dt"},
         [](Arguments const& a) {
             return A3({.d = a.d(),
                        .sigma = a["sigma"],
                        .rc = a["rc"],
                        .weight = a.weight(),
                        .random_weight = a.random_weight()});
         }},
    };
}

// Where it diverges.
std::vector<ClosedForm> stability_rows() {
    return {
        {"my25",
         "MY1997",
         "25",
         "critical step of explicit DPD",
         "2 A1/(n A1^2 + A2)",
         {"d", "n", "m", "gamma", "rc", "weight", "exponent"},
         {"sigma", "random_weight"},
         [](Arguments const& a) { return critical_step(explicit_dpd(a, a["n"], unused)); }},
        {"my26",
         "MY1997",
         "26",
         "critical density of explicit DPD",
         "(2 A1 - A2 dt)/(A1^2 dt)",
         {"d", "m", "gamma", "rc", "dt", "weight", "exponent"},
         {"sigma", "random_weight"},
         [](Arguments const& a) { return critical_density(explicit_dpd(a, unused, unused), a["dt"]); }},
    };
}

}  // namespace

std::vector<ClosedForm> my1997_rows() {
    return joined({temperature_rows(), integral_rows(), stability_rows()});
}

}  // namespace dpd::theory
