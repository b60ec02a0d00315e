#include <Eigen/Dense>
#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "encounter_basis.hpp"

namespace dpd::theory {

using namespace encounter;

/// Matrices of one step between all functions of r and of the velocity. A function is a polynomial of the
/// velocity, even or odd, times a finite element; the elements are made orthonormal, so that the matrix of
/// what is kept is a matrix in r for each polynomial.
class StepEncounter::Steps {
public:
    Steps(Encounter const& pair, int rank, int degree)
        : pair_(pair), rank_(rank), mesh_(pair.d, elements_inside, outermost) {
        check(pair, degree);
        if (!(pair.step > 0.0)) throw std::invalid_argument("the step must be positive");
        for (int m = 0; m <= highest_m(pair.d, rank); ++m)
            for (int p = 0; 2 * p + m <= degree; ++p)
                for (int i = 0; i + 2 * p + m <= degree; ++i) functions_.push_back({m, i, p});
        for (auto const& [m, i, p] : functions_) {
            double const half = 0.5 * (pair.d - 1), a = laguerre_index(pair.d, m);
            norms_.push_back(std::sqrt(std::pow(0.5, m) * std::tgamma(p + 1.0) * std::tgamma(half) /
                                       std::tgamma(p + a + 1.0)));
        }
        if (rank == 1)
            signals_ = {{force_source}};
        else
            signals_ = {{stress_source}, {relaxation_along, relaxation_across}};
        drift_ = Eigen::MatrixXd::Zero(size(), size());
        received_ = Eigen::MatrixXd::Zero(size(), signal_count());
        next_ = Eigen::MatrixXd::Zero(signal_count(), signal_count());
        for (int element = 0; element < mesh_.elements(); ++element) drift_from(element);
        make_orthonormal();
    }

    /// \f$\Delta t\sum_{j\ge1}\langle X_0Y_j\rangle\f$ of the signals `from` and `to` in a medium, less the
    /// ends: the first step, and behind it the geometric series of what is kept and drifts, summed as a
    /// linear system.
    // [sum over steps]
    Eigen::MatrixXd memory(double medium) const {
        constexpr double tolerance = 1e-7;
        Eigen::MatrixXd const kept_drift = keep(drift_, medium), kept_received = keep(received_, medium);
        Eigen::MatrixXd const system = Eigen::MatrixXd::Identity(size(), size()) - kept_drift;
        Eigen::BiCGSTAB<Eigen::MatrixXd, Eigen::IdentityPreconditioner> solver(system);
        solver.setTolerance(tolerance);
        Eigen::MatrixXd sum = next_;
        for (int to = 0; to < signal_count(); ++to) {
            Eigen::VectorXd const all = solver.solve(kept_received.col(to));
            if (solver.info() != Eigen::Success)
                throw std::domain_error(
                    "the encounter of two particles could not be solved at these frictions");
            for (int from = 0; from < signal_count(); ++from) sum(from, to) += sent(from).dot(all);
        }
        return pair_.step * sum;
    }
    // [sum over steps]

    double step() const { return pair_.step; }
    int d() const { return pair_.d; }

private:
    static constexpr int elements_inside = 5;
    static constexpr double outermost = 10.0;

    int function_count() const { return static_cast<int>(functions_.size()); }
    int signal_count() const { return static_cast<int>(signals_.size()); }
    int size() const { return function_count() * mesh_.nodes(); }

    /// What a collision and the medium leave of columns of functions.
    Eigen::MatrixXd keep(Eigen::MatrixXd const& columns, double medium) const {
        Eigen::MatrixXd result(columns.rows(), columns.cols());
        for (int f = 0; f < function_count(); ++f)
            result.middleRows(f * mesh_.nodes(), mesh_.nodes()).noalias() =
                std::exp(-medium * pair_.step * functions_[f].degree()) *
                (kept_[functions_[f].i] * columns.middleRows(f * mesh_.nodes(), mesh_.nodes()));
        return result;
    }

    /// What a signal sends into the drift: by time reversal what it receives, with a sign for odd and even.
    Eigen::VectorXd sent(int signal) const {
        Eigen::VectorXd result = received_.col(signal);
        int const parity = signals_[signal].front().function.degree();
        for (int f = 0; f < function_count(); ++f)
            if ((functions_[f].degree() + parity) % 2 == 1)
                result.segment(f * mesh_.nodes(), mesh_.nodes()) *= -1.0;
        return result;
    }

    /// The polynomials at a velocity.
    Eigen::RowVectorXd polynomials(double along, double across) const {
        Eigen::RowVectorXd values(function_count());
        double const x = 0.5 * square(across);
        for (int f = 0; f < function_count(); ++f) {
            auto const [m, i, p] = functions_[f];
            double const a = laguerre_index(pair_.d, m);
            double hermite = 1.0, before = 0.0;
            for (int n = 0; n < i; ++n)
                before =
                    std::exchange(hermite, (along * hermite - std::sqrt(n) * before) / std::sqrt(n + 1.0));
            double laguerre = 1.0, laguerre_before = 0.0;
            for (int n = 0; n < p; ++n)
                laguerre_before = std::exchange(
                    laguerre, ((2.0 * n + 1.0 + a - x) * laguerre - (n + a) * laguerre_before) / (n + 1.0));
            values[f] = hermite * laguerre * norms_[f];
            for (int n = 0; n < m; ++n) values[f] *= across;
        }
        return values;
    }

    /// Scalar product of the tensors of r^ and m factors u_t with those of r^' and m', which are turned by an
    /// angle.
    // [turned]
    double turned(int m, int other, double angle) const {
        double const c = std::cos(angle), s = std::sin(angle);
        double const sign = other > m && (other - m) % 2 == 1 ? -1.0 : 1.0;
        int const low = std::min(m, other), high = std::max(m, other);
        if (rank_ == 1) return low == high ? c : sign * s;
        if (pair_.d == 2) return low == high ? c * c - s * s : sign * 2.0 * s * c;
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
    Eigen::MatrixXd flight(double r, double r_after) const {
        using Gauss = boost::math::quadrature::gauss<double, 30>;  // holds the nodes >= 0 only
        int const d = pair_.d, points = 2 * static_cast<int>(Gauss::abscissa().size());
        double const length = speed * pair_.step;
        double const widest = 0.5 * reach * length / std::sqrt(r * r_after);
        double const half = widest < 1.0 ? std::asin(widest) : 0.5 * std::numbers::pi;
        Eigen::MatrixXd before(points, function_count()), after(points, function_count());
        Eigen::VectorXd angles(points), weights(points);
        for (int k = 0; k < points; ++k) {
            auto const g = static_cast<std::size_t>(k / 2);
            double const angle = half * (1.0 + (k % 2 ? -1.0 : 1.0) * Gauss::abscissa()[g]);
            double const c = std::cos(angle), s = std::sin(angle);
            double const along = (r_after * c - r) / length, across = r_after * s / length;
            before.row(k) = polynomials(along, across);
            after.row(k) = polynomials((r_after - r * c) / length, r * s / length);
            angles[k] = angle;
            weights[k] = half * Gauss::weights()[g] * (d == 2 ? 2.0 : 2.0 * std::numbers::pi * s) *
                         std::exp(-0.5 * (square(along) + square(across))) /
                         std::pow(std::sqrt(2.0 * std::numbers::pi) * length, d);
        }
        Eigen::MatrixXd result(function_count(), function_count());
        for_each_m([&](int m, int first, int count) {
            for_each_m([&](int other, int first_other, int count_other) {
                Eigen::VectorXd weighted = weights;
                for (int k = 0; k < points; ++k) weighted[k] *= turned(m, other, angles[k]);
                result.block(first, first_other, count, count_other).noalias() =
                    before.middleCols(first, count).transpose() *
                    (weighted.asDiagonal() * after.middleCols(first_other, count_other));
            });
        });
        return result;
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

    int index(VelocityFunction const& f) const {
        auto const found = std::ranges::find_if(
            functions_, [&](VelocityFunction const& g) { return g.m == f.m && g.i == f.i && g.p == f.p; });
        return static_cast<int>(found - functions_.begin());
    }

    /// Of a signal, the values of its parts at r, by polynomial.
    Eigen::VectorXd amplitudes(int signal, double r) const {
        Eigen::VectorXd result = Eigen::VectorXd::Zero(function_count());
        if (r < 1.0)
            for (auto const& part : signals_[signal])
                result[index(part.function)] += part.amplitude(pair_, r);
        return result;
    }

    /// Everything that leaves from an element.
    void drift_from(int element) {
        double const longest = reach * speed * pair_.step;
        int const F = function_count();
        for (auto const& from : mesh_.points(element))
            for (int other = 0; other < mesh_.elements(); ++other) {
                double const low = std::max(mesh_.start(other), from.r - longest);
                double const high = std::min(mesh_.end(other), from.r + longest);
                if (high <= low) continue;
                // parts of the flight that the rule resolves
                int const parts = static_cast<int>(std::ceil((high - low) / (panel * speed * pair_.step)));
                std::vector<Eigen::MatrixXd> sums(order + 1, Eigen::MatrixXd::Zero(F, F));
                for (int part = 0; part < parts; ++part)
                    for (auto const& to : mesh_.points(other, low + (high - low) * part / parts,
                                                       low + (high - low) * (part + 1) / parts)) {
                        double const share = from.volume * to.volume / unit_sphere_surface(pair_.d);
                        Eigen::MatrixXd const moved = share * flight(from.r, to.r);
                        for (int b = 0; b <= order; ++b) sums[b].noalias() += to.shape[b] * moved;
                        receive(element, from, to, moved);
                    }
                for (int a = 0; a <= order; ++a)
                    for (int b = 0; b <= order; ++b) {
                        int const row = element * order + a, column = other * order + b;
                        if (row >= mesh_.nodes() || column >= mesh_.nodes()) continue;
                        for (int f = 0; f < F; ++f)
                            for (int g = 0; g < F; ++g)
                                drift_(f * mesh_.nodes() + row, g * mesh_.nodes() + column) +=
                                    from.shape[a] * sums[b](f, g);
                    }
            }
    }

    /// What the signals get from there.
    void receive(int element, Point const& from, Point const& to, Eigen::MatrixXd const& moved) {
        if (to.r >= 1.0) return;
        for (int signal = 0; signal < signal_count(); ++signal) {
            Eigen::VectorXd const got = moved * amplitudes(signal, to.r);
            for (int a = 0; a <= order; ++a)
                if (int const row = element * order + a; row < mesh_.nodes())
                    for (int f = 0; f < function_count(); ++f)
                        received_(f * mesh_.nodes() + row, signal) += from.shape[a] * got[f];
            for (int sender = 0; sender < signal_count(); ++sender)
                next_(sender, signal) += amplitudes(sender, from.r).dot(got);
        }
    }

    void make_orthonormal() {
        int const nodes = mesh_.nodes(), degree = highest_order();
        auto const radial = [&](auto const& weight) {
            Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(nodes, nodes);
            for (int element = 0; element < mesh_.elements(); ++element)
                for (auto const& point : mesh_.points(element))
                    for (int a = 0; a <= order; ++a)
                        for (int b = 0; b <= order; ++b)
                            if (int const row = element * order + a, column = element * order + b;
                                row < nodes && column < nodes)
                                matrix(row, column) +=
                                    point.volume * weight(point.r) * point.shape[a] * point.shape[b];
            return matrix;
        };
        Eigen::MatrixXd const mass = radial([](double) { return 1.0; });
        Eigen::MatrixXd const lower = Eigen::LLT<Eigen::MatrixXd>(mass).matrixL();
        auto const triangle = lower.triangularView<Eigen::Lower>();
        auto const both = [&](Eigen::MatrixXd const& matrix) -> Eigen::MatrixXd {
            Eigen::MatrixXd const left = triangle.solve(matrix);
            return triangle.solve(left.transpose()).transpose();
        };
        for (int i = 0; i <= degree; ++i)
            kept_.push_back(both(radial([&](double r) { return 1.0 - pair_.step * loss(pair_, i, r); })));
        for (int f = 0; f < function_count(); ++f) {
            auto rows = received_.middleRows(f * nodes, nodes);
            rows = triangle.solve(rows).eval();
            for (int g = 0; g < function_count(); ++g) {
                auto block = drift_.block(f * nodes, g * nodes, nodes, nodes);
                block = both(block);
            }
        }
    }

    int highest_order() const { return std::ranges::max_element(functions_, {}, &VelocityFunction::i)->i; }

    static constexpr double reach = 8.0;  ///< longest flight, in thermal flights
    static constexpr double panel = 3.0;  ///< what the rule of ten points resolves, in thermal flights

    Encounter pair_;
    int rank_;
    RadialMesh mesh_;
    std::vector<VelocityFunction> functions_;
    std::vector<double> norms_;
    std::vector<std::vector<Source>> signals_;
    Eigen::MatrixXd drift_;              ///< of all functions, by polynomial, then node
    Eigen::MatrixXd received_;           ///< of a function by each signal after a drift
    Eigen::MatrixXd next_;               ///< of a signal by each, a step later
    std::vector<Eigen::MatrixXd> kept_;  ///< by a collision, of each order in u_r
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
    Eigen::MatrixXd const memory = steps_->memory(medium);
    return {kept(1.0) * memory(0, 0), kept(2.0) * memory(1, 1), kept(1.5) * memory(0, 1)};
}

}  // namespace dpd::theory
