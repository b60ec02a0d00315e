#include "pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "elementary.hpp"
#include "pair_loop.hpp"

namespace dpd {

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
    pairs.cutoff = cutoff;
    // In a side of just two cutoffs rounding could let a pair meet twice; there the definition itself
    // searches.
    bool const tight = box.length.minCoeff() < 2.0 * (cutoff + margin(box)) * (1.0 + 1e-9);
    if (search == Search::brute || tight)
        find_by_brute_force(particles, box, time, pairs);
    else
        find_by_cells(particles, box, time, pairs);
    if (order != Order::cell) reorder(particles, key, pairs);
}

namespace {

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
                double const r = std::sqrt(squared);
                pairs.append({i, j, separation.array().transpose() * (1.0 / r), r, across});
            }
    };
    pass(false);
    if (box.sheared()) pass(true);
}

// By how much a distance in single precision may be wrong: a coordinate, of an image too, by four roundings
// of at most 2^-24 twice the longest side, a difference of two by nine.
template <int d>
double PairSearch<d>::margin(Box<d> const& box) const {
    return 9.0 * std::sqrt(double(d)) * 0x1p-24 * 2.0 * (box.length.maxCoeff() + cutoff);
}

template <int d>
void PairSearch<d>::sort_into_cells(Particles<d> const& particles, Box<d> const& box, double time) {
    // Cells of a cutoff, or wider in a dilute system: about one particle each is enough.
    double const spacing = nth_root(box.volume() / std::max<double>(1.0, double(particles.size())), d);
    double const width = std::max(cutoff, spacing);
    for (int axis = 0; axis < d; ++axis)
        cells_[axis] = static_cast<int>(box.length[axis] / std::min(width, box.length[axis] / 2.0) *
                                        (axis == contiguous ? reach : 1));
    // so that a row of candidates fills most of a vector, and none is seen in two images
    double const per_cell = power(width / spacing, d) / reach;
    together_ = std::clamp(static_cast<int>(std::lround(0.75 * simd::widest / per_cell)) - 2 * reach, 1,
                           cells_[contiguous] - reach);

    auto const rows = static_cast<std::size_t>(particles.size());
    int const layers = cells_[1] + (box.sheared() ? 1 : 0);
    cell_begin_.assign(static_cast<std::size_t>(row_begin(layers, 0)) + 1, 0);
    auto const cell_at = [&](double x, int axis) {
        return std::min(static_cast<int>(x * cells_[axis] / box.length[axis]), cells_[axis] - 1);
    };
    auto const count_in = [&](std::array<int, d> const& c) {
        auto const cell = static_cast<std::uint32_t>(row_begin(c[1], c[0]) + reach + c[contiguous]);
        ++cell_begin_[cell + 1];
        return cell;
    };
    cell_of_.resize(rows);
    row_of_id_.resize(rows);
    images_.clear();
    auto const image_x = [&, offset = box.offset(time)](std::size_t p) {
        double const x = particles.position(Eigen::Index(p), 0) + offset;
        return x - box.length[0] * std::floor(x / box.length[0]);
    };
    for (std::size_t p = 0; p < rows; ++p) {
        std::array<int, d> c;
        for (int axis = 0; axis < d; ++axis)
            c[axis] = cell_at(particles.position(Eigen::Index(p), axis), axis);
        cell_of_[p] = count_in(c);
        row_of_id_[particles.id[Eigen::Index(p)]] = static_cast<std::uint32_t>(p);
        if (!box.sheared() || c[1] != 0) continue;
        c[0] = cell_at(image_x(p), 0);
        c[1] = cells_[1];
        images_.push_back({static_cast<std::uint32_t>(p), count_in(c)});
    }
    for_each_row_of_cells([count = cell_begin_.data() + 1](int first, int last) {
        std::copy_n(count + last - reach, reach, count + first - reach);
        std::copy_n(count + first, reach, count + last);
    });
    std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());

    // Within a cell by ids, since they come in that order: the order of a list is that of positions and ids,
    // and knows nothing of velocities.
    owner_.resize(static_cast<std::size_t>(cell_begin_.back()) + simd::widest);
    for (auto& component : sorted_) component.resize(owner_.size());
    next_ = cell_begin_;
    auto const put = [&](std::uint32_t row, std::uint32_t cell) {
        owner_[static_cast<std::size_t>(next_[cell]++)] = row;
    };
    for (std::uint32_t const row : row_of_id_) put(row, cell_of_[row]);
    std::sort(images_.begin(), images_.end(),
              [id = particles.id.data()](Image const& a, Image const& b) { return id[a.row] < id[b.row]; });
    for (Image const& image : images_) put(image.row, image.cell);
    for_each_row_of_cells([&](int first, int last) {
        bool const image = first >= row_begin(cells_[1], 0);
        auto const stop = static_cast<std::size_t>(cell_begin_[std::size_t(last)]);
        for (auto slot = static_cast<std::size_t>(cell_begin_[std::size_t(first)]); slot < stop; ++slot) {
            for (int axis = 0; axis < d; ++axis)
                sorted_[axis][slot] = static_cast<float>(particles.position(owner_[slot], axis));
            if (image) sorted_[0][slot] = static_cast<float>(image_x(owner_[slot]));
        }
    });

    auto const copy_cells = [&](int from, int to, double shift) {
        int const begin = cell_begin_[std::size_t(from)], stop = cell_begin_[std::size_t(from + reach)];
        int const target = cell_begin_[std::size_t(to)];
        std::copy(owner_.begin() + begin, owner_.begin() + stop, owner_.begin() + target);
        for (int axis = 0; axis < d; ++axis) {
            float const by = axis == contiguous ? static_cast<float>(shift) : 0.0f;
            std::transform(sorted_[axis].begin() + begin, sorted_[axis].begin() + stop,
                           sorted_[axis].begin() + target, [by](float x) { return x + by; });
        }
    };
    for_each_row_of_cells([&](int first, int last) {
        copy_cells(last - reach, first - reach, -box.length[contiguous]);
        copy_cells(first, last, box.length[contiguous]);
    });
}

// All pairs whose first member lies in layer y, with partners where `partners` says. Half of the
// neighbourhood, so that each pair is met once.
template <int d>
void PairSearch<d>::search_layer(Particles<d> const& particles, Box<d> const& box, double time, int y,
                                 Partners partners, PairList<d>& pairs) {
    bool const own = partners.own_layer, above = partners.layer_above || partners.sheared_image;
    simd::Geometry<d> const nearest_image = geometry(box, time, partners.sheared_image);
    auto const begin_of = [&](int cell) { return static_cast<std::size_t>(cell_begin_[std::size_t(cell)]); };
    auto const limit = static_cast<float>(power(cutoff + margin(box), 2) * (1.0 + 1e-6));
    simd::Sorted<d> sorted{{}, owner_.data()};
    for (std::size_t axis = 0; axis < d; ++axis) sorted.position[axis] = sorted_[axis].data();

    // With two cells along x a particle can be a candidate in two images. There the particles of a cell
    // search one by one, which keeps the pairs of each in the order of the rows.
    bool const seen_twice = d == 3 && cells_[0] < 3;
    for (int x = 0; x < (d == 3 ? cells_[0] : 1); ++x) {
        struct Row {
            int begin;
            float x, y;  // how far its image is displaced
        };
        std::array<Row, 4> rows;
        std::size_t row_count = 0;
        auto const add_row = [&](int row_x, int row_y) {
            int const turn = row_x < 0 ? -1 : row_x == cells_[0] ? 1 : 0;
            bool const beyond = row_y == cells_[1];
            rows[row_count++] = {
                row_begin(beyond && !partners.sheared_image ? 0 : row_y, row_x - turn * cells_[0]),
                static_cast<float>(turn * box.length[0]), static_cast<float>(beyond ? box.length[1] : 0.0)};
        };
        if (d == 3 && own) add_row(x + 1, y);
        if (d == 3 && above) add_row(x - 1, y + 1);
        if (above) add_row(x, y + 1);
        if (d == 3 && above) add_row(x + 1, y + 1);

        candidates_.clear();
        std::size_t most = 0;
        for (int c = 0; c < cells_[contiguous]; c += together_) {
            int const home = row_begin(y, x) + c + reach, size = std::min(together_, cells_[contiguous] - c);
            std::size_t const begin = begin_of(home), end = begin_of(home + size);
            if (begin == end) continue;
            simd::Candidates cell{begin, end, 1, {}};
            cell.ranges[0] = {begin, own ? begin_of(home + size + reach) : begin, {}};
            std::size_t total = cell.ranges[0].end - begin;
            for (std::size_t r = 0; r < row_count; ++r) {
                simd::Range const range{begin_of(rows[r].begin + c),
                                        begin_of(rows[r].begin + c + size + 2 * reach),
                                        {rows[r].x, rows[r].y}};
                total += range.end - range.begin;
                cell.ranges[cell.range_count++] = range;
            }
            most += (end - begin) * total;
            if (!seen_twice) {
                candidates_.push_back(cell);
                continue;
            }
            for (std::size_t home_particle = begin; home_particle < end; ++home_particle) {
                cell.home_begin = home_particle;
                cell.home_end = home_particle + 1;
                if (own) cell.ranges[0].begin = home_particle;
                candidates_.push_back(cell);
            }
        }
        std::size_t const begin = pairs.count;
        pairs.grow_to(begin + most + simd::widest);
        std::size_t const end =
            begin + simd::find_near(sorted, candidates_, limit, &pairs.i[begin], &pairs.j[begin]);
        for (std::size_t from = begin; from < end; from += block_size)
            separate(particles, nearest_image, from, std::min(block_size, end - from), pairs);
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

// Appends `size` pairs, whose rows stand from `from` on: separations, then unit vectors and distances. What
// is no pair after all is left out, and so are pairs at r = 0, so that every listed pair has a direction.
template <int d>
void PairSearch<d>::separate(Particles<d> const& particles, simd::Geometry<d> const& geometry,
                             std::size_t from, std::size_t size, PairList<d>& pairs) const {
    std::size_t const begin = pairs.count, end = begin + size;
    std::uint32_t *const rows_i = &pairs.i[begin], *const rows_j = &pairs.j[begin];
    if (from > begin) {
        std::copy_n(&pairs.i[from], size, rows_i);
        std::copy_n(&pairs.j[from], size, rows_j);
    }
    simd::PairColumns<d> columns{size, {}, &pairs.distance[begin]};
    for (std::size_t axis = 0; axis < d; ++axis) columns.unit[axis] = &pairs.unit[axis][begin];
    // in order: scalar loads are faster than the gathers that a wide loop would make of them
    ordered_loop(0, size, [=, position = particles.position.data(), unit = columns.unit](std::size_t k) {
        std::size_t const i = d * std::size_t{rows_i[k]}, j = d * std::size_t{rows_j[k]};
        for (std::size_t axis = 0; axis < d; ++axis) unit[axis][k] = position[i + axis] - position[j + axis];
    });
    if (simd::normalize(geometry, columns) == 0) [[likely]] {
        pairs.count = end;
        return;
    }
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
    for (int y = 0; y < top; ++y)
        search_layer(particles, box, time, y, {.own_layer = true, .layer_above = true}, pairs);
    search_layer(particles, box, time, top, {.own_layer = true, .layer_above = !box.sheared()}, pairs);
    std::size_t const within = pairs.count;
    if (box.sheared()) search_layer(particles, box, time, top, {.sheared_image = true}, pairs);
    pairs.crossing.resize(pairs.count - within);
    std::iota(pairs.crossing.begin(), pairs.crossing.end(), static_cast<std::uint32_t>(within));
}

// A counting sort of source_, in which those of one bucket keep their order.
template <int d>
void PairSearch<d>::sort_by_bucket(std::size_t buckets, auto const& bucket) {
    bucket_begin_.assign(buckets + 1, 0);
    for (std::uint32_t const k : source_) ++bucket_begin_[bucket(k) + 1];
    std::partial_sum(bucket_begin_.begin(), bucket_begin_.end(), bucket_begin_.begin());
    auto const end = std::copy(source_.begin(), source_.end(), scratch_rows_.begin());
    std::for_each(scratch_rows_.begin(), end,
                  [&](std::uint32_t k) { source_[bucket_begin_[bucket(k)]++] = k; });
}

// Which pair comes when: source_[k] is the place at which the k-th one was found.
template <int d>
void PairSearch<d>::sort_pairs(Particles<d> const& particles, NoiseKey key, PairList<d> const& pairs) {
    std::iota(source_.begin(), source_.end(), 0u);
    if (order == Order::id) {
        auto const id = [&](std::uint32_t row) { return particles.id[row]; };
        auto const count = static_cast<std::size_t>(particles.size());
        sort_by_bucket(count, [&](std::uint32_t k) { return std::max(id(pairs.i[k]), id(pairs.j[k])); });
        sort_by_bucket(count, [&](std::uint32_t k) { return std::min(id(pairs.i[k]), id(pairs.j[k])); });
        return;
    }
    // The few pairs that share a bucket stay in the order in which they were found. The low bits of a normal
    // variate are uniform.
    pair_normals(key, {pairs.i.data(), pairs.count}, {pairs.j.data(), pairs.count}, particles.id.data(),
                 {scratch_.data(), pairs.count});
    constexpr std::uint32_t buckets = 1u << 16;
    sort_by_bucket(buckets, [&](std::uint32_t k) {
        return static_cast<std::uint32_t>(static_cast<std::uint64_t>((scratch_[k] + 16.0) * 0x1p40)) %
               buckets;
    });
}

template <int d>
void PairSearch<d>::reorder(Particles<d> const& particles, NoiseKey key, PairList<d>& pairs) {
    source_.resize(pairs.count);
    scratch_.resize(pairs.distance.size());
    scratch_rows_.resize(pairs.i.size());
    sort_pairs(particles, key, pairs);
    auto const permute = [&](auto& values, auto& scratch) {
        for (std::size_t k = 0; k < pairs.count; ++k) scratch[k] = values[source_[k]];
        values.swap(scratch);
    };
    permute(pairs.i, scratch_rows_);
    permute(pairs.j, scratch_rows_);
    permute(pairs.distance, scratch_);
    for (auto& component : pairs.unit) permute(component, scratch_);
    // those across a sheared boundary were found last
    std::size_t const within = pairs.count - pairs.crossing.size();
    pairs.crossing.clear();
    for (std::uint32_t k = 0; k < pairs.count; ++k)
        if (source_[k] >= within) pairs.crossing.push_back(k);
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
    for_each_row_of_cells([&](int first, int last) {
        if (first < row_begin(cells_[1], 0))
            rows.insert(rows.end(), owner_.begin() + cell_begin_[std::size_t(first)],
                        owner_.begin() + cell_begin_[std::size_t(last)]);
    });
    Particles<d> const old = particles;
    particles.position = old.position(rows, Eigen::all);
    particles.velocity = old.velocity(rows, Eigen::all);
    particles.image = old.image(rows, Eigen::all);
    particles.id = old.id(rows);
}

template <int d>
std::size_t PairSearch<d>::bytes() const {
    return (cell_begin_.capacity() + next_.capacity()) * sizeof(int) +
           (cell_of_.capacity() + row_of_id_.capacity()) * sizeof(std::uint32_t) +
           owner_.capacity() * (sizeof(std::uint32_t) + d * sizeof(float)) +
           candidates_.capacity() * sizeof(simd::Candidates) +
           (source_.capacity() + bucket_begin_.capacity() + scratch_rows_.capacity()) *
               sizeof(std::uint32_t) +
           scratch_.capacity() * sizeof(double);
}

template class PairSearch<2>;
template class PairSearch<3>;

}  // namespace dpd
