#include "files.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "errors.hpp"

namespace dpd {

std::string read_file(std::filesystem::path const& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream content;
    bool const readable = !std::filesystem::is_directory(file) && stream;
    bool const empty = readable && stream.peek() == std::ifstream::traits_type::eof();
    if (!readable || (!empty && !(content << stream.rdbuf())))
        throw InputError(fmt::format("{}: cannot be read", file.string()));
    return content.str();
}

void write_file(std::filesystem::path const& path, std::string const& content) {
    auto temporary = path;
    temporary += ".part";
    {
        std::ofstream stream(temporary, std::ios::binary);
        stream << content;
        stream.flush();
        if (!stream) throw InputError(fmt::format("{}: cannot be written", path.string()));
    }
    std::filesystem::rename(temporary, path);
}

std::optional<std::filesystem::path> find_above(std::filesystem::path const& path, std::string const& name) {
    auto directory = std::filesystem::absolute(path).lexically_normal();
    do {
        directory = directory.parent_path();
        if (std::filesystem::exists(directory / name)) return directory / name;
    } while (directory != directory.parent_path());
    return {};
}

}  // namespace dpd
