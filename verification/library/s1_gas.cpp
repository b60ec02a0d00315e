// An ideal gas with the S1 thermostat of NG2007: 100 steps of 0.1, and the temperature that it keeps at any
// step.
#include <cstdio>

#include "simulation.hpp"

int main() {
    dpd::Simulation<3> gas;
    gas.box.length = dpd::Vec<3>::Constant(10.0);
    gas.particles.resize(3000);
    gas.pair_search.cutoff = 1.0;
    gas.time_step = 0.1;
    gas.seed = 1;
    dpd::randomize(gas.particles, gas.box, 1.0, gas.seed);
    gas.stages = {dpd::Shardlow{.friction = 9.0}, dpd::Drift{}};
    double sum = 0.0;
    for (int step = 0; step < 100; ++step) {
        gas.advance();
        sum += dpd::kinetic_temperature(gas.particles, gas.box);
    }
    std::printf("kT = %.3f\n", sum / 100.0);
}
