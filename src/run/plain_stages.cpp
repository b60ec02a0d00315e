#include "plain_stages.hpp"

#include "plain.hpp"

namespace dpd {

template <int d>
Stage<d> plain_stage(AnyStage const& stage) {
    return std::visit(
        []<class S>(S const& parameters) -> Stage<d> {
            if constexpr (std::is_same_v<S, Sample>)
                return parameters;  // no engine's
            else
                return {std::string(S::kind.name), [parameters](Simulation<d>& simulation, NoiseKey key) {
                            plain::Stages<d>{simulation}.act(parameters, key);
                        }};
        },
        stage);
}

template <int d>
void find_pairs_plainly(Simulation<d>& simulation, std::uint64_t of_step) {
    plain::Stages<d>{simulation}.find_pairs();
    simulation.pairs_found(of_step);
}

template <int d>
PotentialSums plain_potential_sums(Simulation<d>& simulation, AnyPotential const& potential) {
    Field<d> force = Field<d>::Zero(simulation.particles.size(), d);
    plain::Stages<d>{simulation}.add_forces(potential, force);
    return std::visit([&](auto const& u) { return potential_sums(simulation.pair_list, force, u); },
                      potential);
}

template Stage<2> plain_stage(AnyStage const&);
template Stage<3> plain_stage(AnyStage const&);
template void find_pairs_plainly(Simulation<2>&, std::uint64_t);
template void find_pairs_plainly(Simulation<3>&, std::uint64_t);
template PotentialSums plain_potential_sums(Simulation<2>&, AnyPotential const&);
template PotentialSums plain_potential_sums(Simulation<3>&, AnyPotential const&);

}  // namespace dpd
