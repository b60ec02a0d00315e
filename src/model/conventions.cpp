#include "conventions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "errors.hpp"
#include "given.hpp"

namespace dpd {
namespace {

/// The member that a role names; nothing for a time step that is not known, and for `other`.
double* member(DpdFluid& fluid, Key::Role role) {
    switch (role) {
        case Key::gamma:
            return &fluid.gamma;
        case Key::rc:
            return &fluid.rc;
        case Key::kT:
            return &fluid.kT;
        case Key::m:
            return &fluid.m;
        case Key::a:
            return &fluid.a;
        case Key::dt:
            return fluid.dt ? &*fluid.dt : nullptr;
        default:
            return nullptr;
    }
}

// What a step of a mover consists of, as a scene lists it.
std::string_view stages(Mover mover, bool repels) {
    switch (mover) {
        case Mover::velocity_verlet:
            return R"("modified_verlet", "sample")";
        case Mover::euler:
            return repels ? R"("euler", "force", "sample", "drift", "kick")"
                          : R"("euler", "sample", "drift", "kick")";
        case Mover::leapfrog:
            return repels ? R"("euler", "force", "kick", "drift", "sample")"
                          : R"("euler", "kick", "drift", "sample")";
        case Mover::middle:
            if (repels)
                return R"("half_kick", "half_kick", "half_drift", "shardlow", "half_drift", "sample")";
            break;
        case Mover::s1:
        case Mover::exponential:
            break;
    }
    return repels ? R"("shardlow", "sample", "verlet")" : R"("shardlow", "sample", "drift")";
}

[[noreturn]] void refuse_overflow(std::string const& what) {
    throw InputError(fmt::format("{}: is not finite there: a parameter is too large or too small", what));
}

}  // namespace

Code const& find_code(std::string_view name) {
    auto const found = std::ranges::find(codes(), name, &Code::name);
    if (found != codes().end()) return *found;
    std::vector<std::string_view> names;
    for (auto const& code : codes()) names.push_back(code.name);
    throw InputError(fmt::format("convert: '{}' is no code; allowed: {}", name, fmt::join(names, ", ")));
}

DpdFluid read_fluid(Code const& code, Assignments const& assignments) {
    Given const given(code, assignments);
    DpdFluid fluid;
    for (auto const& key : code.keys) {
        if (key.role == Key::other || !given.has(key.name)) continue;
        if (key.role == Key::dt) fluid.dt.emplace();
        *member(fluid, key.role) = given.number(key.name);
    }
    code.read(given, fluid);
    return fluid;
}

Assignments write_fluid(Code const& code, DpdFluid fluid) {
    bool const repels = std::ranges::find(code.keys, Key::a, &Key::role) != code.keys.end();
    if (fluid.a != 0.0 && !repels)
        throw InputError(fmt::format("a: {} has no repulsion; convert with a=0 and add it there", code.name));
    Assignments others;
    code.write(fluid, others);
    Assignments all;
    for (auto const& key : code.keys) {
        auto const special = std::ranges::find(others, key.name, &Assignments::value_type::first);
        if (special != others.end())
            all.push_back(*special);
        else if (double const* const value = member(fluid, key.role))
            all.emplace_back(key.name, fmt::format("{}", *value));
    }
    for (auto const& [key, text] : all)
        if (text == "inf" || text == "nan") refuse_overflow(fmt::format("{}: {}", code.name, key));
    return all;
}

std::string scene_fragment(DpdFluid const& fluid, Mover mover) {
    bool const repels = fluid.a != 0.0;
    double const sigma = noise(fluid), strength = fluid.a * fluid.rc;
    if (!std::isfinite(sigma)) refuse_overflow("dpdref: sigma");
    if (!std::isfinite(strength)) refuse_overflow("dpdref: soft.strength");
    bool const forces = mover == Mover::velocity_verlet;
    bool const euler = mover == Mover::euler || mover == Mover::leapfrog;
    // with no repulsion the middle scheme is the other one seen half a drift earlier
    bool const kicks = mover == Mover::middle && repels;
    std::string_view const potential = forces  ? "modified_verlet"
                                       : euler ? "force"
                                       : kicks ? "half_kick"
                                               : "verlet";
    std::string_view const thermostat = forces ? "modified_verlet" : euler ? "euler" : "shardlow";
    std::string text = fmt::format("stages = [{}]\nparticles.mass = {}\nparticles.kT = {}\n",
                                   stages(mover, repels), fluid.m, fluid.kT);
    auto const add = [&](std::string_view table, std::string_view key, auto const& value) {
        text += fmt::format("{}.{} = {}\n", table, key, value);
    };
    auto const quoted = [](std::string_view word) { return fmt::format("\"{}\"", word); };
    if (forces || euler) {
        add(thermostat, "gamma", fluid.gamma);
        add(thermostat, "sigma", sigma);
        if (forces && fluid.lambda != 0.5) add(thermostat, "lambda", fluid.lambda);
    } else {
        add(thermostat, "friction", fluid.gamma);
        add(thermostat, "kT", fluid.kT);
        add(thermostat, "scheme", quoted(mover == Mover::s1 ? "shardlow" : "exponential"));
    }
    add(thermostat, "weight", quoted(name_of(fluid.weight.kind)));
    if (fluid.weight.kind == Weight::power) add(thermostat, "exponent", fluid.weight.exponent);
    add(thermostat, "cutoff", fluid.rc);
    if (repels || forces) {
        add(potential, "soft.strength", strength);
        add(potential, "soft.cutoff", fluid.rc);
    }
    if (fluid.dt) add("time", "step", *fluid.dt);
    return text;
}

std::string rest_of_scene(DpdFluid const& fluid) {
    double const step = fluid.dt.value_or(0.01 * fluid.rc * std::sqrt(fluid.m / fluid.kT));
    std::string text = fmt::format(
        "# This runs once how much of it, and how long, are said, for example:\n# dimension = 3\n"
        "# box.length = [{0}, {0}, {0}]\n# particles.number = 3000\n",
        10.0 * fluid.rc);
    if (!fluid.dt) text += fmt::format("# time.step = {:.3g}\n", step);
    return text + fmt::format("# time.duration = {:.3g}\n# sample.observables = [\"kinetic_temperature\"]\n",
                              1000.0 * step);
}

}  // namespace dpd
