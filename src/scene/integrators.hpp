/// @file
/// Integrators by name, so that one fluid can be put to all of them: definitions that the stability maps, the
/// study of work and precision and the reference answers share (verification/integrators.toml).
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "toml_reader.hpp"

namespace dpd {

/// An integrator as keys of a scene.
struct Integrator {
    std::string name;             ///< of the integrator
    std::string friction;         ///< the key that takes a fluid's friction; empty: it has none
    std::string noise;            ///< the one that takes the noise
    std::string repulsion;        ///< the one that takes the strength of the repulsion
    double friction_scale = 1.0;  ///< on the fluid's friction
    double least_step = 0.0;      ///< of the study of work and precision: shorter ones are too dear
    /// Of the stability maps: the longest step tried, times the friction.
    double largest_friction_step = std::numeric_limits<double>::infinity();
    bool other_dynamics = false;              ///< its transport coefficients are its own
    std::vector<std::string> settings;        ///< further keys, "table.key=value"
    std::vector<std::string> stages;          ///< of a step at rest
    std::vector<std::string> sheared_stages;  ///< in shear; none where its stress is not known
};

/// The tables [[integrator]] of a file. InputError as for scenes.
std::vector<Integrator> read_integrators(std::filesystem::path const& file);

/// The integrators that the list `integrators` of a definition names, in its order. InputError as for scenes.
std::vector<Integrator> chosen_integrators(TomlReader& definition, std::vector<Integrator> const& known);

/// What makes an integrator's scene of a fluid: its stages, friction, noise sqrt(2 friction kT), repulsion.
/// Without a repulsion the stages that would hold it go: `verlet` becomes `drift`.
std::vector<std::string> scene_settings(Integrator const& integrator, bool sheared, double friction,
                                        double repulsion, double kT = 1.0);

/// A table { "table.key" = value, ... } as assignments "table.key=value"; empty if it is not there.
std::vector<std::string> settings_of(TomlReader& reader, std::string const& key);

}  // namespace dpd
