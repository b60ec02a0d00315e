#include "pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace dpd {

template <int d>
void PairList<d>::grow_to(std::size_t size) {
    if (size <= i.size()) return;
    std::size_t const capacity = std::max(size, i.size() + i.size() / 2);
    i.resize(capacity);
    j.resize(capacity);
    for (auto& component : unit) component.resize(capacity);
    distance.resize(capacity);
    impulse.resize(capacity);
}

template <int d>
std::size_t PairList<d>::bytes() const {
    return i.size() * (2 * sizeof(std::uint32_t) + (d + 2) * sizeof(double));
}

template <int d>
void PairSearch<d>::check(Box<d> const& box) const {
    for (int axis = 0; axis < d; ++axis)
        if (!(box.length[axis] >= 2.0 * cutoff))
            throw InputError(
                fmt::format("box.length[{}] = {} is too small: at least two cutoffs ({}) are needed", axis,
                            box.length[axis], 2.0 * cutoff));
}

template <int d>
void PairSearch<d>::find(Particles<d> const& particles, Box<d> const& box, double time, NoiseKey key,
                         PairList<d>& pairs) {
    pairs.clear();
    // In a side of just two cutoffs rounding could let a pair meet twice; there the definition itself
    // searches.
    bool const tight = box.length.minCoeff() < 2.0 * cutoff * (1.0 + 1e-9);
    if (search == Search::brute || tight)
        find_by_brute_force(particles, box, time, pairs);
    else
        find_by_cells(particles, box, time, pairs);
    if (order != Order::cell) reorder(particles, key, pairs);
}

namespace {

// Both searches find the pairs across the sheared boundary last.
template <int d>
void mark_crossing(PairList<d>& pairs, std::size_t begin) {
    pairs.crossing.resize(pairs.count - begin);
    std::iota(pairs.crossing.begin(), pairs.crossing.end(), static_cast<std::uint32_t>(begin));
}

// To the nearest image in a period.
inline double nearest(double separation, double period) {
    if (std::abs(separation) <= 0.5 * period) return separation;
    return separation - std::copysign(period, separation);
}

}  // namespace

// The definition: minimum image of every pair, with the image across a sheared boundary displaced.
template <int d>
void PairSearch<d>::find_by_brute_force(Particles<d> const& particles, Box<d> const& box, double time,
                                        PairList<d>& pairs) {
    auto const rows = static_cast<std::uint32_t>(particles.size());
    auto const pass = [&](bool across) {
        auto const shift = geometry(box, time, across).shift;
        for (std::uint32_t a = 0; a < rows; ++a)
            for (std::uint32_t b = a + 1; b < rows; ++b) {
                std::uint32_t i = a, j = b;
                if (box.sheared()) {
                    double const gap = particles.position(a, 1) - particles.position(b, 1);
                    if (across != (std::abs(gap) > 0.5 * box.length[1])) continue;
                    // j must be the one whose image lies above the upper boundary
                    if (across && gap < 0.0) std::swap(i, j);
                }
                Vec<d> separation = particles.position.row(i) - particles.position.row(j);
                double squared = 0.0;
                for (int axis = 0; axis < d; ++axis) {
                    separation[axis] = nearest(separation[axis] - shift[std::size_t(axis)], box.length[axis]);
                    squared += separation[axis] * separation[axis];
                }
                if (squared >= cutoff * cutoff) continue;
                if (squared == 0.0) {
                    ++pairs.coincident;
                    continue;
                }
                pairs.grow_to(pairs.count + 1);
                pairs.i[pairs.count] = i;
                pairs.j[pairs.count] = j;
                double const r = std::sqrt(squared), inverse = 1.0 / r;
                for (int axis = 0; axis < d; ++axis)
                    pairs.unit[std::size_t(axis)][pairs.count] = separation[axis] * inverse;
                pairs.distance[pairs.count++] = r;
            }
    };
    pass(false);
    std::size_t const within = pairs.count;
    if (box.sheared()) pass(true);
    mark_crossing(pairs, within);
}

template <int d>
int PairSearch<d>::row_begin(int y, int x) const {
    return (d == 3 ? y * (cells_[0] + 2) + x + 1 : y) * (cells_[contiguous] + 2 * reach);
}

template <int d>
void PairSearch<d>::add_images(Box<d> const& box, double time) {
    auto const copy = [&](Entry image, int axis, int direction) {
        image.position[axis] += direction * box.length[axis];
        image.cell[axis] += direction * cells_[axis];
        entries_.push_back(image);
    };
    std::size_t const own = entries_.size();
    double const offset = box.offset(time);
    for (std::size_t e = 0; e < own; ++e) {
        if (entries_[e].cell[1] != 0) continue;
        copy(entries_[e], 1, +1);
        if (!box.sheared()) continue;
        Entry& image = entries_.back();
        double& x = image.position[0];
        x += offset;
        x -= box.length[0] * std::floor(x / box.length[0]);
        image.cell[0] = std::min(static_cast<int>(x * cells_[0] / box.length[0]), cells_[0] - 1);
    }
    for (int axis = 0; axis < d; axis += 2) {
        int const layers = axis == contiguous ? reach : 1;
        std::size_t const sources = entries_.size();
        for (std::size_t e = 0; e < sources; ++e) {
            if (entries_[e].cell[axis] < layers) copy(entries_[e], axis, +1);
            if (entries_[e].cell[axis] >= cells_[axis] - layers) copy(entries_[e], axis, -1);
        }
    }
}

template <int d>
void PairSearch<d>::sort_into_cells(Particles<d> const& particles, Box<d> const& box, double time) {
    // Cells of a cutoff, or wider in a dilute system: about one particle each is enough.
    double const spacing = std::pow(box.volume() / std::max<double>(1.0, double(particles.size())), 1.0 / d);
    double const width = std::max(cutoff, spacing);
    for (int axis = 0; axis < d; ++axis)
        cells_[axis] = static_cast<int>(box.length[axis] / std::min(width, box.length[axis] / 2.0) *
                                        (axis == contiguous ? reach : 1));
    entries_.resize(static_cast<std::size_t>(particles.size()));
    for (Eigen::Index p = 0; p < particles.size(); ++p) {
        Entry& entry = entries_[static_cast<std::size_t>(p)];
        entry.row = static_cast<std::uint32_t>(p);
        for (int axis = 0; axis < d; ++axis) {
            entry.position[axis] = particles.position(p, axis);
            entry.cell[axis] = std::min(
                static_cast<int>(entry.position[axis] * cells_[axis] / box.length[axis]), cells_[axis] - 1);
        }
    }
    add_images(box, time);

    cell_begin_.assign(static_cast<std::size_t>(row_begin(cells_[1] + 1, -1)) + 2, 0);
    for (auto const& entry : entries_) ++cell_begin_[static_cast<std::size_t>(cell_of(entry)) + 2];
    std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());
    owner_.resize(entries_.size() + simd::widest);
    for (auto& component : sorted_) component.resize(entries_.size() + simd::widest);
    for (auto const& entry : entries_) {
        // the begin of the next cell serves as this cell's cursor and ends up where it belongs
        auto const slot =
            static_cast<std::size_t>(cell_begin_[static_cast<std::size_t>(cell_of(entry)) + 1]++);
        for (int axis = 0; axis < d; ++axis) sorted_[axis][slot] = entry.position[axis];
        owner_[slot] = entry.row;
    }
}

// All pairs whose first member lies in layer y: with partners in the rest of its own layer, and with those
// of the layer above. Half of the neighbourhood, so that each pair is met once.
template <int d>
void PairSearch<d>::search_layer(int y, bool within, bool above, PairList<d>& pairs) {
    int const* const cell_begin = cell_begin_.data();
    auto const entries = [&](int first_cell, int last_cell) {
        return simd::Range{static_cast<std::size_t>(cell_begin[first_cell]),
                           static_cast<std::size_t>(cell_begin[last_cell + 1])};
    };
    simd::Sorted<d> sorted;
    for (std::size_t axis = 0; axis < d; ++axis) sorted[axis] = sorted_[axis].data();
    // the separation itself decides later; the images' rounded positions must not lose a pair
    double const generous = cutoff * cutoff * (1.0 + 1e-12);

    for (int x = 0; x < (d == 3 ? cells_[0] : 1); ++x) {
        std::array<int, 4> rows{};  // first cells of the neighbouring rows
        std::size_t row_count = 0;
        if (within && d == 3) rows[row_count++] = row_begin(y, x + 1);
        if (above && d == 3) rows[row_count++] = row_begin(y + 1, x - 1);
        if (above) rows[row_count++] = row_begin(y + 1, x);
        if (above && d == 3) rows[row_count++] = row_begin(y + 1, x + 1);
        for (int c = reach; c < reach + cells_[contiguous]; ++c) {
            int const cell = row_begin(y, x) + c;
            simd::Range const home = entries(cell, cell);
            if (home.begin == home.end) continue;
            std::array<simd::Range, 5> ranges;
            ranges[0] = {home.begin, within ? entries(cell, cell + reach).end : home.begin};
            std::size_t candidates = ranges[0].end - ranges[0].begin;
            for (std::size_t r = 0; r < row_count; ++r) {
                ranges[r + 1] = entries(rows[r] + c - reach, rows[r] + c + reach);
                candidates += ranges[r + 1].end - ranges[r + 1].begin;
            }
            pairs.grow_to(pairs.count + (home.end - home.begin) * candidates + simd::widest);
            pairs.count += simd::find_near(sorted, {home, {ranges.data(), row_count + 1}, generous},
                                           pairs.i.data() + pairs.count, pairs.j.data() + pairs.count);
        }
    }
}

// The shift of an image and the periods by which a separation is the nearest: in shear, y is no period, and
// pairs `across` the upper boundary have j above it.
template <int d>
simd::Geometry<d> PairSearch<d>::geometry(Box<d> const& box, double time, bool across) const {
    simd::Geometry<d> geometry{};
    for (int axis = 0; axis < d; ++axis) geometry.period[std::size_t(axis)] = box.length[axis];
    geometry.cutoff_squared = cutoff * cutoff;
    if (box.sheared()) geometry.period[1] = std::numeric_limits<double>::infinity();
    if (across) {
        geometry.shift[0] = std::remainder(box.offset(time), box.length[0]);
        geometry.shift[1] = box.length[1];
    }
    return geometry;
}

// From entries to pairs, from `begin` on: rows, unit vectors and distances. What is no pair after all is left
// out, and so are pairs at r = 0, so that every listed pair has a direction.
template <int d>
void PairSearch<d>::separate(Particles<d> const& particles, simd::Geometry<d> const& geometry,
                             std::size_t begin, PairList<d>& pairs) const {
    simd::PairColumns<d> columns{pairs.count - begin, {}, pairs.distance.data() + begin};
    std::array<double const*, d> position;
    for (std::size_t axis = 0; axis < d; ++axis) {
        columns.unit[axis] = pairs.unit[axis].data() + begin;
        position[axis] = particles.position.col(static_cast<Eigen::Index>(axis)).data();
    }
    std::uint32_t* const rows_i = pairs.i.data() + begin;
    std::uint32_t* const rows_j = pairs.j.data() + begin;
    for (std::size_t k = 0; k < columns.count; ++k) {
        std::uint32_t const i = owner_[rows_i[k]], j = owner_[rows_j[k]];
        rows_i[k] = i;
        rows_j[k] = j;
        for (std::size_t axis = 0; axis < d; ++axis)
            columns.unit[axis][k] = position[axis][i] - position[axis][j];
    }
    if (simd::normalize(geometry, columns) == 0) [[likely]]
        return;
    std::size_t const end = std::exchange(pairs.count, begin);
    for (std::size_t k = begin; k < end; ++k) {
        double const r = pairs.distance[k];
        pairs.coincident += r == 0.0;
        if (r == 0.0 || std::isinf(r)) continue;
        std::size_t const to = pairs.count++;
        pairs.i[to] = pairs.i[k];
        pairs.j[to] = pairs.j[k];
        for (auto& component : pairs.unit) component[to] = component[k];
        pairs.distance[to] = r;
    }
}

template <int d>
void PairSearch<d>::find_by_cells(Particles<d> const& particles, Box<d> const& box, double time,
                                  PairList<d>& pairs) {
    sort_into_cells(particles, box, time);
    int const top = cells_[1] - 1;
    auto const add_layer = [&](int y, bool within, bool above, bool across) {
        std::size_t const begin = pairs.count;
        search_layer(y, within, above, pairs);
        separate(particles, geometry(box, time, across), begin, pairs);
    };
    for (int y = 0; y < top; ++y) add_layer(y, true, true, false);
    add_layer(top, true, !box.sheared(), false);
    std::size_t const within = pairs.count;
    if (box.sheared()) add_layer(top, false, true, true);
    mark_crossing(pairs, within);
}

// Finds each pair its place: place_[k] for the k-th one found.
template <int d>
void PairSearch<d>::sort_places(Particles<d> const& particles, NoiseKey key, PairList<d> const& pairs) {
    if (order == Order::id) {
        auto const ids = [&](std::size_t k) {
            std::uint32_t const a = particles.id[pairs.i[k]], b = particles.id[pairs.j[k]];
            return std::pair{std::min(a, b), std::max(a, b)};
        };
        std::vector<std::uint32_t> sorted(pairs.count);
        std::iota(sorted.begin(), sorted.end(), 0u);
        std::sort(sorted.begin(), sorted.end(),
                  [&](std::size_t a, std::size_t b) { return ids(a) < ids(b); });
        for (std::size_t k = 0; k < pairs.count; ++k) place_[sorted[k]] = static_cast<std::uint32_t>(k);
        return;
    }
    // A counting sort by random buckets; the few pairs that share one stay in the order in which they were
    // found. The low bits of a normal variate are uniform.
    constexpr std::uint32_t buckets = 1u << 16;
    pair_normals(key, {pairs.i.data(), pairs.count}, {pairs.j.data(), pairs.count}, particles.id.data(),
                 {scratch_.data(), pairs.count});
    auto const bucket = [&](std::size_t k) {
        return static_cast<std::uint32_t>(static_cast<std::uint64_t>((scratch_[k] + 16.0) * 0x1p40)) %
               buckets;
    };
    bucket_begin_.assign(buckets + 1, 0);
    for (std::size_t k = 0; k < pairs.count; ++k) ++bucket_begin_[bucket(k) + 1];
    std::partial_sum(bucket_begin_.begin(), bucket_begin_.end(), bucket_begin_.begin());
    for (std::size_t k = 0; k < pairs.count; ++k) place_[k] = bucket_begin_[bucket(k)]++;
}

template <int d>
void PairSearch<d>::reorder(Particles<d> const& particles, NoiseKey key, PairList<d>& pairs) {
    place_.resize(pairs.count);
    scratch_.resize(pairs.distance.size());
    scratch_rows_.resize(pairs.i.size());
    sort_places(particles, key, pairs);
    auto const permute = [&](auto& values, auto& scratch) {
        for (std::size_t k = 0; k < pairs.count; ++k) scratch[place_[k]] = values[k];
        values.swap(scratch);
    };
    permute(pairs.i, scratch_rows_);
    permute(pairs.j, scratch_rows_);
    permute(pairs.distance, scratch_);
    for (auto& component : pairs.unit) permute(component, scratch_);
    for (auto& k : pairs.crossing) k = place_[k];
    std::sort(pairs.crossing.begin(), pairs.crossing.end());
    if (order != Order::id) return;
    // the pair's orientation, too, must not depend on the search; across a sheared boundary it is fixed
    auto crossing = pairs.crossing.begin();
    for (std::size_t k = 0; k < pairs.count; ++k) {
        if (crossing != pairs.crossing.end() && *crossing == k)
            ++crossing;
        else if (particles.id[pairs.i[k]] > particles.id[pairs.j[k]]) {
            std::swap(pairs.i[k], pairs.j[k]);
            for (auto& component : pairs.unit) component[k] = -component[k];
        }
    }
}

template <int d>
void PairSearch<d>::sort_particles(Particles<d>& particles, Box<d> const& box, double time) {
    if (search == Search::brute) return;
    sort_into_cells(particles, box, time);
    std::vector<Eigen::Index> rows;
    rows.reserve(static_cast<std::size_t>(particles.size()));
    for (std::size_t slot = 0; slot < entries_.size(); ++slot) {
        // an image is told from its owner by lying elsewhere
        bool own = true;
        for (int axis = 0; axis < d; ++axis)
            own &= sorted_[axis][slot] == particles.position(static_cast<Eigen::Index>(owner_[slot]), axis);
        if (own) rows.push_back(static_cast<Eigen::Index>(owner_[slot]));
    }
    Particles<d> const old = particles;
    particles.position = old.position(rows, Eigen::all);
    particles.velocity = old.velocity(rows, Eigen::all);
    particles.image = old.image(rows, Eigen::all);
    particles.id = old.id(rows);
}

template <int d>
std::size_t PairSearch<d>::bytes() const {
    return entries_.capacity() * sizeof(Entry) + cell_begin_.capacity() * sizeof(int) +
           owner_.capacity() * (sizeof(std::uint32_t) + d * sizeof(double)) +
           (place_.capacity() + bucket_begin_.capacity() + scratch_rows_.capacity()) * sizeof(std::uint32_t) +
           scratch_.capacity() * sizeof(double);
}

template struct PairList<2>;
template struct PairList<3>;
template class PairSearch<2>;
template class PairSearch<3>;

}  // namespace dpd
