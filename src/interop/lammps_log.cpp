#include "lammps_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "conventions.hpp"
#include "errors.hpp"
#include "scene.hpp"
#include "state_point.hpp"

namespace dpd {
namespace {

using Words = std::vector<std::string>;
using Facts = std::map<std::string, double>;

constexpr std::string_view s1 = "S1";

// Constants of LAMMPS' units (update.cpp, 29 Sep 2021): Boltzmann's, m v^2 to energy, energy/volume to
// pressure, and the time step where none is given.
struct UnitStyle {
    std::string_view name;
    double boltzmann, mvv_to_energy, density_to_pressure, time_step;
};
constexpr std::array<UnitStyle, 3> unit_styles{
    {{"lj", 1.0, 1.0, 1.0, 0.005},
     {"real", 0.0019872067, 48.88821291 * 48.88821291, 68568.415, 1.0},
     {"metal", 8.617343e-5, 1.0364269e-4, 1.6021765e6, 0.001}}};

// Styles of DPD, with the names that dpdref convert has for their numbers; "-" does not count.
struct PairStyle {
    std::string_view name, code;
    std::vector<std::string_view> of_style, of_pair;
};
std::vector<PairStyle> const& pair_styles() {
    static std::vector<PairStyle> const styles{
        {"dpd", "lammps-dpd", {"T", "cutoff", "-"}, {"A", "gamma", "cutoff"}},
        {"dpd/tstat", "lammps-dpd-tstat", {"T", "-", "cutoff", "-"}, {"gamma", "cutoff"}},
        {"dpd/ext", "lammps-dpd-ext", {"T", "cutoff", "-"}, {"A", "gamma", "gammaT", "ws", "-", "cutoff"}},
        {"dpd/ext/tstat",
         "lammps-dpd-ext",
         {"T", "-", "cutoff", "-"},
         {"gamma", "gammaT", "ws", "-", "cutoff"}},
        {"dpd/fdt", "lammps-dpd-fdt", {"T", "cutoff", "-"}, {"A", "sigma", "cutoff"}}};
    return styles;
}

// Without the suffix of an accelerated one.
std::string plain_style(std::string name) {
    for (std::string_view const suffix : {"/kk", "/omp", "/gpu", "/intel", "/opt"})
        if (name.ends_with(suffix)) name.resize(name.size() - suffix.size());
    return name;
}

// What a log says; the names are those of the reference's facts.
struct Said {
    Facts facts;
    std::string integrator;  // empty: not said
    Words others;            // that cannot be a DPD fluid of the reference's kind
    double shear_rate = 0.0;
    bool flow_is_heat = false;
    UnitStyle const* units = unit_styles.data();
    std::string unit_name = "lj";
};

// Of `fix ID group deform N ... xy erate RATE ...`; 0 for another deformation.
double rate_of_shear(Words const& fix) {
    auto const xy = std::find(fix.begin() + 4, fix.end(), "xy");
    if (fix.end() - xy < 3 || xy[1] != "erate") return 0.0;
    return to_number(xy[2]).value_or(0.0);
}

// The last commands count; a fix is there until it is taken away.
Said read_commands(CodeOutput const& output, int d) {
    Said said;
    std::map<std::string, Words> fixes, computes;
    std::string thermo_temperature;
    Words style, pair, time_step;
    std::optional<double> mass;
    for (auto const& words : output.commands) {
        auto const& name = words[0];
        if (name == "units" && words.size() > 1) said.unit_name = words[1];
        if (name == "timestep") time_step = words;
        if (name == "pair_style") style = words;
        if (name == "pair_coeff" && words.size() > 3 && words[1] == words[2]) {
            bool const of_dpd = to_number(words[3]) || words[3].starts_with("dpd");
            if (of_dpd) pair = words;
        }
        if (name == "mass" && words.size() > 2) mass = to_number(words[2]);
        if (name == "fix" && words.size() > 3) fixes[words[1]] = words;
        if (name == "compute" && words.size() > 3) computes[words[1]] = words;
        if (auto const temp = std::find(words.begin(), words.end(), "temp");
            name == "thermo_modify" && temp != words.end() && temp + 1 != words.end())
            thermo_temperature = temp[1];
        if (name == "unfix" && words.size() > 1) fixes.erase(words[1]);
    }
    auto const units = std::find_if(unit_styles.begin(), unit_styles.end(),
                                    [&](auto const& u) { return u.name == said.unit_name; });
    said.units = units == unit_styles.end() ? nullptr : &*units;
    // in units of energy/velocity^2, from which those of time follow
    if (mass) said.facts["mass"] = *mass * (said.units ? said.units->mvv_to_energy : 1.0);
    if (time_step.size() > 1 && to_number(time_step[1])) said.facts["timestep"] = *to_number(time_step[1]);
    if (time_step.empty() && !style.empty() && said.units) said.facts["timestep"] = said.units->time_step;
    double volume = output.box.empty() ? 0.0 : 1.0;
    for (int axis = 0; axis < d && !output.box.empty(); ++axis) volume *= output.box[std::size_t(axis)];
    if (output.atoms > 0.0 && volume > 0.0) said.facts["density"] = output.atoms / volume;
    for (auto const& [id, words] : fixes) {
        std::string const fix = plain_style(words[3]);
        for (std::string_view const thermostat : {"nvt", "npt", "nph", "langevin", "temp/"})
            if (fix.starts_with(thermostat))
                said.others.push_back(fmt::format("fix {} (reference: no such thermostat)", fix));
        if (fix != "deform") continue;
        said.shear_rate = rate_of_shear(words);
        if (said.shear_rate == 0.0)
            said.others.emplace_back("fix deform (reference: none but a shear, xy erate RATE)");
        auto const compute = computes.find(thermo_temperature);
        said.flow_is_heat = compute == computes.end() || plain_style(compute->second[3]) != "temp/deform";
    }
    if (style.size() < 2) return said;
    // of hybrid styles the one of DPD, with what follows it
    auto const named = std::find_if(style.begin() + 1, style.end(),
                                    [](auto const& word) { return word.starts_with("dpd"); });
    auto const known = std::find_if(pair_styles().begin(), pair_styles().end(), [&](auto const& one) {
        return named != style.end() && one.name == plain_style(*named);
    });
    if (known == pair_styles().end()) {
        if (named == style.end())
            said.others.push_back(fmt::format("pair_style {} (reference: DPD)", style.at(1)));
        return said;
    }
    Assignments given;
    auto const take = [&](auto const& names, auto from, auto const end) {
        for (std::string_view const name : names) {
            if (from == end) return;
            std::erase_if(given, [&](auto const& one) { return one.first == name; });
            if (name != "-" && to_number(*from)) given.emplace_back(name, *from);
            ++from;
        }
    };
    take(known->of_style, named + 1, style.end());
    if (!pair.empty()) take(known->of_pair, pair.begin() + (to_number(pair[3]) ? 3 : 4), pair.end());
    try {
        DpdFluid const fluid = read_fluid(find_code(known->code), given);
        auto const has = [&](std::string_view name) {
            return std::any_of(given.begin(), given.end(),
                               [&](auto const& one) { return one.first == name; });
        };
        double const boltzmann = said.units ? said.units->boltzmann : NAN;
        said.facts["kT"] = boltzmann * fluid.kT;
        said.facts["cutoff"] = fluid.rc;
        if (has("A")) said.facts["a"] = fluid.a;
        // a friction that follows from sigma and T is not known in units with a Boltzmann constant
        if (has("gamma") || boltzmann == 1.0) said.facts["gamma"] = fluid.gamma;
        if (auto const p = exponent(fluid.weight)) said.facts["exponent of w_D"] = *p;
    } catch (InputError const& error) {
        said.others.push_back(fmt::format("{} (not in dpdref)", one_line(error.what())));
    }
    auto const has_fix = [&](std::string_view begin) {
        return std::any_of(fixes.begin(), fixes.end(),
                           [&](auto const& fix) { return fix.second[3].starts_with(begin); });
    };
    bool const shardlow = has_fix("shardlow"), verlet = has_fix("nve");
    if (shardlow || verlet) said.integrator = shardlow ? s1 : step_of_pair_dpd;
    return said;
}

std::vector<std::string> differing(Facts const& facts, Units const& units, Reference const& reference) {
    std::vector<std::string> differences;
    for (auto const& [name, value] : facts) {
        auto const known = reference.facts.find(name);
        if (known == reference.facts.end()) continue;
        double const own = value / parameter_unit(parameter_of(name), units, reference.dimension),
                     its = known->second;
        // a density is a count over a volume that is printed with few digits
        if (std::abs(own - its) > 1e-3 * std::max(std::abs(own), std::abs(its)))
            differences.push_back(fmt::format("{} {:.6g} (reference: {:.6g})", name, own, its));
    }
    return differences;
}

}  // namespace

std::string_view parameter_of(std::string_view fact) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 4> others{
        {{"mass", "m"}, {"cutoff", "rc"}, {"timestep", "dt"}, {"density", "n"}}};
    for (auto const& [name, parameter] : others)
        if (name == fact) return parameter;
    return fact;
}

void describe_fluid(Reference& reference, Scene const& scene) {
    auto& facts = reference.facts;
    facts = {{"mass", scene.mass}, {"timestep", scene.time_step}, {"density", scene.density()}};
    if (double const kT = scene.thermostat_kT(); kT > 0.0) facts["kT"] = kT;
    if (auto const* const soft = scene.soft()) {
        facts["a"] = soft->force(0.0);
        facts["cutoff"] = soft->cutoff;
    } else if (!scene.potential()) {
        facts["a"] = 0.0;
    }
    auto const friction = [&](double gamma, double cutoff, Weight weight) {
        facts["gamma"] = gamma;
        facts["cutoff"] = cutoff;
        if (auto const p = exponent(weight)) facts["exponent of w_D"] = *p;
    };
    auto names = scene.stage_names();
    std::erase(names, "sample");
    reference.integrator = fmt::format("{}", fmt::join(names, ", "));
    if (auto const* const p = scene.stage<ModifiedVerlet>()) {
        friction(p->gamma, p->cutoff, p->weight);
        if (p->lambda == 0.5 && !p->friction_again) reference.integrator = step_of_pair_dpd;
    }
    if (auto const* const p = scene.stage<Shardlow>()) {
        friction(p->friction, p->cutoff, p->weight);
        auto const* const verlet = scene.stage<Verlet>();
        if (p->scheme == Scheme::shardlow && names.size() == 2 && (!verlet || verlet->substeps == 1))
            reference.integrator = s1;
    }
}

LogCheck check_log(CodeOutput const& output, Reference const& reference) {
    LogCheck check;
    if (output.commands.empty()) return check;
    Said const said = read_commands(output, reference.dimension);
    auto const has = [&](char const* name) {
        return said.facts.contains(name) && said.facts.at(name) > 0.0 && reference.facts.contains(name);
    };
    auto const ratio = [&](char const* name) { return said.facts.at(name) / reference.facts.at(name); };
    check.flow_is_heat = said.flow_is_heat;
    Facts facts = said.facts;
    // what the reference's units are in the log's, if both fluids are the same
    Units scale;
    bool const scaled = said.units && has("kT") && has("cutoff");
    if (scaled)
        scale = {.length = ratio("cutoff"), .mass = has("mass") ? ratio("mass") : 1.0, .energy = ratio("kT")};
    if (said.unit_name == "lj") {
        auto const as_they_are = differing(facts, {}, reference);
        bool const other_units =
            !as_they_are.empty() && scaled && has("mass") && differing(facts, scale, reference).empty();
        if (!other_units) scale = {};
        if (other_units)
            check.notes.push_back(
                fmt::format("{}: the reference's fluid, in units of energy {:.6g}, length {:.6g} and "
                            "mass {:.6g}: LAMMPS' own columns are converted",
                            output.file, 1.0 / scale.energy, 1.0 / scale.length, 1.0 / scale.mass));
        else
            check.differences = as_they_are;
    } else if (!scaled) {
        check.temperature = check.energy = check.pressure = NAN;
        if (said.shear_rate != 0.0) check.shear_rate = NAN;
        check.notes.push_back(fmt::format(
            "{}: units {}: {}, so that LAMMPS' own columns are not compared; --as COLUMN=quantity*factor "
            "converts one",
            output.file, said.unit_name,
            said.units
                ? "the log does not say kT and the cutoff (pair_style dpd), which are the reference's units"
                : "not known here"));
        return check;
    } else {
        if (!has("mass")) {
            facts.erase("timestep");
            facts.erase("gamma");
            check.notes.push_back(
                fmt::format("{}: units {}: the log does not say the mass: step and friction are not checked",
                            output.file, said.unit_name));
        }
        check.notes.push_back(fmt::format(
            "{}: units {}: LAMMPS' own columns are converted so that kT, cutoff and mass are the reference's",
            output.file, said.unit_name));
        check.differences = differing(facts, scale, reference);
    }
    check.differences.insert(check.differences.end(), said.others.begin(), said.others.end());
    if (!said.integrator.empty() && said.integrator != reference.integrator && !reference.integrator.empty())
        check.differences.push_back(
            fmt::format("integrator {} (reference: {})", said.integrator, reference.integrator));
    if (check.differences.empty() || said.unit_name != "lj") {
        check.temperature = said.units->boltzmann / scale.energy;
        check.energy = 1.0 / scale.energy;
        check.pressure =
            std::pow(scale.length, reference.dimension) / (scale.energy * said.units->density_to_pressure);
    }
    check.shear_rate = said.shear_rate * parameter_unit("dt", scale, reference.dimension);
    return check;
}

}  // namespace dpd
