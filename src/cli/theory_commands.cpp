#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "conventions.hpp"
#include "errors.hpp"
#include "number.hpp"
#include "theory/memory_soft.hpp"
#include "theory/registry.hpp"
#include "theory/tune.hpp"

namespace dpd::cli {
namespace {

using Json = nlohmann::ordered_json;

// --- theory ----------------------------------------------------------------------------------------------

void list_theory(bool json) {
    Json list = Json::array();
    for (auto const& form : dpd::theory::closed_forms()) {
        std::string parameters;
        for (auto const& parameter : dpd::theory::parameters())
            if (std::find(form.parameters.begin(), form.parameters.end(), parameter.name) !=
                form.parameters.end()) {
                auto const value = form.default_text(parameter);
                parameters += fmt::format(" {}{}", parameter.name, value ? fmt::format("={}", *value) : "");
            }
        if (json)
            list.push_back({{"id", form.id},
                            {"paper", form.paper},
                            {"equation", form.equation},
                            {"quantity", form.quantity},
                            {"formula", form.formula},
                            {"parameters", form.parameters}});
        else
            fmt::print("{:<16} {:<16} {:<12} {:<40}{}\n", form.id, form.paper, form.equation, form.quantity,
                       parameters);
    }
    if (json) fmt::print("{}\n", list.dump(1));
}

void evaluate_theory(std::string const& id, std::vector<std::string> const& assignments, bool json) {
    auto const given = split(assignments);
    // the one parameter that is no number: a file of the pair distribution
    auto numbers = given;
    dpd::theory::PairTable measured;
    auto const g = std::ranges::find(numbers, "g", &std::pair<std::string, std::string>::first);
    if (id == "memory-collision-soft" && g != numbers.end()) {
        measured = dpd::theory::pair_table(g->second);
        numbers.erase(g);
    }
    auto const* const known = dpd::theory::find(id);
    auto const parts = measured.r.empty()
                           ? dpd::theory::evaluate_parts(id, numbers)
                           : dpd::theory::soft_parts(dpd::theory::Arguments(*known, numbers), measured);
    auto const& form = *known;
    if (json) {
        Json result{
            {"id", id}, {"paper", form.paper}, {"equation", form.equation}, {"quantity", form.quantity}};
        for (auto const& [name, text] : given) result["parameters"][name] = text;
        for (auto const& [name, value] : parts) result[std::string(name)] = value;
        fmt::print("{}\n", result.dump(-1, ' ', false, Json::error_handler_t::replace));
    } else {
        fmt::print("{}, {} eq. {}: {}\n{:.12g}\n", form.quantity, form.paper, form.equation, form.formula,
                   parts.front().second);
    }
}

// --- tune ------------------------------------------------------------------------------------------------

// How far the simulation was from the theory with memory in the cells that it was predicted for.
struct Deviations {
    std::vector<double> of;
    double median() {
        std::ranges::nth_element(of, of.begin() + of.size() / 2);
        return of[of.size() / 2];
    }
    double largest() const { return *std::ranges::max_element(of); }
};

std::map<std::string, Deviations> measured_deviations() {
    std::ifstream file(data_path("figures/work-precision/data/map-memory.json"));
    if (!file) return {};
    std::map<std::string, Deviations> deviations;
    Json const content = Json::parse(file);
    for (auto const& c : content["comparisons"])
        if (c["theory"].get<std::string>().starts_with("memory-"))
            deviations[c["quantity"]].of.push_back(
                std::abs(c["value"].get<double>() / c["theory_value"].get<double>() - 1.0));
    return deviations;
}

void tune_fluid(std::vector<std::string> const& assignments, bool json) {
    namespace th = dpd::theory;
    // the fluid's parameters as the closed forms take them, and beside them what is wanted
    th::Wanted wanted;
    std::vector<std::pair<std::string, std::string>> fluid;
    for (auto const& [name, text] : split(assignments)) {
        std::optional<double>* const target = name == "eta"  ? &wanted.viscosity
                                              : name == "D"  ? &wanted.diffusion_constant
                                              : name == "Sc" ? &wanted.schmidt_number
                                              : name == "dt" ? &wanted.dt
                                                             : nullptr;
        if (target == nullptr) {
            fluid.emplace_back(name, text);
            continue;
        }
        if (*target) throw InputError(fmt::format("tune: {} is given twice; allowed: once", name));
        auto const value = number_in(text);
        if (!value || !(*value > 0.0) || !std::isfinite(*value))
            throw InputError(fmt::format("tune: {} is '{}'; allowed: > 0", name, text));
        *target = *value;
    }
    static th::ClosedForm const form{
        .id = "tune",
        .paper = {},
        .equation = {},
        .quantity = {},
        .formula = {},
        .parameters = {"d", "n", "m", "kT", "rc", "box", "weight", "exponent", "scheme"},
        .without_effect = {},
        .value = nullptr};
    th::Arguments const a(form, fluid);
    th::Gas const gas{.d = a.d(), .n = a["n"], .m = a["m"], .kT = a["kT"], .rc = a["rc"]};
    double const box = a["box"] > 0.0 ? a["box"] : std::numeric_limits<double>::infinity();
    th::Tuned const tuned = th::tune(gas, wanted, a.weight(), a.scheme(), box);
    auto const& [D, kinetic, collision] = tuned.transport;
    auto deviations = measured_deviations();
    if (json) {
        Json result{{"gamma", tuned.gamma},
                    {"dt", tuned.dt},
                    {"viscosity", tuned.viscosity()},
                    {"kinetic_viscosity", kinetic.value()},
                    {"collision_viscosity", collision.value()},
                    {"diffusion_constant", D.value()},
                    {"schmidt_number", tuned.schmidt_number(gas)}};
        for (auto& [quantity, deviation] : deviations)
            result["deviation"][quantity] = {{"median", deviation.median()},
                                             {"largest", deviation.largest()}};
        fmt::print("{}\n", result.dump());
        return;
    }
    fmt::print("gamma = {:.4g}, dt = {:.4g}\n", tuned.gamma, tuned.dt);
    auto const line = [&](char const* name, std::string const& quantity, double value, double chaos) {
        fmt::print("  {:<22} {:<9.4g} molecular chaos: {:<9.4g}", name, value, chaos);
        if (deviations.contains(quantity))
            fmt::print(" simulation was off by {:.1f} % (median), {:.1f} % (largest)",
                       100.0 * deviations[quantity].median(), 100.0 * deviations[quantity].largest());
        fmt::print("\n");
    };
    line("kinetic viscosity", "kinetic_viscosity", kinetic.value(), kinetic.at_once);
    line("collision viscosity", "collision_viscosity", collision.value(), collision.at_once);
    line("their sum, eta", "", tuned.viscosity(), kinetic.at_once + collision.at_once);
    line("diffusion constant, D", "diffusion_constant", D.value(), D.at_once);
    line("Schmidt number, Sc", "", tuned.schmidt_number(gas),
         (kinetic.at_once + collision.at_once) / (gas.n * gas.m * D.at_once));
}

// --- convert ---------------------------------------------------------------------------------------------

void list_codes() {
    for (auto const& code : codes()) {
        fmt::print("{}: {}\n", code.name, code.title);
        for (auto const& key : code.keys)
            fmt::print("    {:<24} {}\n",
                       key.fallback.empty()  ? std::string(key.name)
                       : key.fallback == "-" ? fmt::format("[{}]", key.name)
                                             : fmt::format("{}={}", key.name, key.fallback),
                       key.meaning);
    }
}

// The lines can be the arguments of the way back; a scene has them in its first line.
void convert_parameters(std::string const& from, std::string const& to,
                        std::vector<std::string> const& assignments) {
    auto const& source = find_code(from);
    auto const& target = find_code(to);
    auto const fluid = read_fluid(source, split(assignments));
    std::vector<std::string> lines;
    for (auto const& [key, value] : write_fluid(target, fluid))
        lines.push_back(fmt::format("{}={}", key, value));
    if (to == "dpdref")
        fmt::print("# dpdref {}\n{}{}", fmt::join(lines, " "), scene_fragment(fluid, source.mover),
                   rest_of_scene(fluid));
    else
        fmt::print("{}\n", fmt::join(lines, "\n"));
}

}  // namespace

Command theory(CLI::App& app) {
    struct Options {
        std::string id;
        std::vector<std::string> assignments;
        bool json = false;
    };
    auto const options = std::make_shared<Options>();
    auto* const command = app.add_subcommand("theory", "list the closed forms, or evaluate one");
    command->add_option("id", options->id, "id of a closed form");
    command->add_option("parameters", options->assignments, "key=value ...");
    command->add_flag("--json", options->json, "print JSON");
    return {command, [options] {
                if (options->id.empty())
                    list_theory(options->json);
                else
                    evaluate_theory(options->id, options->assignments, options->json);
                return exit_done;
            }};
}

Command tune(CLI::App& app) {
    struct Options {
        std::vector<std::string> assignments;
        bool json = false;
    };
    auto const options = std::make_shared<Options>();
    auto* const command =
        app.add_subcommand("tune", "friction and step of an ideal S1 gas for a wanted eta, D or Sc");
    command->add_option("parameters", options->assignments, "key=value ...: two of eta, D, Sc, dt; n; others")
        ->required();
    command->add_flag("--json", options->json, "print JSON");
    return {command, [options] {
                tune_fluid(options->assignments, options->json);
                return exit_done;
            }};
}

Command convert(CLI::App& app) {
    struct Options {
        std::string from, to;
        std::vector<std::string> assignments;
    };
    auto const options = std::make_shared<Options>();
    auto* const command = app.add_subcommand("convert", "list codes, or convert parameters between two");
    command->add_option("from", options->from, "code or paper that the parameters are of");
    command->add_option("to", options->to, "code or paper that wants them; dpdref: a scene's part")
        ->needs("from");
    command->add_option("parameters", options->assignments, "key=value ...");
    return {command, [options] {
                if (options->from.empty())
                    list_codes();
                else
                    convert_parameters(options->from, options->to, options->assignments);
                return exit_done;
            }};
}

}  // namespace dpd::cli
