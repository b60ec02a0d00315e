/// @file
/// The pair search shared by all stages of a step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "box.hpp"
#include "noise.hpp"
#include "pair_list.hpp"
#include "particles.hpp"
#include "simd_pairs.hpp"

namespace dpd {

enum class Search {
    cell,   ///< linked to a grid of cells at least a cutoff wide
    brute,  ///< all N(N-1)/2 pairs: the reference that the cell search is tested against
};

constexpr std::string_view name_of(Search value) {
    switch (value) {
        case Search::cell:
            return "cell";
        case Search::brute:
            return "brute";
    }
    return "";
}

/// In which order sequential updates (Shardlow, Lowe) visit the pairs. NG2007 leaves it open. Each follows
/// from positions and ids alone: an order that knows velocities would not keep the exact state.
enum class Order {
    cell,    ///< by cells and by ids within one: neighbours in space follow each other in the sequence
    id,      ///< by particle ids: independent of the search
    random,  ///< a new random one at each search
};

constexpr std::string_view name_of(Order value) {
    switch (value) {
        case Order::cell:
            return "cell";
        case Order::id:
            return "id";
        case Order::random:
            return "random";
    }
    return "";
}

/// Finds pairs; keeps its work arrays between calls.
template <int d>
class PairSearch {
public:
    Search search = Search::cell;  ///< how pairs are found
    Order order = Order::cell;     ///< in which order they are listed
    double cutoff = 1.0;           ///< largest distance, length

    /// Refuses (InputError) a box in which a particle could meet two images of another: the minimum image
    /// needs sides of at least two cutoffs.
    void check(Box<d> const& box) const;

    /// Fills `pairs` for the state at `time`. `key` feeds Order::random alone.
    void find(Particles<d> const& particles, Box<d> const& box, double time, NoiseKey key,
              PairList<d>& pairs);

    /// Puts the state's rows into cell order, so that partners are near in memory.
    void sort_particles(Particles<d>& particles, Box<d> const& box, double time);

    /// Bytes held by the work arrays.
    std::size_t bytes() const;

private:
    void find_by_brute_force(Particles<d> const&, Box<d> const&, double time, PairList<d>&);
    void find_by_cells(Particles<d> const&, Box<d> const&, double time, PairList<d>&);
    void sort_into_cells(Particles<d> const&, Box<d> const&, double time);
    /// Where search_layer looks for partners.
    struct Partners {
        bool own_layer = false;
        bool layer_above = false;
        bool sheared_image = false;  ///< of the lowest layer, which lies above the highest one
    };
    void search_layer(Particles<d> const&, Box<d> const&, double time, int y, Partners, PairList<d>&);
    void separate(Particles<d> const&, simd::Geometry<d> const&, std::size_t from, std::size_t size,
                  PairList<d>&) const;
    simd::Geometry<d> geometry(Box<d> const&, double time, bool across) const;
    void reorder(Particles<d> const&, NoiseKey, PairList<d>&);
    void sort_pairs(Particles<d> const&, NoiseKey, PairList<d> const&);
    void sort_by_bucket(std::size_t buckets, auto const& bucket);
    double margin(Box<d> const&) const;

    // Cells of one row, with its images; and the first cell of the row at (y, x), in two dimensions at y.
    int row_length() const { return cells_[contiguous] + 2 * reach; }
    int row_begin(int y, int x) const { return (d == 3 ? y * cells_[0] + x : y) * row_length(); }
    // Calls visit(first cell, one past the last), without the row's images.
    template <class Visit>
    void for_each_row_of_cells(Visit visit) const {
        int const end = static_cast<int>(cell_begin_.size()) - 1;
        for (int row = 0; row < end; row += row_length())
            visit(row + reach, row + reach + cells_[contiguous]);
    }

    // Cells are at least a cutoff wide in y and x; along the last axis, where neighbouring cells are
    // contiguous in memory, thinner by `reach`. They are numbered along y (slowest), x, z. A row of cells is
    // padded by images, `reach` cells on either side, so that the search along it knows no boundary. In shear
    // the image of the lowest layer, which is displaced along x, has cells of its own above the others.
    static constexpr int contiguous = d == 3 ? 2 : 0;
    static constexpr int reach = 4;
    std::array<int, d> cells_{};
    int together_ = 1;  // cells of a row whose particles share their candidates
    std::vector<int> cell_begin_;
    std::vector<int> next_;  // place in each cell
    struct Image {
        std::uint32_t row, cell;
    };
    std::vector<std::uint32_t> cell_of_, row_of_id_;    // of the particles
    std::vector<Image> images_;                         // of the lowest layer, in shear
    std::array<std::vector<float>, d> sorted_;          // positions of particles and images, by cell
    std::vector<std::uint32_t> owner_;                  // row of the particle behind each of them
    std::vector<simd::Candidates> candidates_;          // of one row of cells
    std::vector<std::uint32_t> source_, bucket_begin_;  // scratch of `reorder`, as are the next two
    std::vector<std::uint32_t> scratch_rows_;
    std::vector<double> scratch_;
};

extern template class PairSearch<2>;
extern template class PairSearch<3>;

}  // namespace dpd
