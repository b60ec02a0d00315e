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
    // with no repulsion the middle scheme is the other one seen half a drift earlier
    bool const kicks = mover == Mover::middle && repels;
    bool const forces = mover == Mover::velocity_verlet, euler = mover == Mover::euler;
    std::string_view const stages =
        forces   ? R"("modified_verlet", "sample")"
        : euler  ? R"("euler", "sample", "drift", "kick")"
        : kicks  ? R"("half_kick", "half_kick", "half_drift", "shardlow", "half_drift", "sample")"
        : repels ? R"("shardlow", "sample", "verlet")"
                 : R"("shardlow", "sample", "drift")";
    std::string text =
        fmt::format("stages = [{}]\n[particles]\nmass = {}\nkT = {}\n", stages, fluid.m, fluid.kT);
    if (forces || euler)
        text += fmt::format("[{}]\ngamma = {}\nsigma = {}\n", forces ? "modified_verlet" : "euler",
                            fluid.gamma, sigma);
    else
        text += fmt::format("[shardlow]\nfriction = {}\nkT = {}\nscheme = \"{}\"\n", fluid.gamma, fluid.kT,
                            mover == Mover::s1 ? "shardlow" : "exponential");
    text += fmt::format("weight = \"{}\"\ncutoff = {}\n", name_of(fluid.weight), fluid.rc);
    if (repels || forces)
        text += fmt::format("[{}.soft]\nstrength = {}\ncutoff = {}\n",
                            forces  ? "modified_verlet"
                            : kicks ? "half_kick"
                                    : "verlet",
                            strength, fluid.rc);
    if (fluid.dt) text += fmt::format("[time]\nstep = {}\n", *fluid.dt);
    return text;
}

}  // namespace dpd
