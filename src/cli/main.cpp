// The command line; `dpdref --help` lists the subcommands. Exit codes: 0 done, 1 a verdict is "disagrees",
// 2 bad input, 3 the simulation diverged, 130 interrupted (run again to resume).

#include <fmt/format.h>

#include <csignal>

#include "commands.hpp"
#include "errors.hpp"
#include "run.hpp"
#include "version.hpp"

namespace dpd::cli {

std::atomic<bool> stop_requested = false;

namespace {

extern "C" void request_stop(int) { stop_requested = true; }

int dispatch(int argc, char** argv) {
    CLI::App app{"Reference implementation of dissipative particle dynamics at finite time step", "dpdref"};
    app.set_version_flag("--version", fmt::format("dpdref {} (engine revision {}; {} {})", version,
                                                  engine_revision, compiler, build_flags));
    app.require_subcommand(1);
    std::vector<Command> commands;
    for (auto const add : {theory, convert, run, export_scene, figure, stability, work_precision, answers,
                           answer, exact, compare, report})
        commands.push_back(add(app));
    try {
        app.parse(argc, argv);
    } catch (CLI::ParseError const& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        throw InputError(fmt::format("{} (see dpdref --help)", error.what()));
    }
    for (auto const& command : commands)
        if (command.subcommand->parsed()) return command.act();
    return exit_done;
}

int complain(char const* what, int code) {
    fmt::print(stderr, "dpdref: {}\n", what);
    return code;
}

}  // namespace
}  // namespace dpd::cli

int main(int argc, char** argv) {
    using namespace dpd::cli;
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    try {
        return dispatch(argc, argv);
    } catch (dpd::Diverged const& error) {
        return complain(error.what(), exit_diverged);
    } catch (dpd::Interrupted const& error) {
        return complain(error.what(), exit_interrupted);
    } catch (std::exception const& error) {
        // InputError; or the closed forms' invalid_argument and domain_error; or a full disk
        return complain(error.what(), exit_bad_input);
    }
}
