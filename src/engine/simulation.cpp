#include "simulation.hpp"

#include <fmt/format.h>

#include <cmath>

#include "elementary.hpp"
#include "sums.hpp"

namespace dpd {
namespace {

// Rows drift out of cell order slowly; this is how many searches a sorting of the state serves.
constexpr std::uint64_t searches_per_sorting = 16;

}  // namespace

template <int d>
PairList<d>& Simulation<d>::pairs() {
    if (pairs_of_step()) return pair_list;
    if (counters.searches % searches_per_sorting == 0) sort_particles();
    find_pairs_again(step);
    counters.count_search(pair_list);
    if (pair_search.order == Order::random) counters.random_draws += pair_list.count;
    return pair_list;
}

template <int d>
void Simulation<d>::sort_particles() {
    auto const before = particles.id;
    pair_search.sort_particles(particles, box, time);
    if (momentum_change.rows() != particles.size()) return;
    // impulses that wait for the kick move with their rows
    Field<d> by_id(particles.size(), d);
    for (Eigen::Index p = 0; p < before.size(); ++p) by_id.row(before[p]) = momentum_change.row(p);
    for (Eigen::Index p = 0; p < before.size(); ++p) momentum_change.row(p) = by_id.row(particles.id[p]);
}

template <int d>
void Simulation<d>::find_pairs_again(std::uint64_t of_step) {
    constexpr std::uint8_t stream_order = 253;
    pair_search.find(particles, box, time, {seed, of_step, stream_order}, pair_list);
    pairs_found(of_step);
}

template <int d>
void Simulation<d>::advance() {
    try {
        for (std::size_t s = 0; s < stages.size(); ++s)
            stages[s].act(*this, NoiseKey{seed, step, static_cast<std::uint8_t>(s)});
        check_divergence();
    } catch (Diverged const& divergence) {
        throw Diverged(fmt::format("diverged at step {} (time {:g}): {}; try a smaller time.step", step + 1,
                                   double(step + 1) * time_step, divergence.what()));
    }
    ++step;
    ++counters.steps;
}

template <int d>
void Simulation<d>::check_divergence() const {
    if (hottest <= 0.0) return;
    double const flow = particles.mass * power(box.image_speed(), 2);
    double const per_component = particles.mass / (d * double(particles.size()));
    // far below, Eigen's sum is enough, whose last digits follow the machine but which takes no time
    if (per_component * particles.velocity.square().sum() <= 0.5 * (hottest + flow)) return;
    double const kT = per_component * sum_of_squares(particles.velocity);
    if (!(kT <= hottest + flow))
        throw Diverged(fmt::format("kinetic temperature {:.3g} exceeds {:.3g}", kT, hottest + flow));
}

template <int d>
std::size_t Simulation<d>::bytes() const {
    std::size_t const state = static_cast<std::size_t>(particles.size()) *
                              (2 * d * sizeof(double) + (d + 1) * sizeof(std::uint32_t));
    return state + static_cast<std::size_t>(momentum_change.size() + force.size()) * sizeof(double) +
           pair_list.bytes() + pair_search.bytes();
}

template <int d>
double kinetic_temperature(Particles<d> const& particles, Box<d> const& box) {
    auto const n = double(particles.size());
    if (n < 2) return 0.0;
    if (particles.has_walls())  // momentum goes into the walls, so that all d N components are free
        return particles.mass * sum_of_squares(particles.velocity) / (d * double(particles.fluid));
    double sum = sum_of_squares(particles.velocity);
    if (box.sheared()) {
        auto const flow = box.shear_rate * (particles.position.col(1) - 0.5 * box.length[1]);
        sum = sum_of_squares(particles.velocity.col(0) - flow);
        for (int axis = 1; axis < d; ++axis) sum += sum_of_squares(particles.velocity.col(axis));
    }
    return particles.mass * sum / (d * (n - 1));
}

template <int d>
Vec<d> total_momentum(Particles<d> const& particles, Box<d> const& box) {
    Vec<d> momentum;
    for (int axis = 0; axis < d; ++axis) momentum[axis] = sum_of(particles.velocity.col(axis));
    if (box.sheared())
        momentum[0] -= box.shear_rate * sum_of(particles.position.col(1) - 0.5 * box.length[1]);
    return particles.mass * momentum;
}

namespace {

// Puts `count` particles from row `first` on a lattice that fills the layer from `bottom` to `top`. It has at
// least as many sites as there are particles; what is left over is spread evenly.
template <int d>
void put_on_lattice(Particles<d>& particles, Box<d> const& box, Eigen::Index first, Eigen::Index count,
                    double bottom, double top) {
    Vec<d> length = box.length;
    length[1] = top - bottom;
    double const spacing = nth_root(Box<d>{.length = length}.volume() / double(count), d);
    std::array<Eigen::Index, d> sides;
    Eigen::Index sites = 1;
    for (int axis = 0; axis < d; ++axis) {
        sides[std::size_t(axis)] = static_cast<Eigen::Index>(std::ceil(length[axis] / spacing - 1e-9));
        sites *= sides[std::size_t(axis)];
    }
    for (Eigen::Index p = 0; p < count; ++p) {
        Eigen::Index site = p * sites / count;
        for (int axis = 0; axis < d; ++axis) {
            auto const side = sides[std::size_t(axis)];
            particles.position(first + p, axis) =
                (axis == 1 ? bottom : 0.0) + length[axis] * (double(site % side) + 0.5) / double(side);
            site /= side;
        }
    }
}

// Takes off the mean velocity.
template <class Velocities>
void stop(Velocities&& velocity) {
    for (Eigen::Index axis = 0; axis < velocity.cols(); ++axis)
        velocity.col(axis) -= mean_of(velocity.col(axis));
}

}  // namespace

template <int d>
void randomize(Particles<d>& particles, Box<d> const& box, double kT, std::uint64_t seed, Start start) {
    double const filled = start == Start::dense ? 0.5 : 1.0;
    double const thermal_speed = std::sqrt(kT / particles.mass);
    for (Eigen::Index p = 0; p < particles.size(); ++p)
        for (int axis = 0; axis < d; ++axis) {
            auto const id = particles.id[p];
            auto const component = static_cast<std::uint32_t>(axis);
            particles.position(p, axis) =
                filled * box.length[axis] * uniform({seed, 0, stream_positions}, id, component);
            particles.velocity(p, axis) = thermal_speed * normal({seed, 0, stream_velocities}, id, component);
        }
    if (start == Start::lattice) put_on_lattice(particles, box, 0, particles.size(), 0.0, box.length[1]);
    if (particles.has_walls()) {
        auto const fluid = static_cast<Eigen::Index>(particles.fluid), walls = particles.size() - fluid;
        put_on_lattice(particles, box, fluid, walls, -box.wall, box.wall);
        double const height = box.length[1] - 2.0 * box.wall;
        if (start == Start::lattice)
            put_on_lattice(particles, box, 0, fluid, box.wall, box.length[1] - box.wall);
        else
            particles.position.col(1).head(fluid) =
                box.wall + height / box.length[1] * particles.position.col(1).head(fluid);
        particles.velocity.bottomRows(walls).setZero();
        stop(particles.velocity.topRows(fluid));
        box.wrap(particles, 0.0);
        particles.image.setZero();
        return;
    }
    stop(particles.velocity);
    if (box.sheared())
        particles.velocity.col(0) += box.shear_rate * (particles.position.col(1) - 0.5 * box.length[1]);
}

template struct Simulation<2>;
template struct Simulation<3>;
template double kinetic_temperature(Particles<2> const&, Box<2> const&);
template double kinetic_temperature(Particles<3> const&, Box<3> const&);
template Vec<2> total_momentum(Particles<2> const&, Box<2> const&);
template Vec<3> total_momentum(Particles<3> const&, Box<3> const&);
template void randomize(Particles<2>&, Box<2> const&, double, std::uint64_t, Start);
template void randomize(Particles<3>&, Box<3> const&, double, std::uint64_t, Start);

}  // namespace dpd
