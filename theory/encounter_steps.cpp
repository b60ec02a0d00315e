#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "encounter_basis.hpp"

namespace dpd::theory {

using namespace encounter;

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// What the drift of one step does to all functions of r and of the velocity. A function is a polynomial of
/// the velocity, even or odd, times a finite element, which may jump where the range ends; the elements are
/// made orthonormal. Whatever happens in the range, the drift is the same.
class Drift {
public:
    Drift(int d, int rank, double step, int degree)
        : d_(d), rank_(rank), degree_(degree), length_(speed * step), mesh_(d, elements_inside, outermost) {
        for (int m = 0; m <= highest_m(d, rank); ++m)
            for (int p = 0; 2 * p + m <= degree; ++p)
                for (int i = 0; i + 2 * p + m <= degree; ++i) functions_.push_back({m, i, p});
        for (auto const& [m, i, p] : functions_) {
            double const half = 0.5 * (d - 1), a = laguerre_index(d, m);
            norms_.push_back(std::sqrt(std::pow(0.5, m) * std::tgamma(p + 1.0) * std::tgamma(half) /
                                       std::tgamma(p + a + 1.0)));
        }
        matrix_ = Matrix::Zero(size(), size());
        for (int element = 0; element < mesh_.elements(); ++element)
            for (int other = element; other < mesh_.elements(); ++other) drift_between(element, other);
        make_orthonormal();
    }

    std::vector<VelocityFunction> const& functions() const { return functions_; }
    int degree() const { return degree_; }
    /// Functions of r, of which the first lie in the range.
    int nodes() const { return mesh_.nodes() + 1; }
    static constexpr int inside() { return elements_inside * order + 1; }
    /// Row of a polynomial's first function of r.
    int row(std::size_t function) const { return static_cast<int>(function) * nodes(); }
    int size() const { return row(functions_.size()); }

    /// From functions to functions, by polynomial, then node.
    Matrix const& matrix() const { return matrix_; }

    /// Share of the functions of r in the range in f, and their matrix of f.
    template <class F>
    Vector projected(F const& f) const {
        Vector result = Vector::Zero(inside());
        for_each_point_inside([&](int first, Point const& point) {
            result.segment<order + 1>(first) += point.volume * f(point.r) * point.shape;
        });
        return lower_.triangularView<Eigen::Lower>().solve(result);
    }
    template <class F>
    Matrix multiplied(F const& f) const {
        Matrix result = Matrix::Zero(inside(), inside());
        for_each_point_inside([&](int first, Point const& point) {
            result.block<order + 1, order + 1>(first, first) +=
                point.volume * f(point.r) * point.shape * point.shape.transpose();
        });
        return between_orthonormal(result, lower_, lower_);
    }

private:
    static constexpr int largest_degree = 20;
    static constexpr int elements_inside = 5;
    static constexpr double outermost = 6.0;
    static constexpr double reach = 7.0;  ///< longest flight, in thermal flights
    static constexpr double panel = 3.0;  ///< what the rule of ten points resolves, in thermal flights

    int function_count() const { return static_cast<int>(functions_.size()); }

    /// First function of r of an element.
    static int first_node(int element) { return element * order + (element < elements_inside ? 0 : 1); }

    template <class Action>
    void for_each_point_inside(Action const& action) const {
        for (int element = 0; element < elements_inside; ++element)
            for (auto const& point : mesh_.points(element)) action(first_node(element), point);
    }

    /// The polynomials at a velocity, into a row.
    template <class Row>
    void polynomials(double along, double across, Row&& row) const {
        std::array<double, largest_degree + 1> hermite{1.0};
        for (int n = 0; n < degree_; ++n)
            hermite[n + 1] =
                (along * hermite[n] - (n > 0 ? std::sqrt(n) * hermite[n - 1] : 0.0)) / std::sqrt(n + 1.0);
        double const x = 0.5 * square(across);
        double power = 1.0, laguerre = 1.0, before = 0.0;
        for (int f = 0; f < function_count(); ++f) {
            auto const [m, i, p] = functions_[f];
            if (i == 0) {  // of each m come p = 0, 1, ..., of each p come i = 0, 1, ...
                double const a = laguerre_index(d_, m);
                if (p == 0) {
                    if (m > 0) power *= across;
                    laguerre = 1.0, before = 0.0;
                } else
                    before = std::exchange(laguerre,
                                           ((2.0 * p - 1.0 + a - x) * laguerre - (p - 1.0 + a) * before) / p);
            }
            row[f] = hermite[i] * laguerre * power * norms_[f];
        }
    }

    /// Scalar product of the tensors of r^ and m factors u_t with those of r^' and m', which are turned by an
    /// angle.
    // [turned]
    double turned(int m, int other, double angle) const {
        double const c = std::cos(angle), s = std::sin(angle);
        double const sign = other > m && (other - m) % 2 == 1 ? -1.0 : 1.0;
        int const low = std::min(m, other), high = std::max(m, other);
        if (rank_ == 1) return low == high ? c : sign * s;
        if (d_ == 2) return low == high ? c * c - s * s : sign * 2.0 * s * c;
        if (low == 0 && high == 0) return 1.5 * c * c - 0.5;
        if (low == 0 && high == 1) return sign * std::sqrt(3.0) * s * c;
        if (low == 0) return 0.5 * std::sqrt(3.0) * s * s;
        if (low == 1 && high == 1) return c * c - s * s;
        if (low == 1) return sign * s * c;
        return 0.5 * (c * c + 1.0);
    }
    // [turned]

    /// \f$\int d\mathbf r'\,\varphi_a(\mathbf r,\mathbf g)\varphi_b(\mathbf r',\mathbf g)\f$ over all
    /// directions of a flight from r to r', weighted as the Maxwell distribution of g = (r' - r)/step.
    // [flight]
    void flight(double r, double r_after, Matrix& result) const {
        using Gauss = boost::math::quadrature::gauss<double, 30>;  // holds the nodes >= 0 only
        constexpr int points = 30;
        double const widest = 0.5 * reach * length_ / std::sqrt(r * r_after);
        double const half = widest < 1.0 ? std::asin(widest) : 0.5 * std::numbers::pi;
        Matrix before(function_count(), points), after(function_count(), points);
        Vector angles(points), weights(points);
        for (int k = 0; k < points; ++k) {
            auto const g = static_cast<std::size_t>(k / 2);
            double const angle = half * (1.0 + (k % 2 ? -1.0 : 1.0) * Gauss::abscissa()[g]);
            double const c = std::cos(angle), s = std::sin(angle);
            double const along = (r_after * c - r) / length_, across = r_after * s / length_;
            polynomials(along, across, before.col(k));
            polynomials((r_after - r * c) / length_, r * s / length_, after.col(k));
            angles[k] = angle;
            weights[k] = half * Gauss::weights()[g] * (d_ == 2 ? 2.0 : 2.0 * std::numbers::pi * s) *
                         std::exp(-0.5 * (square(along) + square(across))) /
                         std::pow(std::sqrt(2.0 * std::numbers::pi) * length_, d_);
        }
        for_each_m([&](int m, int first, int count) {
            for_each_m([&](int other, int first_other, int count_other) {
                Vector weighted = weights;
                for (int k = 0; k < points; ++k) weighted[k] *= turned(m, other, angles[k]);
                result.block(first, first_other, count, count_other).noalias() =
                    before.middleRows(first, count) *
                    (after.middleRows(first_other, count_other) * weighted.asDiagonal()).transpose();
            });
        });
    }
    // [flight]

    template <class Action>
    void for_each_m(Action const& action) const {
        for (int first = 0; first < function_count();) {
            int const m = functions_[first].m;
            int count = 0;
            while (first + count < function_count() && functions_[first + count].m == m) ++count;
            action(m, first, count);
            first += count;
        }
    }

    /// From an element to one that does not lie further in, and by time reversal back.
    void drift_between(int element, int other) {
        double const longest = reach * length_;
        if (mesh_.start(other) - mesh_.end(element) > longest) return;
        int const F = function_count();
        std::vector<Matrix> shares((order + 1) * (order + 1), Matrix::Zero(F, F));
        std::vector<Matrix> sums(order + 1);
        Matrix moved(F, F);
        for (auto const& from : mesh_.points(element)) {
            double const low = std::max(mesh_.start(other), from.r - longest);
            double const high = std::min(mesh_.end(other), from.r + longest);
            if (high <= low) continue;
            // parts of the flight that the rule resolves
            int const parts = static_cast<int>(std::ceil((high - low) / (panel * length_)));
            for (auto& sum : sums) sum.setZero(F, F);
            for (int part = 0; part < parts; ++part)
                for (auto const& to : mesh_.points(other, low + (high - low) * part / parts,
                                                   low + (high - low) * (part + 1) / parts)) {
                    flight(from.r, to.r, moved);
                    double const share = from.volume * to.volume / unit_sphere_surface(d_);
                    for (int b = 0; b <= order; ++b) sums[b] += (share * to.shape[b]) * moved;
                }
            for (int a = 0; a <= order; ++a)
                for (int b = 0; b <= order; ++b) shares[a * (order + 1) + b] += from.shape[a] * sums[b];
        }
        for (int a = 0; a <= order; ++a)
            for (int b = 0; b <= order; ++b) {
                int const r = first_node(element) + a, c = first_node(other) + b;
                if (r >= nodes() || c >= nodes()) continue;
                for (int g = 0; g < F; ++g)
                    for (int f = 0; f < F; ++f) {
                        double const share = shares[a * (order + 1) + b](f, g);
                        matrix_(row(f) + r, row(g) + c) += share;
                        bool const odd = (functions_[f].degree() + functions_[g].degree()) % 2 == 1;
                        if (other > element) matrix_(row(g) + c, row(f) + r) += odd ? -share : share;
                    }
            }
    }

    static Matrix between_orthonormal(Matrix const& matrix, Matrix const& left, Matrix const& right) {
        Matrix const half = left.triangularView<Eigen::Lower>().solve(matrix);
        return right.triangularView<Eigen::Lower>().solve(half.transpose()).transpose();
    }

    void make_orthonormal() {
        Matrix mass = Matrix::Zero(nodes(), nodes());
        for (int element = 0; element < mesh_.elements(); ++element)
            for (auto const& point : mesh_.points(element))
                for (int a = 0; a <= order; ++a)
                    for (int b = 0; b <= order; ++b)
                        if (int const r = first_node(element) + a, c = first_node(element) + b;
                            r < nodes() && c < nodes())
                            mass(r, c) += point.volume * point.shape[a] * point.shape[b];
        Matrix const lower = Eigen::LLT<Matrix>(mass).matrixL();
        lower_ = lower.topLeftCorner(inside(), inside());
        for (int f = 0; f < function_count(); ++f)
            for (int g = 0; g < function_count(); ++g) {
                auto block = matrix_.block(row(f), row(g), nodes(), nodes());
                block = between_orthonormal(block, lower, lower);
            }
    }

    int d_, rank_, degree_;
    double length_;  ///< thermal flight
    RadialMesh mesh_;
    std::vector<VelocityFunction> functions_;
    std::vector<double> norms_;
    Matrix matrix_;
    Matrix lower_;  ///< of the functions in the range the factor of their scalar products
};

/// Whoever asks for many frictions at one step has its drift made once.
std::shared_ptr<Drift const> drift_of(int d, int rank, double step, int degree) {
    thread_local std::pair<int, double> known_for;
    thread_local std::map<std::pair<int, int>, std::shared_ptr<Drift const>> known;
    if (std::pair const asked{d, step}; known_for != asked) {
        known.clear();
        known_for = asked;
    }
    auto& drift = known[{rank, degree}];
    if (!drift) drift = std::make_shared<Drift const>(d, rank, step, degree);
    return drift;
}

/// x with x - map(x) = b, in the space of b, map(b), map(map(b)), ... as soon as it holds what is wanted
/// (GMRES).
template <class Map>
Vector solved(Map const& map, Vector const& b) {
    constexpr double wanted = 1e-7;
    constexpr int longest = 400;
    double const size = b.norm();
    if (size == 0.0) return b;
    Matrix basis(b.size(), 1);
    basis.col(0) = b / size;
    Matrix hessenberg;
    for (int k = 1; k <= longest; ++k) {
        Vector next = basis.col(k - 1) - map(basis.col(k - 1));
        hessenberg.conservativeResizeLike(Matrix::Zero(k + 1, k));
        for (int repeat = 0; repeat < 2; ++repeat) {  // of orthogonalization, for digits
            Vector const share = basis.transpose() * next;
            hessenberg.col(k - 1).head(k) += share;
            next -= basis * share;
        }
        double const left = next.norm();
        hessenberg(k, k - 1) = left;
        Vector const target = size * Vector::Unit(k + 1, 0);
        Vector const shares = hessenberg.householderQr().solve(target);
        if ((hessenberg * shares - target).norm() < wanted * size) return basis * shares;
        basis.conservativeResize(Eigen::NoChange, k + 1);
        basis.col(k) = next / left;
    }
    throw std::domain_error("the encounter of two particles could not be solved at these frictions");
}

}  // namespace

/// The drift, and what collisions of a pair at a step do between two of them.
class StepEncounter::Steps {
public:
    Steps(Encounter const& pair, int rank, int degree) : pair_(pair) {
        check(pair, degree);
        if (!(pair.step > 0.0)) throw std::invalid_argument("the step must be positive");
        drift_ = drift_of(pair.d, rank, pair.step, degree);
        for (int i = 0; i <= degree; ++i)
            kept_.push_back(
                drift_->multiplied([&](double r) { return 1.0 - pair_.step * loss(pair_, i, r); }));
        if (rank == 1)
            signals_ = {{force_source}};
        else
            signals_ = {{stress_source}, {relaxation_along, relaxation_across}};
        sent_ = Matrix::Zero(drift_->size(), signal_count());
        for (int signal = 0; signal < signal_count(); ++signal)
            for (auto const& part : signals_[signal])
                sent_.col(signal).segment(drift_->row(index(part.function)), Drift::inside()) +=
                    drift_->projected([&](double r) { return part.amplitude(pair_, r); });
        received_ = drift_->matrix() * sent_;
    }

    /// \f$\Delta t\sum_{j\ge1}\langle X_0Y_j\rangle\f$ of the signals X, Y in a medium, less the ends: the
    /// first step, and behind it the geometric series of what is kept and drifts, summed as a linear system.
    // [sum over steps]
    Matrix memory(double medium) const {
        Matrix sum = sent_.transpose() * received_;
        auto const step = [&](Vector const& x) { return keep(drift_->matrix() * x, medium); };
        for (int to = 0; to < signal_count(); ++to) {
            Vector const all = solved(step, keep(received_.col(to), medium));
            for (int from = 0; from < signal_count(); ++from) sum(from, to) += reversed(from).dot(all);
        }
        return pair_.step * sum;
    }
    // [sum over steps]

    double step() const { return pair_.step; }
    int d() const { return pair_.d; }

private:
    int signal_count() const { return static_cast<int>(signals_.size()); }

    std::size_t index(VelocityFunction const& f) const {
        auto const found = std::ranges::find_if(drift_->functions(), [&](VelocityFunction const& g) {
            return g.m == f.m && g.i == f.i && g.p == f.p;
        });
        return static_cast<std::size_t>(found - drift_->functions().begin());
    }

    /// What a collision and the medium leave of functions.
    Vector keep(Vector functions, double medium) const {
        for (std::size_t f = 0; f < drift_->functions().size(); ++f) {
            auto const& function = drift_->functions()[f];
            auto inside = functions.segment(drift_->row(f), Drift::inside());
            inside = (kept_[static_cast<std::size_t>(function.i)] * inside).eval();
            functions.segment(drift_->row(f), drift_->nodes()) *=
                std::exp(-medium * pair_.step * function.degree());
        }
        return functions;
    }

    /// What a signal sends into the drift: by time reversal what it receives, with a sign for odd and even.
    Vector reversed(int signal) const {
        Vector result = received_.col(signal);
        int const parity = signals_[static_cast<std::size_t>(signal)].front().function.degree();
        for (std::size_t f = 0; f < drift_->functions().size(); ++f)
            if ((drift_->functions()[f].degree() + parity) % 2 == 1)
                result.segment(drift_->row(f), drift_->nodes()) *= -1.0;
        return result;
    }

    Encounter pair_;
    std::shared_ptr<Drift const> drift_;
    std::vector<std::vector<Source>> signals_;
    Matrix sent_;               ///< by each signal, the share of the functions
    Matrix received_;           ///< of a function by each signal after a drift
    std::vector<Matrix> kept_;  ///< by a collision, of each order in u_r, in the range
};

StepEncounter::StepEncounter(Encounter const& pair, int rank, int degree)
    : steps_(std::make_unique<Steps>(pair, rank, degree)) {}
StepEncounter::~StepEncounter() = default;
StepEncounter::StepEncounter(StepEncounter&&) noexcept = default;
StepEncounter& StepEncounter::operator=(StepEncounter&&) noexcept = default;

double StepEncounter::force_memory(double medium) const {
    return std::exp(-medium * steps_->step()) * steps_->memory(medium)(0, 0);
}

StepEncounter::Stress StepEncounter::stress_memory(double medium) const {
    auto const kept = [&](double ends) {
        return xy_share(steps_->d()) * std::exp(-ends * medium * steps_->step());
    };
    Matrix const memory = steps_->memory(medium);
    return {kept(1.0) * memory(0, 0), kept(2.0) * memory(1, 1), kept(1.5) * memory(0, 1)};
}

}  // namespace dpd::theory
