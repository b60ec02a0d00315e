#include "picture.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "errors.hpp"
#include "files.hpp"

namespace dpd {
namespace {

// Runs gnuplot on a script, its messages into `log`, without a shell between; returns its exit code, or -1 if
// it was killed. InputError if there is none.
int run_gnuplot(std::filesystem::path const& script, std::filesystem::path const& log) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0666);
    std::string name = "gnuplot", argument = script.string();
    std::array<char*, 3> arguments{name.data(), argument.data(), nullptr};
    pid_t child = 0;
    int const error = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0)
        throw InputError(
            fmt::format("gnuplot: cannot be started: {}", std::generic_category().message(error)));
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

std::string quoted(std::string const& plain) {
    constexpr std::string_view harmless = " .,:;-_+/()";
    std::string q = "\"";
    for (char const c : plain) {
        auto const code = static_cast<unsigned char>(c);
        if (code >= 0x80 || std::isalnum(code) || harmless.find(c) != std::string_view::npos)
            q += c;
        else
            q += fmt::format("\\0{:03o}", code);  // gnuplot takes four digits where the first is 0
    }
    return q + "\"";
}

std::string quoted_path(std::filesystem::path const& path) {
    return quoted(std::filesystem::absolute(path).string());
}

void draw(std::filesystem::path const& stem, std::filesystem::path const& plot,
          std::string const& definitions, int width, int height) {
    auto const style = find_above(plot, "style.gp");
    if (!style) throw InputError(fmt::format("{}: there is no style.gp above it", plot.string()));
    auto const script = std::filesystem::path(stem).concat(".gp"),
               log = std::filesystem::path(stem).concat(".gp.log");
    struct Picture {
        char const* kind;
        std::string_view end;  // of the file, if it is whole: gnuplot does not say that a disk was full
        int caption_size;
        std::string terminal;
    };
    std::array<Picture, 2> const pictures{
        {{"svg", "</svg>\n\n", 11,
          fmt::format("svg size {},{} font 'DejaVu Sans,14' background 'white'", width, height)},
         {"png", "IEND\xae\x42\x60\x82", 15,
          fmt::format("pngcairo size {},{} font 'DejaVu Sans,20'", width * 7 / 5, height * 7 / 5)}}};
    auto const file = [&](Picture const& picture) {
        return std::filesystem::path(stem).concat(fmt::format(".{}", picture.kind));
    };
    auto const part = [&](Picture const& picture) { return file(picture).concat(".part"); };
    std::string text = definitions;
    for (auto const& picture : pictures)
        text += fmt::format(
            "reset\nload {}\ncaption_size = '{}'\nset terminal {}\nset output {}\nload {}\nset output\n",
            quoted_path(*style), picture.caption_size, picture.terminal, quoted_path(part(picture)),
            quoted_path(plot));
    write_file(script, text);
    // a curve that a budget leaves out has no data, of which gnuplot warns
    bool good = run_gnuplot(script, log) == 0;
    std::filesystem::remove(script);
    for (auto const& picture : pictures)
        good =
            good && std::filesystem::exists(part(picture)) && read_file(part(picture)).ends_with(picture.end);
    for (auto const& picture : pictures)
        if (good)
            put_in_place(part(picture), file(picture));
        else
            std::filesystem::remove(part(picture));
    if (!good) throw InputError(fmt::format("{}: gnuplot failed, see {}", plot.string(), log.string()));
    std::filesystem::remove(log);
}

}  // namespace dpd
