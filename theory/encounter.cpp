#include "encounter.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "closed_forms.hpp"

namespace dpd::theory {
namespace {

double square(double x) { return x * x; }

/// Thermal speed of one component of g, whose variance is 2.
constexpr double speed = std::numbers::sqrt2;

// -----------------------------------------------------------------------------------------------------------
// Velocities

/// A polynomial in the velocity u = g/speed: Hermite of order i along r^, and across it the m-th power of
/// u_t times Laguerre of order p in u_t^2/2, all orthonormal under the Maxwell distribution.
struct VelocityFunction {
    int m, i, p;
    int tangential_degree() const { return 2 * p + m; }
    int degree() const { return i + tangential_degree(); }
};

/// Share of an even function in what streaming makes of it in an odd one: slope d/dr + rotation/r.
struct Coupling {
    int from;
    double slope, rotation;
};

/// Functions of the velocity that turn with r^ like a tensor of rank `rank` (1 or 2), up to a degree: the
/// even ones up to `degree`, the odd ones up to degree + 1, which are all that streaming makes of the even.
class VelocityBasis {
public:
    VelocityBasis(int d, int rank, int degree) : d_(d), rank_(rank), m_max_(d == 2 ? 1 : rank) {
        for (int m = 0; m <= m_max_; ++m)
            for (int p = 0; 2 * p + m <= degree + 1; ++p)
                for (int i = 0; i + 2 * p + m <= degree + 1; ++i) {
                    VelocityFunction const f{m, i, p};
                    if (f.degree() % 2 == 1)
                        odd.push_back(f);
                    else if (f.degree() <= degree)
                        even.push_back(f);
                }
        streaming.resize(odd.size());
        for (int k = 0; k < static_cast<int>(even.size()); ++k) stream(k);
    }

    int even_index(int m, int i, int p) const { return index_in(even, m, i, p); }
    int odd_index(int m, int i, int p) const { return index_in(odd, m, i, p); }

    std::vector<VelocityFunction> even, odd;
    std::vector<std::vector<Coupling>> streaming;  ///< of each odd function

private:
    static int index_in(std::vector<VelocityFunction> const& list, int m, int i, int p) {
        auto const found = std::ranges::find_if(
            list, [&](VelocityFunction const& f) { return f.m == m && f.i == i && f.p == p; });
        return found == list.end() ? -1 : static_cast<int>(found - list.begin());
    }

    /// Index of the Laguerre polynomials.
    double laguerre(int m) const { return 0.5 * (d_ - 1) + m - 1; }

    /// By how much the rotation of r^ takes tensors of u_t^m to those of u_t^(m+1).
    // [turning]
    double turning(int m) const {
        if (rank_ == 1) return 1.0;
        return m == 0 ? std::sqrt(2.0 * d_ / (d_ - 1)) : std::sqrt(2.0 * (d_ - 2) / (d_ - 1));
    }
    // [turning]

    /// u.grad of the even function k, row by row.
    // [streaming]
    void stream(int k) {
        auto const [m, i, p] = even[k];
        int const e = even[k].tangential_degree();
        double const a = laguerre(m);
        auto const add = [&](VelocityFunction to, double slope, double rotation) {
            int const row = odd_index(to.m, to.i, to.p);
            if (row >= 0) streaming[row].push_back({k, slope, rotation});
        };
        // along r^, and the centrifugal change of u_r and |u_t|
        add({m, i + 1, p}, std::sqrt(i + 1.0), -std::sqrt(i + 1.0) * e);
        add({m, i - 1, p}, std::sqrt(i), std::sqrt(i) * (e + d_ - 1));
        add({m, i - 1, p + 1}, 0.0, -2.0 * std::sqrt(i * (p + 1) * (p + a + 1.0)));
        add({m, i + 1, p - 1}, 0.0, 2.0 * std::sqrt((i + 1) * p * (p + a)));
        // r^ turns
        if (m < m_max_) {
            add({m + 1, i, p}, 0.0, turning(m) * std::sqrt(2.0 * (p + a + 1.0)));
            add({m + 1, i, p - 1}, 0.0, -turning(m) * std::sqrt(2.0 * p));
        }
        if (m > 0) {
            add({m - 1, i, p}, 0.0, -turning(m - 1) * std::sqrt(2.0 * (p + a)));
            add({m - 1, i, p + 1}, 0.0, turning(m - 1) * std::sqrt(2.0 * (p + 1)));
        }
    }
    // [streaming]

    int d_, rank_, m_max_;
};

// -----------------------------------------------------------------------------------------------------------
// Distances

constexpr int order = 4;  ///< of the polynomials in r on an element
using ElementVector = Eigen::Matrix<double, order + 1, 1>;
using ElementMatrix = Eigen::Matrix<double, order + 1, order + 1>;

/// A quadrature point of an element: r, its share of the volume, and the shape functions and their slopes.
struct Point {
    double r, volume;
    ElementVector shape, slope;
};

/// Value and slope of the Lagrange polynomials through Chebyshev's points of [0, 1].
std::pair<ElementVector, ElementVector> shape_functions(double x) {
    auto const node = [](int a) { return 0.5 * (1.0 - std::cos(std::numbers::pi * a / order)); };
    ElementVector value, slope;
    for (int a = 0; a <= order; ++a) {
        value[a] = 1.0;
        slope[a] = 0.0;
        for (int b = 0; b <= order; ++b) {
            if (b == a) continue;
            double const width = node(a) - node(b);
            slope[a] = slope[a] * (x - node(b)) / width + value[a] / width;
            value[a] *= (x - node(b)) / width;
        }
    }
    return {value, slope};
}

/// Elements from r = 0 to far outside the range, where the functions are zero.
class RadialMesh {
public:
    explicit RadialMesh(int d) : d_(d) {
        constexpr int inside = 8;
        constexpr double growth = 2.0, outermost = 60.0;
        // finer at r = 0, where r^ turns fast, and at the edge, where the friction sets in
        for (int j = 0; j <= inside; ++j)
            ends_.push_back(0.5 * (1.0 - std::cos(std::numbers::pi * j / inside)));
        ends_.back() = 1.0;
        double width = ends_[inside] - ends_[inside - 1];
        while (ends_.back() < outermost) {
            width = std::min(growth * width, 0.5 * ends_.back() + 0.1);
            ends_.push_back(ends_.back() + width);
        }
    }

    int elements() const { return static_cast<int>(ends_.size()) - 1; }
    int nodes() const { return elements() * order; }  ///< without the outermost, which is held at zero

    std::vector<Point> points(int element) const {
        using Gauss = boost::math::quadrature::gauss<double, 10>;  // holds the nodes >= 0 only
        double const start = ends_[element], width = ends_[element + 1] - start;
        std::vector<Point> result;
        for (std::size_t g = 0; g < Gauss::abscissa().size(); ++g)
            for (double const sign : {-1.0, 1.0}) {
                double const x = 0.5 * (1.0 + sign * Gauss::abscissa()[g]);
                auto const [value, slope] = shape_functions(x);
                double const r = start + width * x;
                double const volume =
                    unit_sphere_surface(d_) * std::pow(r, d_ - 1) * 0.5 * width * Gauss::weights()[g];
                result.push_back({r, volume, value, slope / width});
            }
        return result;
    }

private:
    int d_;
    std::vector<double> ends_;
};

// -----------------------------------------------------------------------------------------------------------
// The equation -L h = S of theory/memory.md, odd functions eliminated

/// Even functions of the velocity that are coupled by streaming to an odd one and back, with their matrix on
/// the element at hand.
struct Block {
    int row, column;
    ElementMatrix matrix;
};

class EncounterSolver {
public:
    EncounterSolver(Encounter const& pair, int rank, int degree)
        : pair_(pair), degree_(degree), basis_(pair.d, rank, degree), mesh_(pair.d) {}

    // [rate]
    /// What the medium and the partner take from a function of the velocity per unit time. In steps c of it
    /// is left after a collision, and the rate is (2/step) (1 - c)/(1 + c).
    double rate(VelocityFunction const& f, double r) const {
        if (pair_.step == 0.0) return pair_.medium * f.degree() + 2.0 * friction(r) * f.i;
        double const c = kept(f, r);
        return 2.0 / pair_.step * (1.0 - c) / (1.0 + c);
    }
    double kept(VelocityFunction const& f, double r) const {
        return std::exp(-pair_.medium * pair_.step * f.degree()) * std::pow(1.0 - 2.0 * collision(r), f.i);
    }
    // [rate]
    double friction(double r) const { return pair_.friction * weight_at(pair_.weight, r); }
    /// A of the pair's collision.
    double collision(double r) const { return update_a(pair_.scheme, friction(r) * pair_.step); }
    /// A/step, which is w in continuous time.
    double impulse(double r) const { return pair_.step == 0.0 ? friction(r) : collision(r) / pair_.step; }

    int unknowns() const { return mesh_.nodes() * even_count(); }

    /// The matrix, with or without the odd functions of the highest degree.
    // [matrix]
    void factorize(bool with_highest) {
        std::vector<Eigen::Triplet<double>> entries;
        auto blocks = empty_blocks();
        for (int element = 0; element < mesh_.elements(); ++element) {
            for (auto& block : blocks) block.matrix.setZero();
            for (auto const& point : mesh_.points(element)) {
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

    /// Sources are functions of the velocity times amplitudes amplitude(r). Of a step the solution needs them
    /// times 2/(1 + c), and what the equal factors at the same step would add is taken away (2).
    // [source]
    template <class Amplitude>
    double at_same_step(VelocityFunction f, Amplitude const& amplitude) const {
        double sum = 0.0;
        for_each_point_in_range([&](int, Point const& point) {
            sum += point.volume * pair_.step * square(amplitude(point.r)) / (1.0 + kept(f, point.r));
        });
        return sum;
    }
    double enhanced(VelocityFunction f, double r, double amplitude) const {
        return pair_.step == 0.0 ? amplitude : 2.0 * amplitude / (1.0 + kept(f, r));
    }
    // [source]

    /// A source in the odd function f: its share in the equation of the even functions, and what it
    /// remembers before it streams at all.
    template <class Amplitude>
    std::pair<Eigen::VectorXd, double> odd_source(VelocityFunction f, Amplitude const& amplitude) const {
        Eigen::VectorXd source = Eigen::VectorXd::Zero(unknowns());
        double at_once = 0.0;
        int const o = basis_.odd_index(f.m, f.i, f.p);
        for_each_point_in_range([&](int element, Point const& point) {
            double const a = enhanced(f, point.r, amplitude(point.r)), relaxed = a / rate(f, point.r);
            at_once += point.volume * a * relaxed;
            for (auto const& coupling : basis_.streaming[o])
                add(source, element, coupling.from,
                    -point.volume * speed * relaxed * streamed(coupling, point));
        });
        return {source, at_once};
    }

    /// A source in the even function f, added to `source`.
    template <class Amplitude>
    void add_even_source(Eigen::VectorXd& source, VelocityFunction f, Amplitude const& amplitude) const {
        int const k = basis_.even_index(f.m, f.i, f.p);
        for_each_point_in_range([&](int element, Point const& point) {
            add(source, element, k, point.volume * enhanced(f, point.r, amplitude(point.r)) * point.shape);
        });
    }

private:
    int even_count() const { return static_cast<int>(basis_.even.size()); }

    static ElementVector streamed(Coupling const& coupling, Point const& point) {
        return coupling.slope * point.slope + coupling.rotation / point.r * point.shape;
    }

    template <class Action>
    void for_each_point_in_range(Action const& action) const {
        for (int element = 0; element < mesh_.elements(); ++element)
            for (auto const& point : mesh_.points(element))
                if (point.r < 1.0) action(element, point);
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
    std::vector<std::vector<int>> block_of_;
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> cholesky_;
};

void check(Encounter const& pair, int degree) {
    unit_sphere_surface(pair.d);  // checks d
    for (double const rate : {pair.friction, pair.medium})
        if (!(rate > 0.0) || !std::isfinite(rate))
            throw std::invalid_argument("the frictions of an encounter must be positive and finite");
    if (!(pair.step >= 0.0) || !std::isfinite(pair.step))
        throw std::invalid_argument("the step of an encounter must be zero or positive and finite");
    if (degree < 2 || degree % 2 != 0)
        throw std::invalid_argument("the degree of an encounter must be even and at least 2");
}

Bounds bounds(double one, double other) { return {std::min(one, other), std::max(one, other)}; }

constexpr VelocityFunction u_r{0, 1, 0};      ///< u_r
constexpr VelocityFunction u_r_u_r{0, 2, 0};  ///< (u_r^2 - 1)/2^(1/2)
constexpr VelocityFunction u_r_u_t{1, 1, 0};  ///< u_r u_t, normalized

}  // namespace

// [force memory]
Bounds force_memory(Encounter const& pair, int degree) {
    check(pair, degree);
    EncounterSolver solver(pair, 1, degree);
    auto const f = [&](double r) { return speed * solver.impulse(r); };
    auto const [source, at_once] = solver.odd_source(u_r, f);
    double const same_step = solver.at_same_step(u_r, f);
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
    int const d = pair.d;
    EncounterSolver solver(pair, 2, degree);
    double const size = std::sqrt((d - 1.0) / d);             // of the tensor r^ r^ less its trace
    double const components = 1.0 / ((d - 1.0) * (d + 2.0));  // <T_xy U_xy> = <T:U> times this
    auto const s_along = [&](double r) { return speed * size * solver.impulse(r) * r; };
    auto const B_along = [&](double r) {
        return -4.0 * std::numbers::sqrt2 * size * solver.impulse(r) * (1.0 - solver.collision(r));
    };
    auto const B_across = [&](double r) { return -2.0 * std::sqrt(2.0 * (d - 1.0)) * solver.impulse(r); };
    auto const [s, at_once] = solver.odd_source(u_r, s_along);
    Eigen::VectorXd B = Eigen::VectorXd::Zero(solver.unknowns());
    solver.add_even_source(B, u_r_u_r, B_along);
    solver.add_even_source(B, u_r_u_t, B_across);
    double const s_same_step = solver.at_same_step(u_r, s_along);
    double const B_same_step = solver.at_same_step(u_r_u_r, B_along) + solver.at_same_step(u_r_u_t, B_across);
    // half a step of the medium at either end, of first degree in s and of second in B
    auto const kept = [&](double ends) { return components * std::exp(-ends * pair.medium * pair.step); };
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

}  // namespace dpd::theory
