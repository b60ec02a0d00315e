// The kinetic viscosity of that gas at finite time step, NG2007 eq. (8), by function and by name.
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "theory/closed_forms.hpp"
#include "theory/registry.hpp"

int main() {
    dpd::theory::Gas const gas{.n = 3.0};
    dpd::theory::Shardlow const thermostat{.gamma = 9.0};
    std::printf("viscosity = %.12g\n", dpd::theory::kinetic_viscosity(gas, thermostat, 0.1));
    std::vector<std::pair<std::string, std::string>> const given{{"n", "3"}, {"gamma", "9"}, {"dt", "0.1"}};
    std::printf("viscosity = %.12g\n", dpd::theory::evaluate("ng8", given));
}
