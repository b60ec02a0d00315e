/// @file
/// Observables: what a scene asks to be measured, sampled between the thermostat and the drift.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "archive.hpp"
#include "observables.hpp"
#include "simulation.hpp"
#include "stress.hpp"

namespace dpd {

/// Number of blocks in which curves are kept.
inline constexpr Eigen::Index curve_blocks = 8;

/// A time correlation: how far apart its points are, how many there are, how often it starts anew. Steps.
struct CorrelationParameters {
    std::uint64_t spacing = 1;         ///< between lags, steps
    std::uint64_t lags = 50;           ///< how many
    std::uint64_t origin_spacing = 1;  ///< a multiple of `spacing`
};

/// Profiles of velocity and density across the flow.
struct ProfileParameters {
    std::uint64_t interval = 1;  ///< between samples, steps
    std::uint64_t bins = 40;     ///< over the side along y
    bool temperature = false;    ///< whether kT of each bin is sampled, too
};

/// The radial distribution function g(r).
struct RadialDistributionParameters {
    std::uint64_t interval = 100;  ///< between samples, steps
    std::uint64_t bins = 100;      ///< over the range
    double range = 2.0;            ///< largest distance, length
};

/// Bonds between particles closer than `range`: the order parameters of crystals.
struct BondOrderParameters {
    std::uint64_t interval = 100;  ///< between samples, steps
    double range = 1.0;            ///< longest bond, length
};

/// What is measured, and when.
struct SampleParameters {
    std::uint64_t interval = 1;                      ///< steps between samples of the scalars
    std::uint64_t equilibration = 0;                 ///< steps before the first sample
    std::uint64_t steps = 0;                         ///< last step, or the last that may be
    std::set<std::string, std::less<>> observables;  ///< names of the table, observables.hpp
    bool configuration = false;                      ///< the positions at the last sample
    std::uint64_t green_kubo_window = 0;  ///< steps over which stress is summed for the viscosity; 0: none
    int components = 0;  ///< of displacements and velocities that tell of diffusion: the last so many axes
    std::optional<ProfileParameters> profile;                         ///< none: not sampled
    std::optional<RadialDistributionParameters> radial_distribution;  ///< none: not sampled
    std::optional<CorrelationParameters> mean_square_displacement;    ///< none: not sampled
    std::optional<CorrelationParameters> velocity_autocorrelation;    ///< none: not sampled
    std::optional<BondOrderParameters> bond_order;                    ///< none: not sampled

    /// Whether an observable is wanted.
    bool asks(ObservableName observable) const { return observables.contains(observable.text); }
};

/// A function sampled in bins, kept in blocks of time for its error: mean = sum/weight.
struct Curve {
    std::vector<double> x;   ///< of the points
    Eigen::ArrayXXd sum;     ///< bins x blocks
    Eigen::ArrayXXd weight;  ///< bins x blocks

    /// Makes room for so many bins, without data.
    void resize(std::size_t bins);
    /// Half as many blocks of twice the length; the other half has no data.
    void double_blocks();
    /// Block means of one bin; blocks without data are left out.
    std::vector<double> block_means(Eigen::Index bin) const;
};

/// What was measured so far: scalars by name, one value per sample, and curves by name.
struct Record {
    std::map<std::string, std::vector<double>, std::less<>> series;  ///< one value per sample
    std::map<std::string, Curve> curves;                             ///< by name
    Eigen::ArrayXXd configuration;  ///< positions by id, in the box; empty unless asked for
    /// Stores or restores all of it.
    void archive(Archive& archive);
};

/// Bond-orientational order, three dimensions, from the pairs closer than `range`. `global` is Steinhardt's
/// Q_l of all bonds (P. J. Steinhardt, D. R. Nelson, M. Ronchetti, Phys. Rev. B 28 (1983) 784), which
/// vanishes as N^(-1/2) in a fluid; `local` the mean over particles of q_l averaged over neighbours (W.
/// Lechner, C. Dellago, J. Chem. Phys. 129 (2008) 114707), which does not care how crystallites are turned.
/// `frozen` particles count as neighbours only.
struct BondOrder {
    double global = 0.0;  ///< of all bonds together
    double local = 0.0;   ///< averaged over particles
};
BondOrder bond_order(Particles<3> const& particles, PairList<3> const& pairs, int l);

/// Samples a simulation; `operator()` is a stage.
template <int d>
class Recorder {
public:
    /// For runs of that simulation.
    Recorder(SampleParameters parameters, Simulation<d> const& simulation);
    /// Samples what is due in this step.
    void operator()(Simulation<d>& simulation);
    /// Stores or restores what was measured and the open time origins.
    void archive(Archive& archive);
    /// Forgets the open time origins: the run is over.
    void finish();
    /// What was measured so far.
    Record const& record() const { return record_; }

private:
    /// One time origin of a correlation: what was stored, by particle id, and its product with each lag so
    /// far.
    struct Origin {
        std::uint64_t step = 0;
        Field<d> value;
        Eigen::ArrayXd products;
    };

    void sample_profile(Simulation<d> const&, Eigen::Index block);
    void sample_radial_distribution(Simulation<d> const&, Eigen::Index block);
    void sample_bond_order(Simulation<d> const&);
    template <class Value, class Product>
    void correlate(Simulation<d> const&, CorrelationParameters const&, std::string const& name,
                   std::vector<Origin>&, Value value, Product product);
    Eigen::Index block_of(std::uint64_t step) const;
    // Steps in which samples are taken, or the most that there may be.
    std::uint64_t production() const {
        return std::max<std::uint64_t>(1, parameters_.steps - parameters_.equilibration);
    }
    void archive_origins(Archive& archive, std::string const& name, std::vector<Origin>& origins);
    void check(Archive const& archive, Record const& expected) const;

    SampleParameters parameters_;
    double time_step_ = 0.0;
    Eigen::Index particles_ = 0;
    std::uint64_t span_ = 1;  // steps after equilibration over which the blocks of curves reach
    Record record_;
    PairSearch<d> wide_search_;  // for g(r) beyond the cutoff
    PairSearch<d> bond_search_;
    PairList<d> wide_pairs_;
    std::vector<Origin> displacement_origins_, velocity_origins_;
};

extern template class Recorder<2>;
extern template class Recorder<3>;

}  // namespace dpd
