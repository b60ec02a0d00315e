/// @file
/// A scene that runs while someone watches, changes it and reads what it has measured so far: what the book's
/// live pages are made of.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "scene.hpp"

namespace dpd {

/// A running scene, its dimension hidden. Nothing is written to disk. Errors: InputError as parse_scene,
/// Diverged as Simulation::advance; what was measured before stays.
class Live {
public:
    /// The scene of that text with overrides "table.key=value", as `dpdref run --set` has them, at its
    /// initial state.
    static std::unique_ptr<Live> begin(std::string const& text, std::vector<std::string> const& overrides);
    virtual ~Live() = default;

    /// Goes on with other overrides from where the particles are, and measures anew. Another box is stretched
    /// to; the peculiar velocities stay. Another number of particles or dimension is refused (InputError).
    virtual void change(std::vector<std::string> const& overrides) = 0;

    /// Forgets what was measured and begins again, without equilibration.
    virtual void measure_again() = 0;

    /// Does so many steps, or fewer if the scene's duration ends.
    virtual void advance(std::uint64_t steps) = 0;

    /// Whether the scene's duration is over.
    virtual bool complete() const = 0;

    virtual Scene const& scene() const = 0;            ///< as it runs
    virtual Record const& record() const = 0;          ///< what was measured
    virtual std::uint64_t step() const = 0;            ///< done
    virtual std::uint64_t measured_steps() const = 0;  ///< since measuring began
    virtual double time() const = 0;                   ///< of the positions
    virtual double kinetic_temperature() const = 0;    ///< at this instant
    virtual double offset() const = 0;                 ///< of the image across the upper y boundary, length

    /// Row-major, particles x dimension, by id; positions in the box, velocities in the laboratory frame.
    virtual std::vector<double> positions() const = 0;
    virtual std::vector<double> velocities() const = 0;  ///< of the same shape
};

}  // namespace dpd
