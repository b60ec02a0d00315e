/// @file
/// The heat that explicit steps leave in a pair. Derived in theory/memory.md.
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "encounter_basis.hpp"

namespace dpd::theory {
namespace {

using namespace encounter;

/// An explicit step of a pair at one distance.
struct ExplicitStep {
    double a;       ///< w step
    double decay;   ///< kappa, what the medium takes of a velocity
    double excess;  ///< theta - 1 + kappa

    /// What becomes of each function of the velocity, a column, in terms of all of them.
    // [explicit step]
    Eigen::MatrixXd of(std::vector<VelocityFunction> const& functions) const {
        auto const count = std::ssize(functions);
        Eigen::MatrixXd made = Eigen::MatrixXd::Zero(count, count);
        double const heat = 4.0 * a * (excess + a);  // by which the variance of u_r grows
        for (Eigen::Index column = 0; column < count; ++column) {
            auto const [m, i, p] = functions[std::size_t(column)];
            // 1 - kappa - 2a of u_r is left, 1 - kappa of u_t; with the noise that keeps the temperature
            double share = std::pow(1.0 - decay - 2.0 * a, i) * std::pow(1.0 - decay, 2 * p + m);
            // and with more noise He_i becomes a sum over k of (heat/2)^k/k! He_{i+2k}, which are not
            // normalized
            for (int k = 0;; ++k) {
                int const row = VelocityBasis::index_in(functions, {m, i + 2 * k, p});
                if (row < 0) break;
                made(row, column) = share;
                share *= 0.5 * heat / (k + 1) * std::sqrt((i + 2 * k + 1.0) * (i + 2 * k + 2.0));
            }
        }
        return made;
    }
    // [explicit step]
};

Eigen::MatrixXd one_plus(Eigen::MatrixXd const& K) {
    return Eigen::MatrixXd::Identity(K.rows(), K.cols()) + K;
}
Eigen::MatrixXd one_minus(Eigen::MatrixXd const& K) {
    return Eigen::MatrixXd::Identity(K.rows(), K.cols()) - K;
}

/// The equation of the even functions, odd ones eliminated, of a pair that is heated: not symmetric, since
/// heat goes to higher degrees only.
class HeatedPair {
public:
    /// Polynomials up to `degree`, with or without the odd ones above it.
    HeatedPair(Encounter const& pair, double decay, double excess, int degree, bool with_highest)
        : pair_(pair),
          decay_(decay),
          excess_(excess),
          basis_(pair.d, 0, degree),
          mesh_(pair.d, elements_inside, mesh_end) {
        if (!with_highest) highest_odd_ = degree;
        unknowns_ = mesh_.nodes() * even();
        from_ = to_ = Eigen::VectorXd::Zero(unknowns_);
        for (int element = 0; element < mesh_.elements(); ++element) add(element);
    }

    double memory() const {
        Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
        matrix.setFromTriplets(entries_.begin(), entries_.end());
        Eigen::SparseLU<Eigen::SparseMatrix<double>> const solver(matrix);
        if (solver.info() != Eigen::Success)
            throw std::domain_error("the heat of two particles could not be found at this step");
        return to_.dot(solver.solve(from_)) - at_same_step_;
    }

private:
    Eigen::Index even() const { return std::ssize(basis_.even); }
    Eigen::Index odd() const { return std::ssize(basis_.odd); }

    void add(int element) {
        Eigen::Index const first = element * order * even(), size = (order + 1) * even();
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
        for (auto const& point : mesh_.points(element)) {
            auto const& thermostat = std::get<Shardlow>(pair_.thermostat);
            double const w = point.r < 1.0 ? thermostat.gamma * weight_at(thermostat.weight, point.r) : 0.0;
            ExplicitStep const step{w * pair_.step, decay_, excess_};
            Eigen::MatrixXd const K = step.of(basis_.even);
            Eigen::MatrixXd const sum = one_plus(K);  // lower triangular
            // [heated matrix]
            Eigen::MatrixXd const rate =
                2.0 / pair_.step * sum.triangularView<Eigen::Lower>().solve(one_minus(K));
            Eigen::MatrixXd const streamed = streaming(point);
            matrix.noalias() += point.volume * streamed.transpose() * (odd_lifetimes(step) * streamed);
            for (int row = 0; row <= order; ++row)
                for (int column = 0; column <= order; ++column)
                    matrix.block(row * even(), column * even(), even(), even()) +=
                        point.volume * point.shape[row] * point.shape[column] * rate;
            // [heated matrix]
            if (w > 0.0) add_ends(first, point, step, K, sum);
        }
        // the outermost node is held at zero
        for (Eigen::Index column = 0; column < size && first + column < unknowns_; ++column)
            for (Eigen::Index row = 0; row < size && first + row < unknowns_; ++row)
                if (matrix(row, column) != 0.0)
                    entries_.emplace_back(first + row, first + column, matrix(row, column));
    }

    /// u.grad of the even functions at the nodes of an element, columns, in the odd ones.
    Eigen::MatrixXd streaming(Point const& point) const {
        Eigen::MatrixXd streamed = Eigen::MatrixXd::Zero(odd(), (order + 1) * even());
        for (Eigen::Index o = 0; o < odd(); ++o)
            for (auto const& coupling : basis_.streaming[std::size_t(o)])
                for (int node = 0; node <= order; ++node)
                    streamed(o, node * even() + coupling.from) +=
                        speed * (coupling.slope * point.slope[node] +
                                 coupling.rotation / point.r * point.shape[node]);
        return streamed;
    }

    /// The inverse of the odd functions' rates.
    Eigen::MatrixXd odd_lifetimes(ExplicitStep const& step) const {
        Eigen::MatrixXd const K = step.of(basis_.odd), difference = one_minus(K);
        Eigen::MatrixXd lifetimes =
            0.5 * pair_.step * difference.triangularView<Eigen::Lower>().solve(one_plus(K));
        for (Eigen::Index o = 0; o < odd(); ++o)
            if (basis_.odd[std::size_t(o)].degree() > highest_odd_) lifetimes.row(o).setZero();
        return lifetimes;
    }

    /// What a step adds to Maxwell's distribution, and the energy over 2 kT that is gained in one, as the
    /// solution reads it.
    void add_ends(Eigen::Index first, Point const& point, ExplicitStep const& step, Eigen::MatrixXd const& K,
                  Eigen::MatrixXd const& sum) {
        // [heated ends]
        int const density = basis_.even_index(one), along = basis_.even_index(u_r_u_r);
        Eigen::VectorXd added = K.col(density), gained = Eigen::VectorXd::Zero(even());
        added[density] = 0.0;
        gained[density] = step.a * (excess_ + step.a);
        gained[along] = std::numbers::sqrt2 * step.a * (step.a - 1.0 + decay_);
        sum.triangularView<Eigen::Lower>().solveInPlace(added);
        at_same_step_ += point.volume * gained.dot(added);
        sum.transpose().triangularView<Eigen::Upper>().solveInPlace(gained);
        // [heated ends]
        for (int node = 0; node <= order; ++node) {
            double const share = 2.0 * point.volume * point.shape[node];
            from_.segment(first + node * even(), even()) += share / pair_.step * added;
            to_.segment(first + node * even(), even()) += share * gained;
        }
    }

    Encounter pair_;
    double decay_, excess_;
    VelocityBasis basis_;
    RadialMesh mesh_;
    int highest_odd_ = std::numeric_limits<int>::max();
    Eigen::Index unknowns_ = 0;
    std::vector<Eigen::Triplet<double>> entries_;
    Eigen::VectorXd from_, to_;
    double at_same_step_ = 0.0;
};

}  // namespace

// [heat memory]
double heat_memory(Encounter const& pair, double decay, double excess, int degree) {
    Encounter checked = pair;
    checked.medium = decay;
    check(checked, degree);
    return 0.5 * (HeatedPair(pair, decay, excess, degree, true).memory() +
                  HeatedPair(pair, decay, excess, degree, false).memory());
}
// [heat memory]

}  // namespace dpd::theory
