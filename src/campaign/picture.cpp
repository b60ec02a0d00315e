#include "picture.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "errors.hpp"
#include "files.hpp"

namespace dpd {

std::string quoted(std::string const& plain) {
    std::string q = "\"";
    for (char const c : plain)
        q += c == '"' || c == '\\' ? std::string{'\\', c} : c == '\n' ? "\\n" : std::string{c};
    return q + "\"";
}

void draw(std::filesystem::path const& stem, std::filesystem::path const& plot,
          std::string const& definitions, int width, int height) {
    auto const style = find_above(plot, "style.gp");
    if (!style) throw InputError(fmt::format("{}: there is no style.gp above it", plot.string()));
    auto const script = std::filesystem::path(stem).concat(".gp");
    auto const log = script.string() + ".log";
    std::string text = definitions;
    auto const add = [&](char const* ending, std::string const& terminal, int caption_size) {
        text += fmt::format(
            "reset\nload {}\ncaption_size = '{}'\nset terminal {}\nset output {}\nload {}\nset output\n",
            quoted(style->string()), caption_size, terminal, quoted(stem.string() + ending),
            quoted(plot.string()));
    };
    add(".svg", fmt::format("svg size {},{} font 'DejaVu Sans,14' background 'white'", width, height), 11);
    add(".png", fmt::format("pngcairo size {},{} font 'DejaVu Sans,20'", width * 7 / 5, height * 7 / 5), 15);
    write_file(script, text);
    // a curve that a budget leaves out has no data, of which gnuplot warns
    int const status = std::system(fmt::format("gnuplot '{}' 2> '{}'", script.string(), log).c_str());
    std::filesystem::remove(script);
    if (status != 0) throw InputError(fmt::format("{}: gnuplot failed, see {}", plot.string(), log));
    std::filesystem::remove(log);
}

}  // namespace dpd
