#include "registry.hpp"

#include <algorithm>
#include <array>
#include <cfenv>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "rows.hpp"

namespace dpd::theory {
namespace {

constexpr std::string_view zero_or_more = ">= 0";
// (a power takes its exponent from beside the weight of the friction; as w_R it has none)
std::string const weight_names = name_list<Weight::Kind>(),
                  random_weight_names = "matched, " + weight_names.substr(0, weight_names.rfind(", power")),
                  scheme_names = name_list<Scheme>();

std::array<Parameter, 37> const all_parameters{{
    {"d", "dimension of space", "3", "2 or 3"},
    {"n", "number density", std::nullopt, "> 0"},
    {"m", "mass of a particle", "1", "> 0"},
    {"kT", "temperature, k_B T", "1", "> 0"},
    {"gamma", "strength of the friction (its value where the weight is 1)", std::nullopt, "> 0"},
    {"sigma", "strength of the noise", std::nullopt, "> 0"},
    {"rc", "cutoff radius", "1", "> 0"},
    {"dt", "time step", std::nullopt, "> 0"},
    {"Gamma", "Lowe-Andersen rate, updates of a pair per unit time", std::nullopt, "> 0"},
    {"L", "side of the periodic cube or square; width of the channel", std::nullopt, "> 0"},
    {"box", "side of the periodic cube or square; 0: infinite", "0", zero_or_more},
    {"eta", "shear viscosity", std::nullopt, "> 0"},
    {"D", "self-diffusion constant", std::nullopt, "> 0"},
    {"t", "time", std::nullopt, "> 0"},
    {"phi_pot", "relaxation rate of a velocity by the potential", std::nullopt, zero_or_more},
    {"phi_dpd", "relaxation rate of a velocity by the thermostat", std::nullopt, zero_or_more},
    {"a", "strength of the soft potential, its force at r = 0 (in ng16: in units of kT/rc)", std::nullopt,
     "> 0"},
    {"Nm", "atoms per DPD particle", std::nullopt, "> 0"},
    {"alpha", "constant of Groot and Warren's equation of state", "0.101", "> 0"},
    {"inverse_compressibility", "(1/kT) dp/dn of the atoms", "15.36", "> 0"},
    {"n_md", "number density of the atoms, 1/sigma^3", "0.8", "> 0"},
    {"eta_md", "viscosity of the atoms, m/(sigma tau)", "1.97", "> 0"},
    {"L_md", "side of the domain, sigma", "34.2", "> 0"},
    {"force_md", "body force on an atom, m sigma/tau^2", "0.0085", "> 0"},
    {"force", "body force on a particle", std::nullopt, "> 0"},
    {"u_max", "velocity at the centre of the channel", std::nullopt, "> 0"},
    {"index", "exponent of the shear rate in the stress", std::nullopt, "> 0"},
    {"z", "distance from the wall", std::nullopt, zero_or_more},
    {"msd", "mean-square displacement", std::nullopt, "> 0"},
    {"neighbours", "mean number of particles in the shell around a particle", std::nullopt, "> 0"},
    {"r_min", "inner radius of the shell", std::nullopt, zero_or_more},
    {"r_max", "outer radius of the shell", std::nullopt, "> 0"},
    {"r", "distance of a pair", std::nullopt, "> 0"},
    {"weight", "weight function of the friction", "linear", weight_names},
    {"exponent", "of weight=power, (1 - r/rc)^exponent", "none", "0 to 100, with weight=power alone"},
    {"random_weight", "weight function of the noise; matched: its square is the weight of the friction",
     "matched", random_weight_names},
    {"scheme", "update of a pair: its A as a function of w dt/m", "shardlow", scheme_names},
}};

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

std::string listed(std::span<std::string_view const> names) {
    std::string line;
    for (auto name : names) line += (line.empty() ? "" : " ") + std::string(name);
    return line;
}

[[noreturn]] void refuse(Parameter const& parameter, std::string_view text) {
    throw std::invalid_argument("parameter " + quoted(parameter.name) + " is " + quoted(text) +
                                "; allowed: " + std::string(parameter.allowed));
}

/// A finite number that takes up the whole text.
std::optional<double> number_from(std::string_view text) {
    double value = 0.0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

Parameter const* find_parameter(std::string_view name) {
    auto const found = std::ranges::find(all_parameters, name, &Parameter::name);
    return found == all_parameters.end() ? nullptr : &*found;
}

std::vector<ClosedForm> const& all_forms() {
    static auto const forms = joined({my1997_rows(), ng2007_rows(), pk2006_rows(), lennard_jones_rows(),
                                      hydrodynamics_rows(), harmonic_rows(), memory_rows()});
    return forms;
}

}  // namespace

std::vector<ClosedForm> joined(std::initializer_list<std::vector<ClosedForm>> groups) {
    std::vector<ClosedForm> all;
    for (auto const& group : groups) all.insert(all.end(), group.begin(), group.end());
    return all;
}

std::span<Parameter const> parameters() { return all_parameters; }

std::span<ClosedForm const> closed_forms() { return all_forms(); }

ClosedForm const* find(std::string_view id) {
    auto const found = std::ranges::find(all_forms(), id, &ClosedForm::id);
    return found == all_forms().end() ? nullptr : &*found;
}

std::string_view with_memory(std::string_view id) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 7> pairs{
        {{"my22", "memory-kT"},
         {"ng8", "memory-kinetic"},
         {"ng8-lowe", "memory-kinetic-lowe"},
         {"ng12", "memory-collision"},
         {"ng12-lowe", "memory-collision-lowe"},
         {"ng17", "memory-D"},
         {"ng17-lowe", "memory-D-lowe"}}};
    auto const found = std::ranges::find(pairs, id, &std::pair<std::string_view, std::string_view>::first);
    return found == pairs.end() ? std::string_view() : found->second;
}

std::optional<std::string_view> ClosedForm::default_text(Parameter const& parameter) const {
    auto const own = std::ranges::find(defaults, parameter.name, [](auto const& pair) { return pair.first; });
    return own == defaults.end() ? parameter.default_text : own->second;
}

Arguments::Arguments(ClosedForm const& form, std::span<std::pair<std::string, std::string> const> given) {
    auto const has = [](auto const& names, std::string_view name) {
        return std::ranges::find(names, name) != names.end();
    };
    // zero is a value of a parameter that is zero unless given
    auto const taken = [&](std::string_view name) {
        Parameter parameter = *find_parameter(name);
        if (form.default_text(parameter) == "0") parameter.allowed = zero_or_more;
        return parameter;
    };
    std::vector<std::string_view> seen;
    for (auto const& [name, text] : given) {
        if (!has(form.parameters, name) && !has(form.without_effect, name))
            throw std::invalid_argument(std::string(form.id) + " has no parameter " + quoted(name) +
                                        " (given as " + quoted(text) +
                                        "); allowed: " + listed(form.parameters));
        if (has(seen, name))
            throw std::invalid_argument("parameter " + quoted(name) + " is given twice, the second time as " +
                                        quoted(text) + "; allowed: once");
        seen.push_back(name);
        set(taken(name), text);
    }
    for (auto name : form.parameters) {
        if (has(seen, name)) continue;
        auto const parameter = taken(name);
        auto const text = form.default_text(parameter);
        if (!text)
            throw std::invalid_argument(std::string(form.id) + " needs parameter " + quoted(name) + " (" +
                                        std::string(parameter.meaning) +
                                        "), which was not given; allowed: " + std::string(parameter.allowed));
        set(parameter, *text);
    }
    auto const exponent = numbers_.find("exponent");
    bool const has_exponent = exponent != numbers_.end();
    if (has_exponent != (weight_.kind == Weight::power))
        throw std::invalid_argument(
            std::string(form.id) +
            (has_exponent ? " has parameter 'exponent' with another weight than power; allowed: none"
                          : " needs parameter 'exponent' with weight=power; allowed: 0 to 100"));
    if (has_exponent) weight_ = power_weight(exponent->second);
}

void Arguments::set(Parameter const& parameter, std::string_view text) {
    if (parameter.name == "weight" || parameter.name == "random_weight") {
        auto const kind = value_of<Weight::Kind>(text);
        bool const random = parameter.name == "random_weight", matched = random && text == "matched";
        if ((!kind && !matched) || (random && kind == Weight::power)) refuse(parameter, text);
        if (!random)
            weight_ = *kind;
        else
            random_weight_ = kind;
        return;
    }
    if (parameter.name == "scheme") {
        auto const scheme = value_of<Scheme>(text);
        if (!scheme) refuse(parameter, text);
        scheme_ = *scheme;
        return;
    }
    auto const value = number_from(text);
    if (parameter.name == "exponent") {
        if (text == "none") return;
        if (!value || *value < 0.0 || *value > largest_exponent) refuse(parameter, text);
    } else if (!value || *value < 0.0 || (*value == 0.0 && parameter.allowed != zero_or_more)) {
        refuse(parameter, text);
    }
    if (parameter.name == "d" && *value != 2.0 && *value != 3.0) refuse(parameter, text);
    numbers_[parameter.name] = *value;
}

double Arguments::operator[](std::string_view name) const {
    auto const found = numbers_.find(name);
    if (found != numbers_.end()) return found->second;
    auto const* parameter = find_parameter(name);
    if (parameter == nullptr || !parameter->default_text)
        throw std::logic_error("closed form reads undeclared parameter " + quoted(name));
    return *number_from(*parameter->default_text);
}

std::vector<std::pair<std::string_view, double>> evaluate_parts(
    std::string_view id, std::span<std::pair<std::string, std::string> const> given) {
    auto const* form = find(id);
    if (form == nullptr) {
        std::vector<std::string_view> ids;
        for (auto const& known : closed_forms()) ids.push_back(known.id);
        throw std::invalid_argument("no closed form " + quoted(id) + "; allowed: " + listed(ids));
    }
    Arguments const arguments(*form, given);
    using Parts = std::vector<std::pair<std::string_view, double>>;
    std::feclearexcept(FE_OVERFLOW | FE_UNDERFLOW);
    auto const parts = form->parts ? form->parts(arguments) : Parts{{"value", form->value(arguments)}};
    // a zero that is what is left of a number too large or too small on the way is no value
    bool const lost = parts.front().second == 0.0 && std::fetestexcept(FE_OVERFLOW | FE_UNDERFLOW) != 0;
    if (lost || !std::isfinite(parts.front().second))
        throw std::domain_error(std::string(id) +
                                " has no finite value there: a parameter is too large or too small");
    return parts;
}

double evaluate(std::string_view id, std::span<std::pair<std::string, std::string> const> given) {
    return evaluate_parts(id, given).front().second;
}

}  // namespace dpd::theory
