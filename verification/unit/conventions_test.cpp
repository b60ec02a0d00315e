/// @file
/// Conversion between codes. Each code's pair force, friction and noise are written down here once more, from
/// its source or manual (docs/conventions.md), and compared with dpdref's own at several distances.
#define BOOST_TEST_MODULE conventions
#include "conventions.hpp"

#include <array>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>

#include "errors.hpp"
#include "potential.hpp"
#include "run.hpp"
#include "scene.hpp"
#include "scheme.hpp"

using namespace dpd;

namespace {

constexpr double kT = 0.7, rc = 1.6, m = 2.5, a = 18.0, gamma_ = 4.5, dt = 0.03;
constexpr double tolerance = 1e-13;  // relative; a few roundings
std::array const distances{0.05, 0.4, 0.9, 1.3, 1.59};

using Function = std::function<double(double)>;

/// Mean square of a number drawn evenly from [lo, hi]; Simpson's rule is exact for squares.
double mean_square_uniform(double lo, double hi) {
    double const middle = (lo + hi) / 2;
    return (lo * lo + 4 * middle * middle + hi * hi) / 6;
}

/// A code's parameters, and what it does to a pair at distance r.
struct ForceCase {
    std::string code;
    Assignments parameters;
    Function repulsion;   ///< force
    Function friction;    ///< F_D over the relative velocity along the line, mass/time
    Function noise_rate;  ///< variance of the random impulse of a step, over the step
};

double w(double r) { return 1.0 - r / rc; }

std::vector<ForceCase> force_cases() {
    double const lammps_sigma = std::sqrt(2.0 * kT * gamma_);
    double const random_dt = 1.0 / std::sqrt(dt);  // forces of noise carry it
    auto const common = [&](std::string const& kT_name, std::string const& a_name, std::string const& rc_name,
                            std::string const& dt_name, std::string const& m_name = "mass") {
        return Assignments{
            {kT_name, "0.7"}, {a_name, "18"}, {rc_name, "1.6"}, {m_name, "2.5"}, {dt_name, "0.03"}};
    };
    auto const with = [](Assignments list, Assignments const& more) {
        list.insert(list.end(), more.begin(), more.end());
        return list;
    };
    auto const linear = [](double r) { return a * w(r); };
    auto const square = [](double r) { return gamma_ * w(r) * w(r); };
    // variance of a force of noise F, times dt
    auto const rate = [](double force_squared) { return force_squared * dt; };
    auto const lammps_noise = [=](double r) { return rate(std::pow(lammps_sigma * w(r) * random_dt, 2)); };
    double const pk_sigma = 3.0, pk_gamma = pk_sigma * pk_sigma / (2 * kT);
    double const my_sigma = 1.9, my_gamma = 2.2;
    double const tau = rc * std::sqrt(m / kT);  // unit of time of NG2007

    return {
        // PairDPD::compute: a0*wd, gamma*wd*wd, sigma*wd*randnum/sqrt(dt)
        {"lammps-dpd", with(common("T", "A", "cutoff", "timestep"), {{"gamma", "4.5"}}), linear, square,
         lammps_noise},
        // PairDPDTstat::compute
        {"lammps-dpd-tstat",
         {{"T", "0.7"}, {"gamma", "4.5"}, {"cutoff", "1.6"}, {"mass", "2.5"}, {"timestep", "0.03"}},
         [](double) { return 0.0; },
         square,
         lammps_noise},
        // PairDPDExt::compute: pow(wd, ws) in the noise, its square in the friction
        {"lammps-dpd-ext", with(common("T", "A", "cutoff", "timestep"), {{"gamma", "4.5"}, {"ws", "0.65"}}),
         linear, [](double r) { return gamma_ * std::pow(std::pow(w(r), 0.65), 2); },
         [=](double r) { return rate(std::pow(lammps_sigma * std::pow(w(r), 0.65) * random_dt, 2)); }},
        {"lammps-dpd-ext", with(common("T", "A", "cutoff", "timestep"), {{"gamma", "4.5"}, {"ws", "0.25"}}),
         linear, [](double r) { return gamma_ * std::pow(std::pow(w(r), 0.25), 2); },
         [=](double r) { return rate(std::pow(lammps_sigma * std::pow(w(r), 0.25) * random_dt, 2)); }},
        // dpd_pair_force: gamma omega^2, sqrt(24 kT gamma/dt) omega times a number from [-1/2, 1/2]
        {"espresso",
         with(common("kT", "F_max", "r_cut", "time_step"),
              {{"gamma", "4.5"}, {"weight_function", "1"}, {"k", "1"}}),
         linear, square,
         [=](double r) {
             return rate(24 * kT * gamma_ / dt * std::pow(1 - std::pow(r / rc, 1.0), 2) *
                         mean_square_uniform(-0.5, 0.5));
         }},
        {"espresso",
         with(common("kT", "F_max", "r_cut", "time_step"), {{"gamma", "4.5"}, {"weight_function", "0"}}),
         linear, [](double) { return gamma_; },
         [=](double) { return rate(24 * kT * gamma_ / dt * mean_square_uniform(-0.5, 0.5)); }},
        // EvaluatorPairDPDThermoDPD: r F = a (1/r - 1/rc) ..., noise 1/sqrt(dt/(6 kT gamma)) from [-1, 1]
        {"hoomd-dpd", with(common("kT", "A", "r_cut", "dt"), {{"gamma", "4.5"}}),
         [](double r) { return r * a * (1 / r - 1 / rc); },
         [](double r) { return gamma_ * r * r * std::pow(1 / r - 1 / rc, 2); },
         [=](double r) {
             return rate(6 * kT * gamma_ / dt * std::pow(r * (1 / r - 1 / rc), 2) *
                         mean_square_uniform(-1, 1));
         }},
        // DPDPairEvaluatorGeneralWeight: wR = pow(1 - r/rc, s/2)
        {"hoomd-azplugins", with(common("kT", "A", "r_cut", "dt"), {{"gamma", "4.5"}, {"s", "0.5"}}), linear,
         [](double r) { return gamma_ * std::pow(std::pow(w(r), 0.25), 2); },
         [=](double r) {
             return rate(6 * kT * gamma_ / dt * std::pow(std::pow(w(r), 0.25), 2) *
                         mean_square_uniform(-1, 1));
         }},
        {"hoomd-azplugins", with(common("kT", "A", "r_cut", "dt"), {{"gamma", "4.5"}, {"s", "3"}}), linear,
         [](double r) { return gamma_ * std::pow(std::pow(w(r), 1.5), 2); },
         [=](double r) {
             return rate(6 * kT * gamma_ / dt * std::pow(std::pow(w(r), 1.5), 2) *
                         mean_square_uniform(-1, 1));
         }},
        // PairwiseDPDHandler: -(gamma wr rdotv + sigma xi) wr, wr = (1 - r/rc)^power, sigma = sqrt(2 gamma
        // kBT/dt)
        {"mirheo", with(common("kBT", "a", "rc", "dt"), {{"gamma", "4.5"}, {"power", "0.75"}}), linear,
         [](double r) { return gamma_ * std::pow(w(r), 0.75) * std::pow(w(r), 0.75); },
         [=](double r) { return rate(2 * gamma_ * kT / dt * std::pow(std::pow(w(r), 0.75), 2)); }},
        // DPD_impl::ForceTransverser: -g wr^2, a normal number of deviation sqrt(2 T) / sqrt(dt) sqrt(g) wr
        {"uammd", with(common("temperature", "A", "cutOff", "dt"), {{"gamma", "4.5"}}), linear, square,
         [=](double r) {
             return rate(std::pow(std::sqrt(2 * kT) * random_dt * std::sqrt(gamma_) * w(r), 2));
         }},
        // DPDInteraction: a w, gamma w^2, sigma w xi/sqrt(dt)
        {"molly",
         {{"a", "18"},
          {"γ", "2.2"},
          {"σ", "1.9"},
          {"r_c", "1.6"},
          {"mass", "2.5"},
          {"dt", "0.03"},
          {"λ", "0.5"}},
         linear,
         [=](double r) { return my_gamma * w(r) * w(r); },
         [=](double r) { return rate(std::pow(my_sigma * w(r) * random_dt, 2)); }},
        // manual of DPDForce: gamma = sigma^2/(2 T) of w^2, sigma w xi
        {"galamost", with(common("T", "alpha", "r_cut", "dt"), {{"sigma", "3"}, {"lambda", "0.5"}}), linear,
         [=](double r) { return pk_gamma * w(r) * w(r); },
         [=](double r) { return rate(std::pow(pk_sigma * w(r) * random_dt, 2)); }},
        // cu_dpd_force: gamma = sigma^2/2, a number from [-1, 1] times sqrt(3) T sigma, with T = 1
        {"pygamd",
         {{"alpha", "18"}, {"sigma", "3"}, {"rcut", "1.6"}, {"mass", "2.5"}, {"dt", "0.03"}},
         linear,
         [=](double r) { return 0.5 * pk_sigma * pk_sigma * w(r) * w(r); },
         [=](double r) {
             return rate(std::pow(std::sqrt(3.0) * 1.0 * pk_sigma * w(r) * random_dt, 2) *
                         mean_square_uniform(-1, 1));
         }},
        // manual: -gamma w_D, sigma w_R xi/sqrt(dt), w_D = w_R^2 = (1 - r/rc)^2
        {"dl_meso", with(common("temperature", "A", "rc", "timestep"), {{"gamma", "4.5"}}), linear, square,
         lammps_noise},
        // eq. 2
        {"MY1997",
         {{"gamma", "2.2"},
          {"sigma", "1.9"},
          {"weight", "linear"},
          {"rc", "1.6"},
          {"m", "2.5"},
          {"dt", "0.03"}},
         [](double) { return 0.0; },
         [=](double r) { return my_gamma * w(r); },
         [=](double r) { return std::pow(my_sigma * std::sqrt(w(r)) * std::sqrt(dt), 2) / dt; }},
        // eqs. 1, 2, 3: the noise has strength 2 kT w; gamma* = gamma tau/m
        {"NG2007",
         {{"gamma", "9"}, {"dt", "0.1"}, {"a", "25"}, {"m", "2.5"}, {"kT", "0.7"}, {"rc", "1.6"}},
         [](double r) { return 25 * kT / rc * w(r); },
         [=](double r) { return 9 * m / tau * w(r); },
         [=](double r) { return 2 * kT * 9 * m / tau * w(r); }},
        // sect. III
        {"PK2006",
         {{"kT", "0.7"}, {"sigma", "3"}, {"a", "18"}, {"rc", "1.6"}, {"m", "2.5"}, {"dt", "0.03"}},
         linear,
         [=](double r) { return pk_gamma * w(r) * w(r); },
         [=](double r) { return pk_sigma * pk_sigma * w(r) * w(r); }},
        {"dpdref",
         {{"gamma", "4.5"}, {"weight", "parabolic"}, {"rc", "1.6"}, {"kT", "0.7"}, {"a", "18"}, {"m", "2.5"}},
         linear,
         [](double r) { return gamma_ * (1 - r * r / (rc * rc)); },
         [](double r) { return 2 * gamma_ * kT * (1 - r * r / (rc * rc)); }},
    };
}

/// What a code does to the velocity of the first of two particles in one step.
struct UpdateCase {
    std::string code;
    Assignments parameters;
    Scheme scheme;
    Function damping;  ///< change over the relative velocity along the line, negated
    Function noise;    ///< standard deviation
};

std::vector<UpdateCase> update_cases() {
    double const R = 8.31446261815324e-3, mu = m / 2;
    double const friction = 1.8, K = 300.0;
    auto const omega = [](double r) { return 1 - r / rc; };
    // ReferenceDPDDynamics::updatePart2
    auto const vscale = [=](double r) { return std::exp(-dt * 2 * friction * omega(r) * omega(r)); };
    // FixShardlow::ssa_update_dpd: two halves, the second implicit. Momentum change from v and a random
    // number.
    double const sigma = 3.0, half_gamma = sigma * sigma / 4 / kT;
    auto const shardlow = [=](double r, double v, double xi) {
        double const factor = half_gamma * omega(r) * omega(r) * dt, massinv = 1 / m;
        double const random = sigma / 2 * omega(r) * std::sqrt(dt) * xi;
        double const first = random - factor * v;
        double const v1 = v + 2 * massinv * first;
        return (first + (random - factor * v1) / (1 + 2 * massinv * factor)) * massinv;
    };
    // Goga et al. 2012: dv = -f v + sqrt(f (2 - f) kT/mu) xi, shared by mass
    auto const f = [=](double r) { return 1 - std::pow(1 - 0.3, omega(r)); };

    return {
        {"openmm",
         {{"temperature", "300"},
          {"friction", "1.8"},
          {"cutoff", "1.6"},
          {"mass", "2.5"},
          {"stepSize", "0.03"}},
         Scheme::exponential,
         [=](double r) { return mu / m * (1 - vscale(r)); },
         [=](double r) { return mu / m * std::sqrt(1 - vscale(r) * vscale(r)) * std::sqrt(R * K / mu); }},
        {"lammps-dpd-fdt",
         {{"T", "0.7"}, {"sigma", "3"}, {"cutoff", "1.6"}, {"mass", "2.5"}, {"timestep", "0.03"}},
         Scheme::shardlow,
         [=](double r) { return -shardlow(r, 1, 0); },
         [=](double r) { return shardlow(r, 0, 1); }},
        {"gromacs",
         {{"f", "0.3"}, {"weight", "linear"}, {"rc", "1.6"}, {"kT", "0.7"}, {"mass", "2.5"}, {"dt", "0.03"}},
         Scheme::exponential,
         [=](double r) { return f(r) / 2; },
         [=](double r) { return std::sqrt(f(r) * (2 - f(r)) * kT / mu) / 2; }},
    };
}

bool mentions(InputError const& error, std::string const& text) {
    BOOST_TEST_MESSAGE(error.what());
    return std::string(error.what()).find(text) != std::string::npos;
}

void check_same(Assignments const& one, Assignments const& other) {
    BOOST_REQUIRE_EQUAL(one.size(), other.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
        BOOST_TEST(one[k].first == other[k].first);
        char* end = nullptr;
        double const x = std::strtod(one[k].second.c_str(), &end);
        if (*end != '\0' || end == one[k].second.c_str())
            BOOST_TEST(one[k].second == other[k].second);
        else
            BOOST_CHECK_SMALL(std::strtod(other[k].second.c_str(), nullptr) - x, 1e-15 * std::abs(x) * 8);
    }
}

}  // namespace

BOOST_AUTO_TEST_CASE(forces_are_those_of_each_code) {
    for (auto const& c : force_cases()) {
        BOOST_TEST_CONTEXT(c.code) {
            auto const fluid = read_fluid(find_code(c.code), c.parameters);
            BOOST_TEST(fluid.m == m);
            Soft const soft{.strength = fluid.a * fluid.rc, .cutoff = fluid.rc};
            for (double r : distances) {
                double const weight = weight_at(fluid.weight, r / fluid.rc);
                BOOST_CHECK_CLOSE_FRACTION(soft.force(r), c.repulsion(r), tolerance);
                // near the cutoff 1 - r/rc has few digits left
                BOOST_CHECK_CLOSE_FRACTION(fluid.gamma * weight, c.friction(r), 100 * tolerance);
                BOOST_CHECK_CLOSE_FRACTION(2 * fluid.gamma * fluid.kT * weight, c.noise_rate(r),
                                           100 * tolerance);
            }
        }
    }
}

BOOST_AUTO_TEST_CASE(updates_are_those_of_each_code) {
    for (auto const& c : update_cases()) {
        BOOST_TEST_CONTEXT(c.code) {
            auto const fluid = read_fluid(find_code(c.code), c.parameters);
            for (double r : distances) {
                double const A = update_a(
                    c.scheme, fluid.gamma * weight_at(fluid.weight, r / fluid.rc) * *fluid.dt / fluid.m);
                BOOST_CHECK_CLOSE_FRACTION(A, c.damping(r), 1e-9);  // 1 - exp(-small)
                BOOST_CHECK_CLOSE_FRACTION(update_b(A, fluid.m) * std::sqrt(2 * fluid.kT), c.noise(r), 1e-9);
            }
        }
    }
}

/// Every code has a case above, and comes back from itself and from every code that can hold its fluid.
BOOST_AUTO_TEST_CASE(round_trips) {
    std::map<std::string, Assignments> cases;
    for (auto const& c : update_cases()) cases.emplace(c.code, c.parameters);
    for (auto const& c : force_cases()) cases.emplace(c.code, c.parameters);
    std::map<std::string, int> ways;
    for (auto const& from : codes()) {
        BOOST_TEST_REQUIRE(cases.count(std::string(from.name)) == 1);
        auto const fluid = read_fluid(from, cases.at(std::string(from.name)));
        auto const own = write_fluid(from, fluid);
        // what was given is what comes back
        for (auto const& [key, value] : cases.at(std::string(from.name)))
            check_same({{key, value}}, {*std::ranges::find(own, key, &Assignments::value_type::first)});
        for (auto const& to : codes()) {
            Assignments there;
            try {
                there = write_fluid(to, fluid);
            } catch (InputError const&) {
                continue;
            }
            ++ways[std::string(from.name)];
            BOOST_TEST_CONTEXT(from.name << " " << to.name)
            check_same(own, write_fluid(from, read_fluid(to, there)));
        }
    }
    // with repulsion and the quadratic weight: not tstat, gromacs, MY1997 (no repulsion), nor NG2007
    // (weight), nor pygamd (kT)
    BOOST_TEST(ways["lammps-dpd"] == 14);
    BOOST_TEST(ways["openmm"] == 17);         // without repulsion: all but NG2007 and pygamd
    BOOST_TEST(ways["pygamd"] == 15);         // kT = 1: not tstat, gromacs, MY1997, NG2007
    BOOST_TEST(ways["lammps-dpd-ext"] == 4);  // a power with repulsion: dpdref, dpd/ext, azplugins, Mirheo
    BOOST_TEST(ways["mirheo"] == 4);
    BOOST_TEST(ways["MY1997"] == 7);  // linear: dpdref, dpd/ext, azplugins, Mirheo, gromacs, both papers
}

BOOST_AUTO_TEST_CASE(numbers_are_known) {
    // Groot & Warren's fluid in NG2007's time unit, and a rate in 1/ps for a mass of 54
    auto const fluid =
        read_fluid(find_code("openmm"), {{"temperature", "300"}, {"friction", "2"}, {"mass", "54"}});
    BOOST_CHECK_CLOSE_FRACTION(fluid.gamma, 108.0, 1e-15);
    BOOST_CHECK_CLOSE_FRACTION(fluid.kT, 2.494338785445972, 1e-15);
    auto const pk = read_fluid(find_code("PK2006"), {{"gamma", "45"}, {"sigma", "3"}});
    BOOST_CHECK_CLOSE_FRACTION(pk.kT, 0.1, 1e-15);
    BOOST_CHECK_CLOSE_FRACTION(read_fluid(find_code("lammps-dpd-fdt"), {{"T", "1"}, {"sigma", "3"}}).gamma,
                               4.5, 1e-15);
}

BOOST_AUTO_TEST_CASE(what_a_code_cannot_have_is_refused_by_name) {
    auto const refuses = [](std::string const& code, DpdFluid const& fluid, std::string const& text) {
        BOOST_CHECK_EXCEPTION(write_fluid(find_code(code), fluid), InputError,
                              [&](auto const& error) { return mentions(error, text); });
    };
    DpdFluid const linear{.gamma = 4.5, .weight = Weight::linear};
    refuses("lammps-dpd", linear, "use lammps-dpd-ext, ws=0.5");
    refuses("lammps-dpd-tstat", linear, "use lammps-dpd-ext, ws=0.5");
    refuses("lammps-dpd-fdt", linear, "allowed: quadratic");
    refuses("hoomd-dpd", linear, "use hoomd-azplugins, s=1");
    refuses("espresso", linear, "allowed: constant, quadratic");
    refuses("openmm", linear, "allowed: quadratic");
    refuses("dl_meso", linear, "allowed: quadratic");
    refuses("PK2006", linear, "allowed: quadratic");
    refuses("NG2007", {.gamma = 4.5}, "allowed: linear, constant");
    refuses("lammps-dpd", {.gamma = 4.5, .weight = Weight::parabolic}, "no LAMMPS pair style");
    refuses("lammps-dpd-ext", {.gamma = 4.5, .weight = Weight::parabolic}, "no power of 1-r/rc");
    refuses("hoomd-azplugins", {.gamma = 4.5, .weight = Weight::parabolic}, "no power of 1-r/rc");
    refuses("lammps-dpd-tstat", {.gamma = 4.5, .a = 25}, "no repulsion");
    refuses("MY1997", {.gamma = 4.5, .a = 25}, "no repulsion");
    refuses("MY1997", {.gamma = 0}, "needs friction");
    refuses("hoomd-dpd", {.gamma = 0}, "DPDConservative");
    refuses("gromacs", {.gamma = 4.5}, "needs the time step");
    DpdFluid const cubic{.gamma = 4.5, .weight = power_weight(3.0)};
    refuses("lammps-dpd", cubic, "use lammps-dpd-ext, ws=1.5");
    refuses("hoomd-dpd", cubic, "use hoomd-azplugins, s=3");
    refuses("openmm", cubic, "weight power: this code has (1-r/rc)^2 alone");
    refuses("mirheo", {.gamma = 4.5, .weight = Weight::parabolic}, "no power of 1-r/rc");
    for (char const* const code : {"uammd", "molly", "galamost", "pygamd"})
        refuses(code, cubic, "allowed: quadratic");
    refuses("molly", {.gamma = 0}, "allowed: a number > 0");
    refuses("pygamd", {.gamma = 4.5, .kT = 2.0}, "allowed: 1, or galamost");
    refuses("gromacs", {.gamma = 0, .dt = 0.1}, "allowed: a number > 0");
}

BOOST_AUTO_TEST_CASE(bad_parameters_get_one_line) {
    auto const refuses = [](std::string const& code, Assignments const& given, std::string const& text) {
        BOOST_CHECK_EXCEPTION(read_fluid(find_code(code), given), InputError,
                              [&](auto const& error) { return mentions(error, text); });
    };
    BOOST_CHECK_EXCEPTION(find_code("lamps"), InputError,
                          [](auto const& error) { return mentions(error, "allowed: dpdref, lammps-dpd"); });
    refuses("lammps-dpd", {{"T", "1"}}, "gamma: is missing");
    refuses("lammps-dpd", {{"T", "1"}, {"gamma", "-1"}}, "a number >= 0");
    refuses("lammps-dpd", {{"T", "0"}, {"gamma", "1"}}, "a number > 0");
    refuses("lammps-dpd", {{"T", "one"}, {"gamma", "1"}}, "'one' is not allowed");
    refuses("lammps-dpd", {{"T", "inf"}, {"gamma", "1"}}, "'inf' is not allowed");
    refuses("lammps-dpd", {{"T", "1"}, {"gamma", "1"}, {"sigma", "3"}}, "unknown key; allowed: T, A, gamma");
    refuses("lammps-dpd", {{"T", "1"}, {"gamma", "1"}, {"T", "1"}}, "given twice");
    refuses("lammps-dpd-ext", {{"T", "1"}, {"gamma", "1"}, {"ws", "51"}}, "allowed: 0 to 50");
    refuses("hoomd-azplugins", {{"kT", "1"}, {"gamma", "1"}, {"s", "101"}}, "allowed: 0 to 100");
    refuses("mirheo", {{"kBT", "1"}, {"gamma", "1"}, {"power", "-1"}}, "a number >= 0");
    refuses("dpdref", {{"gamma", "1"}, {"weight", "power"}}, "exponent: is missing");
    refuses("dpdref", {{"gamma", "1"}, {"weight", "power"}, {"exponent", "101"}}, "allowed: 0 to 100");
    refuses("dpdref", {{"gamma", "1"}, {"weight", "linear"}, {"exponent", "1"}}, "of weight power alone");
    refuses("molly", {{"σ", "0"}}, "a number > 0");
    refuses("lammps-dpd-ext", {{"T", "1"}, {"gamma", "1"}, {"ws", "1"}, {"gammaT", "2"}}, "line of centres");
    refuses("espresso", {{"kT", "1"}, {"gamma", "1"}, {"weight_function", "2"}}, "allowed: 0, 1");
    refuses("espresso", {{"kT", "1"}, {"gamma", "1"}, {"weight_function", "1"}, {"k", "2"}}, "another k");
    refuses("espresso", {{"kT", "1"}, {"gamma", "1"}, {"weight_function", "1"}, {"trans_gamma", "2"}},
            "line of centres");
    refuses("gromacs", {{"f", "1"}, {"kT", "1"}, {"dt", "0.1"}}, "< 1");
    refuses("gromacs", {{"f", "0.5"}, {"kT", "1"}, {"dt", "0.1"}, {"direction", "isotropic"}},
            "line of centres");
    refuses("NG2007", {{"gamma", "9"}, {"weight", "quadratic"}}, "allowed: linear, constant");
    refuses("dpdref", {{"gamma", "9"}, {"weight", "cubic"}}, "allowed: constant, linear");
    refuses("PK2006", {{"gamma", "9"}}, "two of gamma, sigma, kT");
    refuses("PK2006", {{"gamma", "4.5"}, {"sigma", "3"}, {"kT", "2"}}, "not 2 gamma kT");
    refuses("PK2006", {{"gamma", "0"}, {"sigma", "3"}}, "a number > 0, or kT");
}

// The general weight: its name where it has one, and the same exponent by three conventions.
BOOST_AUTO_TEST_CASE(powers_go_from_code_to_code) {
    auto const parameter = [](std::string const& from, Assignments const& given, std::string const& to,
                              std::string const& key) -> std::string {
        for (auto const& [name, value] : write_fluid(find_code(to), read_fluid(find_code(from), given)))
            if (name == key) return value;
        return "none";
    };
    Assignments const lammps{{"T", "1"}, {"gamma", "4.5"}, {"ws", "0.75"}},
        half{{"T", "1"}, {"gamma", "4.5"}, {"ws", "1"}};
    BOOST_TEST(parameter("lammps-dpd-ext", lammps, "dpdref", "weight") == "power");
    BOOST_TEST(parameter("lammps-dpd-ext", lammps, "dpdref", "exponent") == "1.5");
    BOOST_TEST(parameter("lammps-dpd-ext", lammps, "hoomd-azplugins", "s") == "1.5");
    BOOST_TEST(parameter("lammps-dpd-ext", lammps, "mirheo", "power") == "0.75");
    BOOST_TEST(parameter("lammps-dpd-ext", half, "dpdref", "weight") == "quadratic");
    BOOST_TEST(parameter("lammps-dpd-ext", half, "dpdref", "exponent") == "none");
    // the share of the step for which velocities are predicted is LAMMPS's half, not GALAMOST's default
    BOOST_TEST(parameter("lammps-dpd-ext", half, "galamost", "lambda") == "0.5");
    BOOST_TEST(parameter("pygamd", {{"sigma", "3"}}, "galamost", "lambda") == "0.65");
}

// What convert prints for dpdref is a scene once its comments with an equals sign are opened.
BOOST_AUTO_TEST_CASE(fragments_run_with_their_comments_opened) {
    std::map<std::string, Assignments> cases;
    for (auto const& c : update_cases()) cases.emplace(c.code, c.parameters);
    for (auto const& c : force_cases()) cases.emplace(c.code, c.parameters);
    for (auto const& code : codes())
        for (bool const timed : {true, false}) BOOST_TEST_CONTEXT(code.name << (timed ? "" : ", no step")) {
                auto fluid = read_fluid(code, cases.at(std::string(code.name)));
                if (!timed) fluid.dt.reset();
                std::istringstream lines(scene_fragment(fluid, code.mover) + rest_of_scene(fluid));
                std::string text;
                for (std::string line; std::getline(lines, line);)
                    text += (line.starts_with("# ") && line.find(" = ") != std::string::npos ? line.substr(2)
                                                                                             : line) +
                            "\n";
                auto const scene = parse_scene(text, "scene", {"particles.number=20"});
                BOOST_TEST(scene.time_step > 0.0);
                BOOST_TEST(run(scene).kinetic_temperature > 0.0);
            }
}

BOOST_AUTO_TEST_CASE(fragments_are_scenes) {
    auto const scene_of = [](std::string const& code, Assignments const& given) {
        auto const& from = find_code(code);
        auto const fluid = read_fluid(from, given);
        return parse_scene(scene_fragment(fluid, from.mover), code,
                           {"dimension=3", "box.length=[5.0,5.0,5.0]", "particles.density=3",
                            "time.duration=1", "time.equilibration=1", "time.step=0.04"});
    };
    for (auto const& c : force_cases()) BOOST_TEST_CONTEXT(c.code) {
            auto const fluid = read_fluid(find_code(c.code), c.parameters);
            auto const scene = scene_of(c.code, c.parameters);
            BOOST_TEST(scene.mass == fluid.m);
            BOOST_CHECK_CLOSE_FRACTION(scene.cutoff(), fluid.rc, 1e-15);
            if (scene.potential())
                BOOST_CHECK_CLOSE_FRACTION(std::get<Soft>(*scene.potential()).force(0.3), c.repulsion(0.3),
                                           tolerance);
        }
    auto const lammps = scene_of("lammps-dpd", {{"T", "2"}, {"gamma", "4.5"}, {"A", "25"}});
    BOOST_TEST(lammps.has_stage("modified_verlet"));
    BOOST_CHECK_CLOSE_FRACTION(lammps.stage<ModifiedVerlet>()->sigma, std::sqrt(18.0), 1e-15);
    BOOST_TEST(lammps.stage<ModifiedVerlet>()->lambda == 0.5);
    auto const ideal = scene_of("openmm", {{"temperature", "300"}, {"mass", "2"}, {"friction", "6.75"}});
    BOOST_TEST(ideal.stage<Shardlow>()->friction == 13.5);
    BOOST_TEST((ideal.stage<Shardlow>()->scheme == Scheme::exponential));
    BOOST_TEST(ideal.has_stage("drift"));
    auto const openmm =
        scene_of("openmm", {{"temperature", "300"}, {"mass", "2"}, {"friction", "6.75"}, {"A", "25"}});
    BOOST_TEST(openmm.has_stage("half_kick"));
    BOOST_TEST(scene_of("MY1997", {{"gamma", "1"}, {"sigma", "1"}}).has_stage("euler"));
    BOOST_TEST(scene_of("galamost", {{"sigma", "3"}}).stage<ModifiedVerlet>()->lambda == 0.65);
    BOOST_TEST(scene_of("molly", {{"λ", "0.6"}}).stage<ModifiedVerlet>()->lambda == 0.6);
    auto const mirheo = scene_of("mirheo", {{"a", "25"}, {"gamma", "4.5"}, {"kBT", "1"}, {"power", "0.75"}});
    BOOST_TEST(mirheo.has_stage("force"));
    BOOST_TEST((mirheo.stage<EulerImpulses>()->weight == power_weight(1.5)));
    BOOST_TEST(scene_of("lammps-dpd-fdt", {{"T", "1"}, {"sigma", "3"}, {"A", "25"}}).has_stage("verlet"));
}
