/// @file
/// Sums in an order of their own. Eigen's follow the width of the vectors that a machine has.
#pragma once

#include <Eigen/Core>
#include <array>

namespace dpd {

/// The sum of all coefficients: four partial sums, each of every fourth row, then theirs.
template <class Expression>
double sum_of(Eigen::DenseBase<Expression> const& expression) {
    auto const& x = expression.derived();
    Eigen::Index const rows = x.rows(), columns = x.cols(), whole = rows - rows % 4;
    std::array<double, 4> partial{};
    auto const add = [&](std::size_t lane, Eigen::Index row) {
        for (Eigen::Index column = 0; column < columns; ++column) partial[lane] += x.coeff(row, column);
    };
    for (Eigen::Index row = 0; row < whole; row += 4)
        for (std::size_t lane = 0; lane < 4; ++lane) add(lane, row + Eigen::Index(lane));
    for (Eigen::Index row = whole; row < rows; ++row) add(std::size_t(row - whole), row);
    return (partial[0] + partial[1]) + (partial[2] + partial[3]);
}

/// Their mean.
template <class Expression>
double mean_of(Eigen::DenseBase<Expression> const& x) {
    return sum_of(x) / double(x.size());
}

/// The sum of their squares.
template <class Expression>
double sum_of_squares(Eigen::DenseBase<Expression> const& x) {
    return sum_of(x.derived().array().square());
}

}  // namespace dpd
