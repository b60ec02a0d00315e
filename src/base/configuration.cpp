#include "configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <optional>

#include "hdf5.hpp"
#include "number.hpp"

namespace dpd {
namespace {

// A file that is read, and what its numbers must be.
struct Source {
    std::string_view bytes;
    std::string const& name;
    std::size_t particles, dimension;

    [[noreturn]] void refuse(std::string const& problem) const {
        throw InputError(fmt::format("{}: {}", name, problem));
    }
    void check_count(double count) const {
        if (count != double(particles))
            refuse(fmt::format("has {} particles; allowed: those of the scene, {}", count, particles));
    }
};

// Particles in the order of their ids.
void sort_by_id(Configuration& state, std::vector<double> const& ids, Source const& source) {
    std::vector<std::size_t> order(ids.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t row) { return ids[row]; });
    for (std::size_t k = 1; k < order.size(); ++k)
        if (!(ids[order[k - 1]] < ids[order[k]]))
            source.refuse(fmt::format("has id {} twice; allowed: each once", ids[order[k]]));
    auto const sorted = [&](std::vector<double> const& rows) {
        std::vector<double> result;
        for (std::size_t const row : order)
            for (std::size_t axis = 0; axis < source.dimension; ++axis)
                result.push_back(rows[source.dimension * row + axis]);
        return result;
    };
    state.position = sorted(state.position);
    if (!state.velocity.empty()) state.velocity = sorted(state.velocity);
}

// --- H5MD

using Shape = std::vector<hsize_t>;

// An element of H5MD at its last time, or one that has no times. It must have that shape.
std::vector<double> last_of(H5::H5File const& h5, std::string name, Shape const& shape,
                            Source const& source) {
    bool const timed = h5.childObjType(name) == H5O_TYPE_GROUP;
    if (timed) name += "/value";
    H5::DataSet const set = h5.openDataSet(name);
    H5::DataSpace const space = set.getSpace();
    Shape size(static_cast<std::size_t>(std::max(0, space.getSimpleExtentNdims())));
    if (!size.empty()) space.getSimpleExtentDims(size.data());
    bool const fits = timed ? size.size() == shape.size() + 1 && size[0] > 0 &&
                                  std::equal(shape.begin(), shape.end(), size.begin() + 1)
                            : size == shape;
    if (!fits)
        source.refuse(fmt::format("{} is {}; allowed: {}{}", name, fmt::join(size, " x "),
                                  timed ? "at least one frame of " : "", fmt::join(shape, " x ")));
    hdf5::check_is_there(set);
    if (timed) {
        Shape start(size.size(), 0), count = size;
        start[0] = size[0] - 1;
        count[0] = 1;
        space.selectHyperslab(H5S_SELECT_SET, count.data(), start.data());
    }
    hsize_t const numbers = std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>{});
    std::vector<double> values(numbers);
    set.read(values.data(), H5::PredType::NATIVE_DOUBLE, H5::DataSpace(1, &numbers), space);
    return values;
}

// The sides of a box; those of a sheared one lean, which its time zero does not.
std::vector<double> sides_of(H5::H5File const& h5, std::string const& edges, Source const& source) {
    hsize_t const d = source.dimension;
    std::string const values = h5.childObjType(edges) == H5O_TYPE_GROUP ? edges + "/value" : edges;
    int const rank = h5.openDataSet(values).getSpace().getSimpleExtentNdims();
    if (rank == (values == edges ? 1 : 2)) return last_of(h5, edges, {d}, source);
    auto const matrix = last_of(h5, edges, {d, d}, source);
    std::vector<double> length;
    for (std::size_t axis = 0; axis < d; ++axis) length.push_back(matrix[axis * (d + 1)]);
    return length;
}

Configuration from_h5md(Source const& source) {
    return hdf5::guarded(source.name, "read", [&] {
        H5::H5File const h5 = hdf5::open_bytes(std::string(source.bytes));
        if (!h5.nameExists("particles") || h5.openGroup("particles").getNumObjs() == 0)
            source.refuse("has no particles; allowed: H5MD");
        H5::Group const groups = h5.openGroup("particles");
        std::string const all =
            "particles/" + (groups.nameExists("all") ? "all" : groups.getObjnameByIdx(0)) + "/";
        for (char const* const needed : {"position", "box", "box/edges"})
            if (!h5.nameExists(all + needed)) source.refuse(fmt::format("has no {}{}", all, needed));
        Shape const rows{source.particles, source.dimension};
        Configuration state{.length = sides_of(h5, all + "box/edges", source),
                            .position = last_of(h5, all + "position", rows, source),
                            .velocity = {}};
        if (h5.nameExists(all + "velocity")) state.velocity = last_of(h5, all + "velocity", rows, source);
        if (h5.nameExists(all + "id")) sort_by_id(state, last_of(h5, all + "id", {rows[0]}, source), source);
        return state;
    });
}

// --- text

std::vector<std::string_view> words_of(std::string_view line) {
    constexpr std::string_view blanks = " \t\r";
    std::vector<std::string_view> words;
    for (std::size_t begin = line.find_first_not_of(blanks); begin != line.npos;
         begin = line.find_first_not_of(blanks, begin)) {
        std::size_t const end = std::min(line.find_first_of(blanks, begin), line.size());
        words.push_back(line.substr(begin, end - begin));
        begin = end;
    }
    return words;
}

// The lines of a text, one after the other.
class Lines {
public:
    explicit Lines(Source const& source) : source_(source) {}
    bool end() const { return at_ >= source_.bytes.size(); }
    std::string_view next() {
        if (end()) source_.refuse(fmt::format("ends in line {}; allowed: a whole frame", number_));
        std::size_t const stop = std::min(source_.bytes.find('\n', at_), source_.bytes.size());
        std::string_view const line = source_.bytes.substr(at_, stop - at_);
        at_ = stop + 1;
        ++number_;
        return line;
    }
    [[noreturn]] void refuse(std::string const& problem) const {
        throw InputError(fmt::format("{}:{}: {}", source_.name, number_, problem));
    }
    double number(std::string_view word) const {
        auto const value = number_in(word);
        if (!value || !std::isfinite(*value))
            refuse(fmt::format("'{}' is no finite number", word.substr(0, 40)));
        return *value;
    }
    // So many numbers from `first` on are added to `values`.
    void add(std::vector<std::string_view> const& words, std::size_t first, std::size_t count,
             std::vector<double>& values) const {
        if (words.size() < first + count)
            refuse(fmt::format("has {} columns; allowed: at least {}", words.size(), first + count));
        for (std::size_t k = first; k < first + count; ++k) values.push_back(number(words[k]));
    }

private:
    Source const& source_;
    std::size_t at_ = 0, number_ = 0;
};

// What stands behind `key=` in the comment line of an extended XYZ file, in quotes or without.
std::optional<std::string_view> value_of_key(std::string_view comment, std::string_view key) {
    for (std::size_t at = comment.find(key); at != comment.npos; at = comment.find(key, at + 1)) {
        std::size_t const behind = at + key.size();
        if ((at > 0 && comment[at - 1] != ' ') || behind >= comment.size() || comment[behind] != '=')
            continue;
        bool const quoted = behind + 1 < comment.size() && comment[behind + 1] == '"';
        std::size_t const begin = behind + (quoted ? 2 : 1);
        return comment.substr(
            begin, std::min(comment.find_first_of(quoted ? "\"" : " \t\r", begin), comment.size()) - begin);
    }
    return std::nullopt;
}

// Columns of an extended XYZ file, from 0.
struct Columns {
    std::size_t position = 1;
    std::optional<std::size_t> velocity = {}, id = {};
};

Columns columns_of(std::string_view properties, Lines const& lines) {
    std::string fields(properties);
    std::ranges::replace(fields, ':', ' ');
    auto const words = words_of(fields);
    std::optional<std::size_t> position;
    Columns columns;
    std::size_t at = 0;
    for (std::size_t k = 0; k + 2 < words.size(); k += 3) {
        auto const name = words[k];
        if (name == "pos") position = at;
        if (name == "id") columns.id = at;
        if (name == "vel" || name == "velo" || name == "velocity" || name == "velocities")
            columns.velocity = at;
        double const width = lines.number(words[k + 2]);
        if (!(width >= 1.0 && width <= 1e3))
            lines.refuse(fmt::format("'{}' columns of {}", words[k + 2], name));
        at += static_cast<std::size_t>(width);
    }
    if (!position) lines.refuse("has no pos in Properties");
    columns.position = *position;
    return columns;
}

Configuration from_xyz(Source const& source) {
    Lines lines(source);
    std::optional<Configuration> last;
    while (!lines.end()) {
        auto const first = words_of(lines.next());
        if (first.empty() && last) continue;  // at the end
        if (first.size() != 1) lines.refuse("is not the number of particles alone; allowed: extended XYZ");
        source.check_count(lines.number(first[0]));
        std::string_view const comment = lines.next();
        auto const lattice = value_of_key(comment, "Lattice");
        if (!lattice) lines.refuse("has no box; allowed: Lattice=\"...\" of extended XYZ");
        std::vector<double> cell, origin(3, 0.0);
        lines.add(words_of(*lattice), 0, 9, cell);
        for (std::size_t k : {1u, 2u, 3u, 5u, 6u, 7u})
            if (cell[k] != 0.0) lines.refuse("has a box that leans; allowed: right angles");
        if (auto const corner = value_of_key(comment, "Origin")) {
            origin.clear();
            lines.add(words_of(*corner), 0, 3, origin);
        }
        auto const properties = value_of_key(comment, "Properties");
        Columns const columns = properties ? columns_of(*properties, lines) : Columns{};
        Configuration state;
        std::vector<double> ids;
        for (std::size_t axis = 0; axis < source.dimension; ++axis) state.length.push_back(cell[4 * axis]);
        for (std::size_t k = 0; k < source.particles; ++k) {
            auto const words = words_of(lines.next());
            lines.add(words, columns.position, source.dimension, state.position);
            for (std::size_t axis = 0; axis < source.dimension; ++axis)
                state.position[source.dimension * k + axis] -= origin[axis];
            if (columns.velocity) lines.add(words, *columns.velocity, source.dimension, state.velocity);
            if (columns.id) lines.add(words, *columns.id, 1, ids);
        }
        if (columns.id) sort_by_id(state, ids, source);
        last = state;
    }
    if (!last) source.refuse("has no frame; allowed: extended XYZ");
    return *last;
}

// The column of x in the section Atoms, by the style that its comment names.
std::size_t column_of_x(std::string_view style, Lines const& lines) {
    static constexpr std::array<std::pair<std::string_view, std::size_t>, 7> known{
        {{"atomic", 2}, {"angle", 3}, {"bond", 3}, {"molecular", 3}, {"charge", 3}, {"dpd", 3}, {"full", 4}}};
    auto const found = std::ranges::find(known, style, &std::pair<std::string_view, std::size_t>::first);
    if (found == known.end())
        lines.refuse(fmt::format(
            "Atoms of style '{}'; allowed: atomic, angle, bond, molecular, charge, dpd, full", style));
    return found->second;
}

Configuration from_lammps_data(Source const& source) {
    Lines lines(source);
    lines.next();  // a comment
    std::array<double, 3> low{};
    std::array<std::optional<double>, 3> side;
    std::vector<double> ids, moving_ids;
    Configuration state;
    bool counted = false;
    auto const rows = [&](auto const& row) {
        for (std::size_t k = 0; k < source.particles;) {
            std::string_view const line = lines.next();
            auto const words = words_of(line.substr(0, line.find('#')));
            if (words.empty()) {
                if (k > 0)
                    lines.refuse(fmt::format("is empty after {} of {} particles", k, source.particles));
                continue;
            }
            row(words);
            ++k;
        }
    };
    while (!lines.end()) {
        std::string_view const line = lines.next();
        std::size_t const hash = std::min(line.find('#'), line.size());
        auto const words = words_of(line.substr(0, hash)),
                   comment = words_of(line.substr(std::min(hash + 1, line.size())));
        if (words.empty()) continue;
        if (words.size() == 2 && words[1] == "atoms") {
            source.check_count(lines.number(words[0]));
            counted = true;
        }
        if (words.size() == 4 && words[3].ends_with("hi"))
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (words[3][0] == "xyz"[axis]) {
                    low[axis] = lines.number(words[0]);
                    side[axis] = lines.number(words[1]) - low[axis];
                }
        if (words.size() == 6 && words[3] == "xy")
            for (std::size_t k = 0; k < 3; ++k)
                if (lines.number(words[k]) != 0.0)
                    lines.refuse("has a box that leans; allowed: right angles");
        if (words.size() != 1 || (words[0] != "Atoms" && words[0] != "Velocities")) continue;
        if (!counted) lines.refuse("stands before the number of atoms");
        if (words[0] == "Velocities") {
            rows([&](auto const& row) {
                lines.add(row, 0, 1, moving_ids);
                lines.add(row, 1, source.dimension, state.velocity);
            });
        } else {
            std::size_t const x = column_of_x(comment.empty() ? "atomic" : comment[0], lines);
            rows([&](auto const& row) {
                lines.add(row, 0, 1, ids);
                lines.add(row, x, source.dimension, state.position);
            });
        }
    }
    if (state.position.empty()) source.refuse("has no section Atoms");
    for (std::size_t axis = 0; axis < source.dimension; ++axis) {
        if (!side[axis]) source.refuse(fmt::format("has no {0}lo {0}hi", "xyz"[axis]));
        state.length.push_back(*side[axis]);
        for (std::size_t k = axis; k < state.position.size(); k += source.dimension)
            state.position[k] -= low[axis];
    }
    Configuration moving{.length = {}, .position = state.velocity, .velocity = {}};
    if (!state.velocity.empty()) sort_by_id(moving, moving_ids, source);
    state.velocity.clear();
    sort_by_id(state, ids, source);
    if (!moving_ids.empty()) {
        std::ranges::sort(ids);
        std::ranges::sort(moving_ids);
        if (ids != moving_ids) source.refuse("has other ids in Velocities than in Atoms");
        state.velocity = moving.position;
    }
    return state;
}

}  // namespace

Configuration read_configuration(std::string_view bytes, std::string const& name, std::size_t particles,
                                 std::size_t dimension) {
    Source const source{bytes, name, particles, dimension};
    auto const is = [end = std::filesystem::path(name).extension().string()](auto... ends) {
        return ((end == ends) || ...);
    };
    Configuration const state = is(".h5", ".h5md", ".hdf5") ? from_h5md(source)
                                : is(".xyz", ".extxyz")     ? from_xyz(source)
                                : is(".data", ".lmp")       ? from_lammps_data(source)
                                                            : Configuration{};
    if (state.position.empty())
        source.refuse("is of no kind that is read; allowed: .h5, .h5md, .hdf5, .xyz, .extxyz, .data, .lmp");
    for (auto const* const values : {&state.length, &state.position, &state.velocity})
        if (!std::ranges::all_of(*values, [](double x) { return std::isfinite(x); }))
            source.refuse("has a number that is not finite");
    return state;
}

}  // namespace dpd
