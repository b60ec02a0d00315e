/// @file
/// The parameters of the stages that have some, as a scene gives them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "scheme.hpp"
#include "weight.hpp"

namespace dpd {

/// Which cells share a scaling factor.
enum class Rescaling {
    global,       ///< all
    layers,       ///< those of one layer across y
    monte_carlo,  ///< none: each cell tries a random one (Hecht, Harting, Ihle & Herrmann 2005)
};

inline constexpr std::array<std::string_view, 3> rescaling_names{"global", "layers", "monte_carlo"};

/// Most sweeps over the pairs in one Lowe step.
inline constexpr double most_sweeps = 100.0;

struct ShardlowParameters {
    double friction = 1.0, cutoff = 1.0, kT = 1.0;
    Weight weight = Weight::linear;
    Scheme scheme = Scheme::shardlow;
};

struct LoweParameters {
    double rate = 1.0, cutoff = 1.0, kT = 1.0;
};

struct RescaleParameters {
    Rescaling mode = Rescaling::global;
    double kT = 1.0, cell = 1.0, amplitude = 0.3;
    std::uint64_t thickness = 1;
};

struct BodyForceParameters {
    double acceleration = 0.0;
    bool opposed = false;
};

struct ModifiedVerletParameters {
    double gamma = 4.5, sigma = 3.0, cutoff = 1.0, lambda = 0.5;
    bool friction_again = false;
    Weight weight = Weight::quadratic;
};

struct EulerParameters {
    double gamma = 1.0, sigma = 1.0, cutoff = 1.0;
    Weight weight = Weight::linear;
    std::optional<Weight> random_weight;  ///< none: matched, w_R^2 = w_D
};

}  // namespace dpd
