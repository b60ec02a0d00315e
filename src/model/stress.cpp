#include "stress.hpp"

#include <algorithm>

#include "sums.hpp"

namespace dpd {

double sum_in_blocks(std::span<double const> values) {
    double sum = 0.0;
    for (std::size_t begin = 0; begin < values.size(); begin += block_size) {
        auto const size = std::min(block_size, values.size() - begin);
        sum += sum_of(Eigen::Map<Eigen::ArrayXd const>(values.data() + begin, Eigen::Index(size)));
    }
    return sum;
}

// [kinetic stress]
template <int d>
double kinetic_stress(Particles<d> const& particles, Box<d> const& box, double time_step) {
    auto const v_x = particles.velocity.col(0);
    auto const v_y = particles.velocity.col(1);
    if (!box.sheared()) return -particles.mass * sum_of(v_x * v_y) / box.volume();
    auto const flow_at_mid_drift =
        box.shear_rate * (particles.position.col(1) + 0.5 * time_step * v_y - 0.5 * box.length[1]);
    return -particles.mass * sum_of((v_x - flow_at_mid_drift) * v_y) / box.volume();
}
// [kinetic stress]

// [collision stress]
template <int d>
double collision_stress(PairList<d> const& pairs, double mass, Box<d> const& box, double time_step) {
    if (!pairs.updated) return 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < pairs.count; ++k)
        sum += pairs.impulse[k] * pairs.unit[0][k] * pairs.unit[1][k] * pairs.distance[k];
    return -mass * sum / (box.volume() * time_step);
}
// [collision stress]

template double kinetic_stress(Particles<2> const&, Box<2> const&, double);
template double kinetic_stress(Particles<3> const&, Box<3> const&, double);
template double collision_stress(PairList<2> const&, double, Box<2> const&, double);
template double collision_stress(PairList<3> const&, double, Box<3> const&, double);

}  // namespace dpd
