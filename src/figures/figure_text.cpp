#include "figure_text.hpp"

#include <fmt/format.h>

#include <sstream>

namespace dpd {

std::string part_name(std::string const& curve, Criterion const& criterion) {
    return fmt::format("{}:{}:{}", curve, criterion.quantity, criterion.theory);
}

std::string source_of(Figure const& figure) {
    bool const numbered =
        !figure.number.empty() && figure.number.front() >= '0' && figure.number.front() <= '9';
    return fmt::format("{}{} {}", figure.paper, numbered ? " Fig." : ",", figure.number);
}

std::string wrapped(std::string const& text) {
    constexpr std::size_t width = 105;
    std::istringstream words(text);
    std::string word, line, result;
    while (words >> word) {
        if (!line.empty() && line.size() + 1 + word.size() > width) {
            result += line + "\n";
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
    }
    return result + line;
}

}  // namespace dpd
