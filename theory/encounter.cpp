#include "encounter.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "encounter_basis.hpp"

namespace dpd::theory {
namespace {

using namespace encounter;

// -----------------------------------------------------------------------------------------------------------
// The equation -L h = S of theory/memory.md, odd functions eliminated

/// Even functions of the velocity that are coupled by streaming to an odd one and back, with their matrix on
/// the element at hand.
struct Block {
    int row, column;
    ElementMatrix matrix;
};

constexpr int elements_inside_a_potential = 12;

class EncounterSolver {
public:
    EncounterSolver(Encounter const& pair, int rank, int degree)
        : pair_(pair),
          degree_(degree),
          basis_(pair.d, rank, degree),
          mesh_(pair.d, pair.structure.g ? elements_inside_a_potential : elements_inside, mesh_end) {
        for (int element = 0; element < mesh_.elements(); ++element) {
            points_.push_back(mesh_.points(element));
            if (!pair.structure.g) continue;
            for (auto& point : points_.back()) {
                point.volume *= pair.structure.g(point.r);
                point.mean_force = pair.structure.mean_force(point.r);
            }
        }
    }

    // [rate]
    /// What the medium and the partner take from a function of the velocity per unit time. In steps c of it
    /// is left after a collision, and the rate is (2/step) (1 - c)/(1 + c).
    double rate(VelocityFunction const& f, double r) const {
        if (pair_.step == 0.0) return pair_.medium * f.degree() + loss(pair_, f.i, r);
        double const c = kept(f, r);
        return 2.0 / pair_.step * (1.0 - c) / (1.0 + c);
    }
    double kept(VelocityFunction const& f, double r) const {
        return std::exp(-pair_.medium * pair_.step * f.degree()) * (1.0 - pair_.step * loss(pair_, f.i, r));
    }
    // [rate]

    int unknowns() const { return mesh_.nodes() * even_count(); }

    /// The matrix, with or without the odd functions of the highest degree.
    // [matrix]
    void factorize(bool with_highest) {
        std::vector<Eigen::Triplet<double>> entries;
        auto blocks = empty_blocks();
        for (int element = 0; element < mesh_.elements(); ++element) {
            for (auto& block : blocks) block.matrix.setZero();
            for (auto const& point : points_[element]) {
                for (int k = 0; k < even_count(); ++k)
                    blocks[block_of_[k][k]].matrix.noalias() +=
                        point.volume * rate(basis_.even[k], point.r) * point.shape * point.shape.transpose();
                for (std::size_t o = 0; o < basis_.odd.size(); ++o) {
                    if (!with_highest && basis_.odd[o].degree() > degree_) continue;
                    double const share = point.volume * square(speed) / rate(basis_.odd[o], point.r);
                    for (auto const& left : basis_.streaming[o])
                        for (auto const& right : basis_.streaming[o])
                            if (right.from <= left.from)
                                blocks[block_of_[left.from][right.from]].matrix.noalias() +=
                                    share * streamed(left, point) * streamed(right, point).transpose();
                }
            }
            for (auto const& block : blocks) append(entries, element, block);
        }
        Eigen::SparseMatrix<double> matrix(unknowns(), unknowns());
        matrix.setFromTriplets(entries.begin(), entries.end());
        cholesky_.compute(matrix);
        if (cholesky_.info() != Eigen::Success)
            throw std::domain_error("the encounter of two particles could not be solved at these frictions");
    }
    // [matrix]

    Eigen::VectorXd solve(Eigen::VectorXd const& source) const { return cholesky_.solve(source); }

    /// Of a step the solution needs a source times 2/(1 + c), and what the equal factors at the same step
    /// would add is taken away (2).
    // [source]
    double at_same_step(Source const& source) const {
        double sum = 0.0;
        for_each_point_in_range([&](int, Point const& point) {
            sum += point.volume * pair_.step * square(source.amplitude(pair_, point.r)) /
                   (1.0 + kept(source.function, point.r));
        });
        return sum;
    }
    double enhanced(Source const& source, double r) const {
        double const amplitude = source.amplitude(pair_, r);
        return pair_.step == 0.0 ? amplitude : 2.0 * amplitude / (1.0 + kept(source.function, r));
    }
    // [source]

    /// A source in an odd function: its share in the equation of the even functions, and what it
    /// remembers before it streams at all.
    std::pair<Eigen::VectorXd, double> odd_source(Source const& source) const {
        Eigen::VectorXd share = Eigen::VectorXd::Zero(unknowns());
        double at_once = 0.0;
        auto const& f = source.function;
        int const o = basis_.odd_index(f);
        for_each_point_in_range([&](int element, Point const& point) {
            double const a = enhanced(source, point.r), relaxed = a / rate(f, point.r);
            at_once += point.volume * a * relaxed;
            for (auto const& coupling : basis_.streaming[o])
                add(share, element, coupling.from,
                    -point.volume * speed * relaxed * streamed(coupling, point));
        });
        return {share, at_once};
    }

    /// A source in an even function, added to `sum`.
    void add_even_source(Eigen::VectorXd& sum, Source const& source) const {
        auto const& f = source.function;
        int const k = basis_.even_index(f);
        for_each_point_in_range([&](int element, Point const& point) {
            add(sum, element, k, point.volume * enhanced(source, point.r) * point.shape);
        });
    }

    /// A sum of sources of either kind in continuous time: in the equation, and as it reads the solution,
    /// where what an odd source has streamed has the other sign.
    struct Signal {
        Eigen::VectorXd sent, read;
        std::vector<Source> odd;
    };
    Signal signal(std::vector<Source> const& sources) const {
        Eigen::VectorXd of_even = Eigen::VectorXd::Zero(unknowns()), of_odd = of_even;
        std::vector<Source> odd;
        for (auto const& source : sources) {
            auto const& f = source.function;
            if (f.degree() % 2 == 1) {
                odd.push_back(source);
                int const o = basis_.odd_index(f);
                for_each_point([&](int element, Point const& point) {
                    double const relaxed = source.amplitude(pair_, point.r) / rate(f, point.r);
                    for (auto const& coupling : basis_.streaming[o])
                        add(of_odd, element, coupling.from,
                            -point.volume * speed * relaxed * streamed(coupling, point));
                });
            } else {
                int const k = basis_.even_index(f);
                for_each_point([&](int element, Point const& point) {
                    add(of_even, element, k, point.volume * source.amplitude(pair_, point.r) * point.shape);
                });
            }
        }
        return {of_even + of_odd, of_even - of_odd, odd};
    }

    /// \f$\int\int\langle X(0)Y(t)\rangle\f$ over time and pairs.
    double correlation(Signal const& first, Signal const& later) const {
        double sum = first.read.dot(solve(later.sent));
        for (auto const& X : first.odd)  // what is remembered before it streams
            for (auto const& Y : later.odd) {
                auto const &f = X.function, &g = Y.function;
                if (!(f == g)) continue;
                for_each_point([&](int, Point const& point) {
                    sum += point.volume * X.amplitude(pair_, point.r) * Y.amplitude(pair_, point.r) /
                           rate(f, point.r);
                });
            }
        return sum;
    }

private:
    int even_count() const { return static_cast<int>(basis_.even.size()); }

    static ElementVector streamed(Coupling const& coupling, Point const& point) {
        return coupling.slope * point.slope +
               (coupling.rotation / point.r + coupling.pushed * point.mean_force) * point.shape;
    }

    template <class Action>
    void for_each_point(Action const& action) const {
        for (int element = 0; element < mesh_.elements(); ++element)
            for (auto const& point : points_[element]) action(element, point);
    }
    template <class Action>
    void for_each_point_in_range(Action const& action) const {
        for_each_point([&](int element, Point const& point) {
            if (point.r < 1.0) action(element, point);
        });
    }

    /// Index of an unknown, or -1 where it is held at zero.
    int unknown(int element, int node, int even) const {
        int const at = element * order + node;
        return at < mesh_.nodes() ? at * even_count() + even : -1;
    }

    void add(Eigen::VectorXd& vector, int element, int even, ElementVector const& values) const {
        for (int a = 0; a <= order; ++a)
            if (int const at = unknown(element, a, even); at >= 0) vector[at] += values[a];
    }

    std::vector<Block> empty_blocks() {
        std::vector<Block> blocks;
        block_of_.assign(even_count(), std::vector<int>(even_count(), -1));
        auto const want = [&](int row, int column) {
            if (column > row || block_of_[row][column] >= 0) return;
            block_of_[row][column] = static_cast<int>(blocks.size());
            blocks.push_back({row, column, ElementMatrix::Zero()});
        };
        for (int k = 0; k < even_count(); ++k) want(k, k);
        for (auto const& couplings : basis_.streaming)
            for (auto const& left : couplings)
                for (auto const& right : couplings) want(left.from, right.from);
        return blocks;
    }

    /// The lower triangle of the element's share.
    void append(std::vector<Eigen::Triplet<double>>& entries, int element, Block const& block) const {
        for (int a = 0; a <= order; ++a)
            for (int b = 0; b <= order; ++b) {
                int const row = unknown(element, a, block.row), column = unknown(element, b, block.column);
                if (row < 0 || column < 0 || block.matrix(a, b) == 0.0) continue;
                // of a block on the diagonal both (a, b) and (b, a) are here
                if (block.row == block.column && row < column) continue;
                entries.emplace_back(std::max(row, column), std::min(row, column), block.matrix(a, b));
            }
    }

    Encounter pair_;
    int degree_;
    VelocityBasis basis_;
    RadialMesh mesh_;
    std::vector<std::vector<Point>> points_;  ///< of each element, weighted with g
    std::vector<std::vector<int>> block_of_;
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> cholesky_;
};

Bounds bounds(double one, double other) { return {std::min(one, other), std::max(one, other)}; }

}  // namespace

// [force memory]
Bounds force_memory(Encounter const& pair, int degree) {
    check(pair, degree);
    EncounterSolver solver(pair, 1, degree);
    auto const [source, at_once] = solver.odd_source(force_source);
    double const same_step = solver.at_same_step(force_source);
    double const kept = std::exp(-pair.medium * pair.step);  // half a step of the medium at either end
    std::array<double, 2> memory{};
    for (bool const with_highest : {false, true}) {
        solver.factorize(with_highest);
        memory[with_highest] = kept * (at_once - source.dot(solver.solve(source)) - same_step);
    }
    return bounds(memory[0], memory[1]);
}
// [force memory]

// [stress memory]
StressMemory stress_memory(Encounter const& pair, int degree) {
    check(pair, degree);
    EncounterSolver solver(pair, 2, degree);
    auto const [s, at_once] = solver.odd_source(stress_source);
    Eigen::VectorXd B = Eigen::VectorXd::Zero(solver.unknowns());
    solver.add_even_source(B, relaxation_along);
    solver.add_even_source(B, relaxation_across);
    double const s_same_step = solver.at_same_step(stress_source);
    double const B_same_step = solver.at_same_step(relaxation_along) + solver.at_same_step(relaxation_across);
    // half a step of the medium at either end, of first degree in s and of second in B
    auto const kept = [&](double ends) {
        return xy_share(pair.d) * std::exp(-ends * pair.medium * pair.step);
    };
    std::array<double, 2> collision{}, relaxation{}, cross{};
    for (bool const with_highest : {false, true}) {
        solver.factorize(with_highest);
        Eigen::VectorXd const of_s = solver.solve(s), of_B = solver.solve(B);
        collision[with_highest] = kept(1.0) * (at_once - s.dot(of_s) - s_same_step);
        relaxation[with_highest] = kept(2.0) * (B.dot(of_B) - B_same_step);
        cross[with_highest] = -kept(1.5) * s.dot(of_B);
    }
    return {bounds(collision[0], collision[1]), bounds(relaxation[0], relaxation[1]),
            bounds(cross[0], cross[1])};
}
// [stress memory]

namespace {

void check_soft(Encounter const& pair, int degree) {
    check(pair, degree);
    if (pair.step != 0.0)
        throw std::invalid_argument("the encounter with a potential is known in continuous time");
    if (!pair.structure.g || !pair.structure.mean_force || !pair.structure.force)
        throw std::invalid_argument("the encounter with a potential needs g and both forces");
}

/// The potential's force on a partner: the mean one, and the other's own.
double mean_force(Encounter const& pair, double r) { return pair.structure.mean_force(r); }
double own_force(Encounter const& pair, double r) { return pair.structure.force(r); }
using Force = double (*)(Encounter const&, double);

}  // namespace

// [soft force memory]
SoftForceMemory soft_force_memory(Encounter const& pair, int degree) {
    check_soft(pair, degree);
    EncounterSolver solver(pair, 1, degree);
    auto const f = solver.signal({force_source});
    auto const mean = solver.signal({{one, mean_force}}), own = solver.signal({{one, own_force}});
    SoftForceMemory memory{};
    for (bool const with_highest : {false, true}) {
        solver.factorize(with_highest);
        memory.friction += 0.5 * solver.correlation(f, f);
        memory.potential += 0.5 * solver.correlation(own, mean);
        memory.cross += 0.5 * solver.correlation(f, mean);
    }
    return memory;
}
// [soft force memory]

// [soft stress memory]
SoftStressMemory soft_stress_memory(Encounter const& pair, int degree) {
    check_soft(pair, degree);
    EncounterSolver solver(pair, 2, degree);
    auto const s = solver.signal({stress_source}), B = solver.signal({relaxation_along, relaxation_across});
    auto const B_F = [&](Force F) {
        return solver.signal(
            {{u_r, [F](Encounter const& p, double r) { return 2.0 * speed * tensor_size(p.d) * F(p, r); }},
             {u_t,
              [F](Encounter const& p, double r) { return speed * std::sqrt(2.0 * (p.d - 1.0)) * F(p, r); }}});
    };
    auto const Phi = [&](Force F) {
        return solver.signal(
            {{one, [F](Encounter const& p, double r) { return tensor_size(p.d) * r * F(p, r); }}});
    };
    auto const B_mean = B_F(mean_force), B_own = B_F(own_force);
    auto const Phi_mean = Phi(mean_force), Phi_own = Phi(own_force);
    SoftStressMemory memory{};
    double const share = 0.5 * xy_share(pair.d);
    for (bool const with_highest : {false, true}) {
        solver.factorize(with_highest);
        auto const correlation = [&](auto const& X, auto const& Y) {
            return share * solver.correlation(X, Y);
        };
        memory.collision += correlation(s, s);
        // B is even and B_F odd in the velocities, so that <B_F(0) B(t)> is -<B(0) B_F(t)>
        memory.relaxation += correlation(B, B) + 2.0 * correlation(B, B_mean) - correlation(B_own, B_mean);
        memory.cross += correlation(s, B) + correlation(s, B_mean);
        memory.potential += correlation(Phi_mean, s);
        double const of_friction = correlation(Phi_mean, B);
        memory.kinetic += of_friction + correlation(Phi_own, B_mean);
        memory.kinetic_by_mean_stress += of_friction + correlation(Phi_mean, B_own);
    }
    return memory;
}
// [soft stress memory]

}  // namespace dpd::theory
