#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "conventions.hpp"
#include "theory/registry.hpp"

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
    auto const parts = dpd::theory::evaluate_parts(id, given);
    auto const& form = *dpd::theory::find(id);
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
        fmt::print("# dpdref {}\n{}", fmt::join(lines, " "), scene_fragment(fluid, source.mover));
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
