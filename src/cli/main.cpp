// The command line; `dpdref --help` lists the subcommands. Exit codes: 0 done, 1 a verdict is "disagrees",
// 2 bad input, 3 the simulation diverged, 4 nothing was compared, 130 interrupted (run again to resume).

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <system_error>

#include "commands.hpp"
#include "errors.hpp"
#include "signals.hpp"
#include "version.hpp"

namespace dpd::cli {

namespace {

// An output that was closed would be the number of the next file that is opened.
void keep_standard_files() {
    for (int const number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(number, F_GETFD) < 0) static_cast<void>(::open("/dev/null", O_RDONLY));
}

// What was printed has arrived, or is an error.
void finish_output() {
    errno = 0;
    bool const failed = std::ferror(stdout) != 0;
    if (std::fflush(stdout) != 0 || failed)
        throw InputError(
            fmt::format("standard output: cannot be written: {}",
                        errno ? std::generic_category().message(errno) : "an earlier write failed"));
}

int dispatch(int argc, char** argv) {
    CLI::App app{"Reference implementation of dissipative particle dynamics at finite time step", "dpdref"};
    app.set_version_flag("--version",
                         fmt::format("dpdref {} (revision {}.{}: engine, measurement; {} {})", version,
                                     engine_revision, measurement_revision, compiler, build_flags));
    app.require_subcommand(1);
    std::vector<Command> commands;
    for (auto const add : {theory, tune, convert, run, export_scene, figure, stability, work_precision,
                           answers, answer, exact, compare, report})
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

// Ends the program with one line. HDF5 would otherwise, at the end, write once more what it could not write,
// and crash.
[[noreturn]] void give_up(std::string const& what, int code) {
    std::string const line = fmt::format("dpdref: {}\n", one_line(what));
    static_cast<void>(std::fwrite(line.data(), 1, line.size(), stderr));
    std::fflush(nullptr);
    std::_Exit(code);
}

}  // namespace
}  // namespace dpd::cli

int main(int argc, char** argv) {
    using namespace dpd::cli;
    keep_standard_files();
    dpd::catch_signals();
    try {
        int const code = dispatch(argc, argv);
        finish_output();
        return code;
    } catch (dpd::Diverged const& error) {
        give_up(error.what(), exit_diverged);
    } catch (dpd::Interrupted const& error) {
        give_up(error.what(), exit_interrupted);
    } catch (std::bad_alloc const&) {
        give_up("out of memory; try fewer particles, bins or lags", exit_bad_input);
    } catch (std::exception const& error) {
        // InputError; or the closed forms' invalid_argument and domain_error; or a full disk
        give_up(error.what(), exit_bad_input);
    }
}
