// What the live pages have in the place of files and of the plain engine: a page reads none and needs only the fast one.
#include "configuration.hpp"
#include "errors.hpp"
#include "plain_stages.hpp"

namespace dpd {

Configuration read_configuration(std::string_view, std::string const& name, std::size_t, std::size_t) {
    throw InputError(name + ": cannot be read: a page has no files; allowed: another particles.start");
}

namespace {

[[noreturn]] void refuse() { throw InputError("engine: plain; allowed in a page: fast"); }

}  // namespace

template <int d>
Stage<d> plain_stage(AnyStage const&) {
    refuse();
}

template <int d>
void find_pairs_plainly(Simulation<d>&, std::uint64_t) {
    refuse();
}

template <int d>
PotentialSums plain_potential_sums(Simulation<d>&, AnyPotential const&) {
    refuse();
}

template Stage<2> plain_stage(AnyStage const&);
template Stage<3> plain_stage(AnyStage const&);
template void find_pairs_plainly(Simulation<2>&, std::uint64_t);
template void find_pairs_plainly(Simulation<3>&, std::uint64_t);
template PotentialSums plain_potential_sums(Simulation<2>&, AnyPotential const&);
template PotentialSums plain_potential_sums(Simulation<3>&, AnyPotential const&);

}  // namespace dpd
