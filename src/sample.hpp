/// @file
/// Observables: what a scene asks to be measured, sampled between the thermostat and the drift.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "simulation.hpp"
#include "storage.hpp"

namespace dpd {

/// A time correlation: how far apart its points are, how many there are, how often it starts anew. Steps.
struct CorrelationParameters {
    std::uint64_t spacing = 1;
    std::uint64_t lags = 50;
    std::uint64_t origin_spacing = 1;  ///< a multiple of `spacing`
};

struct ProfileParameters {
    std::uint64_t interval = 1;
    std::uint64_t bins = 40;
    bool temperature = false;
};

struct RadialDistributionParameters {
    std::uint64_t interval = 100;
    std::uint64_t bins = 100;
    double range = 2.0;
};

struct SampleParameters {
    std::uint64_t interval = 1;       ///< steps between samples of the scalars
    std::uint64_t equilibration = 0;  ///< steps before the first sample
    std::uint64_t steps = 0;          ///< last step
    bool kinetic_temperature = false;
    bool stress = false;
    bool friction_stress = false;
    bool momentum = false;
    bool potential_energy = false;
    bool pressure = false;
    bool configurational_temperature = false;
    std::optional<ProfileParameters> profile;
    std::optional<RadialDistributionParameters> radial_distribution;
    std::optional<CorrelationParameters> mean_square_displacement;
    std::optional<CorrelationParameters> velocity_autocorrelation;
};

/// A function sampled in bins, kept in blocks of time for its error: mean = sum/weight.
struct Curve {
    std::vector<double> x;
    Eigen::ArrayXXd sum;     ///< bins x blocks
    Eigen::ArrayXXd weight;  ///< bins x blocks

    void resize(std::size_t bins);
    /// Block means of one bin; blocks without data are left out.
    std::vector<double> block_means(Eigen::Index bin) const;
};

/// Number of blocks in which curves are kept.
inline constexpr Eigen::Index curve_blocks = 8;

/// What was measured so far: scalars by name, one value per sample, and curves by name.
struct Record {
    std::map<std::string, std::vector<double>> series;
    std::map<std::string, Curve> curves;
    void archive(Archive& archive);
};

/// Contribution of one drift to the kinetic stress sigma_xy: minus the momentum that the particles carry
/// through planes of constant y, averaged over all planes, per area and time. A particle that moves from y to
/// y + v_y dt passes planes whose flow is, on average, that at mid-drift, so its peculiar velocity counts
/// there: sigma = -(m/V) sum v_y (u_x - shear_rate v_y dt/2), with u_x at the start of the drift. Equals the
/// integral @eq{NG2007,7} without an assumption on P(v).
template <int d>
double kinetic_stress(Particles<d> const& particles, Box<d> const& box, double time_step);

/// Contribution of the last pair thermostat to sigma_xy (none: 0): minus the momentum that pairs exchange
/// through planes of constant y, averaged over all planes: -(m/(V dt)) sum_pairs impulse e_x y_ij.
/// @eq{NG2007,11}
template <int d>
double collision_stress(PairList<d> const& pairs, double mass, Box<d> const& box, double time_step);

/// Samples a simulation; `operator()` is a stage.
template <int d>
class Recorder {
public:
    Recorder(SampleParameters parameters, Simulation<d> const& simulation);
    void operator()(Simulation<d>& simulation);
    void archive(Archive& archive);
    Record const& record() const { return record_; }

private:
    /// One time origin of a correlation: what was stored, by particle id.
    struct Origin {
        std::uint64_t step = 0;
        Field<d> value;
    };

    void sample_stress(Simulation<d>&);
    void sample_potential(Simulation<d>&);
    void sample_profile(Simulation<d> const&, Eigen::Index block);
    void sample_radial_distribution(Simulation<d> const&, Eigen::Index block);
    template <class Value, class Product>
    void correlate(Simulation<d> const&, CorrelationParameters const&, std::string const& name,
                   std::vector<Origin>&, Value value, Product product);
    Eigen::Index block_of(std::uint64_t step) const;
    void archive_origins(Archive& archive, std::string const& name, std::vector<Origin>& origins);

    SampleParameters parameters_;
    double time_step_ = 0.0;
    Record record_;
    PairSearch<d> wide_search_;  // for g(r) beyond the cutoff
    PairList<d> wide_pairs_;
    std::vector<Origin> displacement_origins_, velocity_origins_;
};

extern template class Recorder<2>;
extern template class Recorder<3>;

}  // namespace dpd
