#include "state_point.hpp"

#include <fmt/format.h>

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

// The unit of a quantity; nothing for those that only dpdref derives.
std::optional<double> unit_of(std::string_view quantity, Units const& of, int d) {
    if (quantity.ends_with("temperature") || quantity == "potential_energy") return of.energy;
    if (quantity == "pressure") return of.energy / std::pow(of.length, d);
    if (quantity.ends_with("diffusion_constant")) return of.length * of.length / of.time();
    if (quantity == "viscosity" ||
        (quantity.ends_with("_viscosity") && !quantity.starts_with("potential_viscosity_")))
        return of.mass / (std::pow(of.length, d - 2) * of.time());
    if (quantity == "speed_of_sound") return of.length / of.time();
    return {};
}

double number_of(Json const& parameters, char const* key, double fallback) {
    return parameters.contains(key) ? parameters[key].get<double>() : fallback;
}

void scale(Json& number, double factor) { number = factor * number.get<double>(); }

}  // namespace

double parameter_unit(std::string_view key, Units const& of, int d) {
    if (key == "n") return std::pow(of.length, -d);
    if (key == "a") return of.energy / of.length;
    if (key == "gamma") return of.mass / of.time();
    if (key == "sigma") return std::sqrt(of.energy * of.mass / of.time());
    if (key == "dt") return of.time();
    if (key == "Gamma" || key == "shear_rate") return 1.0 / of.time();
    if (key == "rc") return of.length;
    if (key == "m") return of.mass;
    if (key == "kT") return of.energy;
    return 1.0;
}

Units units_of(Json const& parameters) {
    return {.length = parameters.contains("a") ? number_of(parameters, "rc", 1.0) : 1.0,
            .mass = number_of(parameters, "m", 1.0),
            .energy = number_of(parameters, "kT", 1.0)};
}

Json parameters_in(Json const& parameters, Units const& units) {
    Json scaled = parameters;
    Units const own = units_of(parameters);
    int const d = parameters["d"].get<int>();
    for (auto& [key, value] : scaled.items())
        if (value.is_number_float())
            value = value.get<double>() * parameter_unit(key, units, d) / parameter_unit(key, own, d);
        else if (key == "L")
            for (auto& side : value) side = side.get<double>() * units.length / own.length;
    return scaled;
}

Json state_in(Json const& state, Units const& units) {
    Json const& parameters = state["parameters"];
    Units const own = units_of(parameters);
    if (units == own) return state;
    int const d = parameters["d"].get<int>();
    Json scaled = state;
    scaled["parameters"] = parameters_in(parameters, units);
    scaled["quantities"] = Json::object();
    for (auto const& [name, quantity] : state["quantities"].items()) {
        auto const unit = unit_of(name, units, d), its = unit_of(name, own, d);
        if (!unit) continue;
        Json& in_units = scaled["quantities"][name] = quantity;
        scale(in_units["value"], *unit / *its);
        scale(in_units["error"], *unit / *its);
        if (in_units.contains("closed_form")) scale(in_units["closed_form"]["value"], *unit / *its);
    }
    if (scaled.contains("curves"))
        for (auto& [name, curve] : scaled["curves"].items())
            if (curve.contains("x"))
                for (auto& x : curve["x"]) scale(x, units.length / own.length);
    return scaled;
}

std::array<std::string, naming_columns.size()> naming_cells(Json const& parameters) {
    Json const reduced = parameters_in(parameters, {});
    auto const number = [&](char const* key) {
        return reduced.contains(key) ? fmt::format("{:.6g}", reduced[key].get<double>()) : std::string("-");
    };
    auto const text = [&](char const* key) {
        return reduced.contains(key) ? reduced[key].get<std::string>() : std::string("-");
    };
    std::string const friction =
        reduced.contains("Gamma") ? fmt::format("rate {}", number("Gamma")) : number("gamma");
    return {number("d"),    number("n"),        number("a"), friction,
            text("weight"), text("integrator"), number("dt")};
}

}  // namespace dpd
