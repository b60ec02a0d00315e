// A scene by the plain engine with the mistakes of mistakes.toml in it, of which DPDREF_MISTAKE names one:
// its quantities, one a line: name, value, standard error, blocks.
#include <fmt/format.h>

#include <exception>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "files.hpp"
#include "run.hpp"

// mistaken SCENE.toml [OVERRIDE...]
int main(int count, char** arguments) {
    if (count < 2) return 2;
    try {
        dpd::Scene scene =
            dpd::parse_scene(dpd::read_file(arguments[1]), arguments[1], {arguments + 2, arguments + count});
        scene.use(dpd::Engine::plain);
        for (auto const& quantity : dpd::analyze(scene, {dpd::run(scene).record}))
            fmt::print("{} {} {} {}\n", quantity.name, quantity.estimate.value, quantity.estimate.error,
                       quantity.estimate.blocks);
        return 0;
    } catch (dpd::Diverged const& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 3;
    } catch (std::exception const& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 2;
    }
}
