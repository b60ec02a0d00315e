// A scene natively, as the live pages run it: every bit of the final positions and velocities, as hexadecimal
// words, one a line.
#include <fmt/format.h>

#include <bit>
#include <exception>
#include <string>
#include <vector>

#include "files.hpp"
#include "live.hpp"

// bits SCENE.toml STEPS [OVERRIDE...]
int main(int count, char** arguments) {
    if (count < 3) return 2;
    try {
        auto const live = dpd::Live::begin(dpd::read_file(arguments[1]), {arguments + 3, arguments + count});
        live->advance(std::stoull(arguments[2]));
        for (auto const& values : {live->positions(), live->velocities()})
            for (double const value : values) fmt::print("{:016x}\n", std::bit_cast<std::uint64_t>(value));
        return 0;
    } catch (std::exception const& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 2;
    }
}
