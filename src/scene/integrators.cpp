#include "integrators.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "files.hpp"

namespace dpd {

std::vector<std::string> settings_of(TomlReader& reader, std::string const& key) {
    std::vector<std::string> assignments;
    auto const table = reader.table(key);
    if (!table) return assignments;
    for (auto const& [name, node] : table->raw()) {
        std::ostringstream value;
        node.visit([&](auto const& element) { value << element; });
        assignments.push_back(fmt::format("{}={}", name.str(), value.str()));
    }
    return assignments;
}

std::vector<Integrator> read_integrators(std::filesystem::path const& file) {
    toml::table const document = parse_toml(read_file(file), file.string());
    TomlReader root(document, "", file.string());
    std::vector<Integrator> integrators;
    for (auto& table : root.tables("integrator")) {
        Integrator integrator;
        integrator.name = table.text("name", std::nullopt);
        integrator.friction = table.text("friction", "");
        integrator.friction_scale = table.number("friction_scale", 1.0, positive);
        integrator.least_step = table.number("least_step", 0.0, positive);
        if (table.has("largest_friction_step"))
            integrator.largest_friction_step = table.number("largest_friction_step", std::nullopt, positive);
        integrator.noise = table.text("noise", "");
        integrator.repulsion = table.text("repulsion", "");
        integrator.other_dynamics = table.boolean("other_dynamics", false);
        integrator.stages = table.texts("stages", std::nullopt);
        integrator.sheared_stages = table.texts("sheared_stages", std::vector<std::string>{});
        integrator.settings = settings_of(table, "settings");
        table.finish();
        integrators.push_back(std::move(integrator));
    }
    root.finish();
    return integrators;
}

std::vector<Integrator> chosen_integrators(TomlReader& definition, std::vector<Integrator> const& known) {
    std::vector<std::string_view> names;
    for (auto const& integrator : known) names.push_back(integrator.name);
    std::vector<Integrator> chosen;
    for (auto const& name : definition.texts("integrators", std::nullopt, names))
        chosen.push_back(*std::ranges::find(known, name, &Integrator::name));
    if (chosen.empty()) definition.fail("integrators", "is empty; allowed: names of integrators.toml");
    return chosen;
}

std::vector<std::string> scene_settings(Integrator const& integrator, bool sheared, double friction,
                                        double repulsion, double kT) {
    auto stages = sheared ? integrator.sheared_stages : integrator.stages;
    // modified_verlet moves the particles, too, and stays
    bool const holds_repulsion = repulsion > 0.0 || integrator.repulsion.starts_with("modified_verlet");
    if (!holds_repulsion) {
        std::erase_if(stages, [](auto const& stage) { return stage == "force" || stage == "half_kick"; });
        std::replace(stages.begin(), stages.end(), std::string("verlet"), std::string("drift"));
    }
    std::vector<std::string> settings{fmt::format("stages=['{}']", fmt::join(stages, "','"))};
    if (!integrator.friction.empty())
        settings.push_back(fmt::format("{}={}", integrator.friction, integrator.friction_scale * friction));
    if (holds_repulsion && !integrator.repulsion.empty())
        settings.push_back(fmt::format("{}={}", integrator.repulsion, repulsion));
    if (!integrator.noise.empty())
        settings.push_back(fmt::format("{}={:.17g}", integrator.noise, std::sqrt(2.0 * friction * kT)));
    for (auto const& setting : integrator.settings)
        if (holds_repulsion || !setting.starts_with("verlet.")) settings.push_back(setting);
    return settings;
}

}  // namespace dpd
