#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <functional>
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
using Gauss = boost::math::quadrature::gauss<double, 10>;  // holds the nodes >= 0 only

template <class Action>
void for_each_gauss_point(double from, double to, Action const& action) {
    double const half = 0.5 * (to - from);
    for (std::size_t g = 0; g < Gauss::abscissa().size(); ++g)
        for (double const sign : {-1.0, 1.0})
            action(from + half * (1.0 + sign * Gauss::abscissa()[g]), half * Gauss::weights()[g]);
}

// -----------------------------------------------------------------------------------------------------------
// Directions

/// Functions of the velocity of one degree, by their degree across r^: those of a lower degree but for i come
/// first, in the same order.
std::vector<VelocityFunction> of_degree(int d, int rank, int degree) {
    std::vector<VelocityFunction> result;
    for (int across = 0; across <= degree; ++across)
        for (int m = across % 2; m <= std::min(across, highest_m(d, rank)); m += 2)
            result.push_back({m, degree - across, (across - m) / 2});
    return result;
}

/// A function of r^ and of the velocity is a sum of harmonics in r^, of order l: for each l what takes its
/// part from the functions of a degree. Streaming is A+ + A-, to the next degree and the one before, and
/// A- A+ - A+ A- is the Laplacian, in which -l(l + d - 2) stands at 1/r^2.
// [harmonics]
std::vector<Matrix> harmonics(int d, int rank, int degree) {
    auto const here = of_degree(d, rank, degree);
    auto const size = static_cast<Eigen::Index>(here.size());
    Matrix laplacian = Matrix::Zero(size, size);
    auto const add = [&](double sign, std::vector<VelocityFunction> const& between) {
        auto const parts = [&](auto const& from, auto const& to, double Streamed::*part) {
            Matrix result =
                Matrix::Zero(static_cast<Eigen::Index>(to.size()), static_cast<Eigen::Index>(from.size()));
            for (std::size_t column = 0; column < from.size(); ++column)
                for (auto const& streamed : stream(d, rank, from[column]))
                    if (auto const found = std::ranges::find(to, streamed.to); found != to.end())
                        result(found - to.begin(), static_cast<Eigen::Index>(column)) += streamed.*part;
            return result;
        };
        // (slope d/dr + rotation/r) of rotation/r
        laplacian += sign *
                     (parts(between, here, &Streamed::rotation) - parts(between, here, &Streamed::slope)) *
                     parts(here, between, &Streamed::rotation);
    };
    add(1.0, of_degree(d, rank, degree + 1));
    if (degree > 0) add(-1.0, of_degree(d, rank, degree - 1));
    Eigen::SelfAdjointEigenSolver<Matrix> const solver(-laplacian);
    std::vector<Matrix> result(static_cast<std::size_t>(degree + rank + 1), Matrix::Zero(size, size));
    for (Eigen::Index e = 0; e < size; ++e) {
        double const half = 0.5 * (d - 2), value = std::max(solver.eigenvalues()[e], 0.0);
        auto const l = std::lround(std::sqrt(half * half + value) - half);
        Vector const function = solver.eigenvectors().col(e);
        result[static_cast<std::size_t>(l)] += function * function.transpose();
    }
    return result;
}
// [harmonics]

/// A plane wave has, over the volume of the unit sphere, so much of a harmonic.
double bessel(int d, int l, double x) {
    return d == 2 ? boost::math::cyl_bessel_j(l, x) : boost::math::sph_bessel(static_cast<unsigned>(l), x);
}

// -----------------------------------------------------------------------------------------------------------
// Flights

/// How the relative motion in the medium alone goes on, in units of one component of g.
struct Flight {
    double kept;           ///< of a velocity
    double variance;       ///< of the way in one direction
    double with_velocity;  ///< covariance of the way with the velocity at either end
};
/// After a time; of the flights of steps, which have half a step of the medium at either end, sums that
/// depend on the time as smoothly.
// [flight]
Flight flight(double medium, double step, double time) {
    double const per_step = medium * step;
    double const rate = step == 0.0 ? medium : 2.0 / step * std::sinh(0.5 * per_step);
    double const of_steps = step == 0.0 ? 0.0 : (std::sinh(per_step) - per_step) / step;
    double const lost = -std::expm1(-medium * time);
    return {1.0 - lost, 2.0 * ((medium * time - lost) + time * of_steps) / (rate * rate), lost / rate};
}
// [flight]

/// Integrals over time of what a flight makes of the polynomials along a wave vector; `at_degree[e]` has
/// those that lose e velocities across it, too.
struct Flights {
    Flights(double medium, double step, double k, int degree) {
        for (int e = 0; e <= degree; ++e) at_degree.push_back(Matrix::Zero(degree + 1 - e, degree + 1 - e));
        Matrix now(degree + 1, degree + 1);
        constexpr double negligible = 1e-12;
        auto const add = [&](double time, double weight) {
            auto const f = flight(medium, step, time);
            double const amplitude = std::exp(-0.5 * square(speed * k) * f.variance);
            fill(now, f.kept, speed * k * f.with_velocity);
            double share = weight * amplitude;
            for (int e = 0; e <= degree; ++e, share *= f.kept)
                at_degree[static_cast<std::size_t>(e)] +=
                    share * now.topLeftCorner(degree + 1 - e, degree + 1 - e);
            return amplitude > negligible;
        };
        // a flight that turns the wave so little needs no sum
        constexpr double short_flight = 0.05;
        if (k * step > short_flight) {
            for (int j = 1; add(j * step, step); ++j) {
            }
            return;
        }
        bool goes_on = true;
        double width = std::min(1.0 / k, 1.0 / medium);
        for (double from = 0.5 * step; goes_on; from += width, width = std::max(width, from))
            for_each_gauss_point(from, from + width,
                                 [&](double time, double weight) { goes_on = add(time, weight); });
        if (step > 0.0) {  // from the integral to the sum, Euler and Maclaurin
            add(step, step / 24.0);
            add(0.0, -step / 24.0);
        }
    }

    std::vector<Matrix> at_degree;

private:
    /// Polynomials i at first and j later, without the amplitude of the wave; from degree to degree a power
    /// of i, which makes them real.
    // [polynomials in flight]
    static void fill(Matrix& now, double kept, double turned) {
        auto const size = now.rows();
        now.setZero();
        now(0, 0) = 1.0;
        auto const root = [](Eigen::Index i) { return std::sqrt(static_cast<double>(i)); };
        for (Eigen::Index j = 1; j < size; ++j) now(0, j) = -turned / root(j) * now(0, j - 1);
        for (Eigen::Index i = 1; i < size; ++i)
            for (Eigen::Index j = 0; j < size; ++j)
                now(i, j) =
                    (turned * now(i - 1, j) + (j > 0 ? kept * root(j) * now(i - 1, j - 1) : 0.0)) / root(i);
    }
    // [polynomials in flight]
};

constexpr int radial_functions = 6;
using RadialVector = Eigen::Matrix<double, radial_functions, 1>;
using RadialMatrix = Eigen::Matrix<double, radial_functions, radial_functions>;

/// A distance in the range, and the Legendre polynomials there.
struct Distance {
    double r, volume;
    RadialVector functions;
};

std::vector<Distance> distances(int d) {
    constexpr int parts = 12;  // for the shortest wave
    std::vector<Distance> result;
    for (int part = 0; part < parts; ++part)
        for_each_gauss_point(part / double{parts}, (part + 1.0) / parts, [&](double s, double weight) {
            // dense at the edge, where the friction may set in as a root
            double const r = 1.0 - square(1.0 - s), x = 2.0 * r - 1.0;
            Distance here{r, unit_sphere_surface(d) * std::pow(r, d - 1) * 2.0 * (1.0 - s) * weight, {}};
            here.functions[0] = 1.0;
            here.functions[1] = x;
            for (int j = 1; j + 1 < radial_functions; ++j)
                here.functions[j + 1] =
                    ((2.0 * j + 1.0) * x * here.functions[j] - j * here.functions[j - 1]) / (j + 1.0);
            result.push_back(here);
        });
    return result;
}

/// Calls action(k, weight) for an integral over wave numbers of what oscillates with the periods pi and 2 pi
/// of the range's two ends and falls like a power.
template <class Action>
void for_each_wave_number(Action const& action) {
    using std::numbers::pi;
    constexpr int periods = 10;
    std::vector<double> ends{0.0, 0.3 * pi};
    for (int period = 0; period <= periods; period += 2) ends.push_back((period + 1) * pi);
    for (std::size_t part = 0; part + 1 < ends.size(); ++part)
        for_each_gauss_point(ends[part], ends[part + 1], action);
    // beyond, up to three times the wave number, means over both periods
    using Few = boost::math::quadrature::gauss<double, 5>;
    double const last = ends.back(), lowest = 1.0 / 3.0, half = 0.5 * (1.0 - lowest);
    for (std::size_t g = 0; g < Few::abscissa().size(); ++g)
        for (double const sign : {-1.0, 1.0}) {
            if (g == 0 && sign < 0.0) continue;  // the one in the middle
            double const x = 1.0 - half * (1.0 + sign * Few::abscissa()[g]), k = last / x;
            for (double const shift : {-0.75, -0.25, 0.25, 0.75})
                action(k + shift * pi, 0.25 * half * Few::weights()[g] * last / square(x));
        }
}

}  // namespace

/// Functions of r and of the velocity in the range, those that a collision takes something from, in waves.
class FlyingPair::Waves {
public:
    Waves(Encounter const& pair, int rank) : pair_(pair), rank_(rank), distances_(distances(pair.d)) {
        check(pair, 2);
        for_each_wave_number([&](double k, double weight) {
            double const density = unit_sphere_surface(pair_.d) * std::pow(k, pair_.d - 1) /
                                   std::pow(2.0 * std::numbers::pi, pair_.d);
            waves_.push_back({k, weight * density, {}});
        });
        add_degree();
    }

    /// \f$\int_0^\infty dt\,\langle X_0Y_t\rangle\f$ of the signals X, Y, each a sum of sources.
    // [memory of a flying pair]
    Matrix memory(double medium, int degree, std::vector<std::vector<Source>> const& signals) {
        if (medium != medium_) solved_ = 0;
        medium_ = medium;
        while (highest() < degree) add_degree();
        factorize(degree);
        // what collisions take of both is M x and M y; with S for what flights bring to collisions again it
        // is x S y - x S/(M + S) S y = x M y - x M/(M + S) M y
        Matrix sources(size(degree), static_cast<Eigen::Index>(signals.size()));
        for (std::size_t s = 0; s < signals.size(); ++s)
            sources.col(static_cast<Eigen::Index>(s)) = projected(signals[s], degree);
        auto const factor = factor_.topLeftCorner(size(degree), size(degree)).triangularView<Eigen::Lower>();
        Vector const sign = signs(degree);
        Matrix const first = factor.solve(sources), later = factor.solve(sign.asDiagonal() * sources);
        return sources.transpose() * in_functions(sources, degree) -
               first.transpose() * sign.asDiagonal() * later;
    }
    // [memory of a flying pair]

    int d() const { return pair_.d; }

private:
    /// In a wave, the functions of each degree: for a function of the velocity with r^ along k (row) what a
    /// collision makes of a function in the range (column: of the velocity, then of r).
    struct Wave {
        double k, weight;
        std::vector<Matrix> functions;
    };

    int highest() const { return static_cast<int>(first_.size()) - 2; }
    /// Those up to a degree, less one: the constant along r^ is not touched by a collision.
    Eigen::Index size(int degree) const { return first_[static_cast<std::size_t>(degree + 1)]; }
    Eigen::Index first(int degree) const { return first_[static_cast<std::size_t>(degree)]; }

    // [in waves]
    void add_degree() {
        int const degree = static_cast<int>(first_.size()) - 1;
        auto const functions = of_degree(pair_.d, rank_, degree);
        auto const rows = static_cast<Eigen::Index>(functions.size());
        auto const touched =
            std::count_if(functions.begin(), functions.end(), [](auto const& f) { return f.i > 0; });
        first_.push_back(first_.back() + touched * radial_functions);
        // what collisions take; not less than a little, so that nothing is divided by zero
        constexpr double least = 1e-12;
        std::vector<double> taken;
        for (auto const& [r, volume, _] : distances_)
            taken.push_back(std::max(loss(pair_, degree, r), least * loss(pair_, 1, 0.0)));
        taken_.push_back(taken);
        mass_.push_back(RadialMatrix::Zero());
        for (std::size_t q = 0; q < distances_.size(); ++q)
            mass_.back() += distances_[q].volume * taken[q] * distances_[q].functions *
                            distances_[q].functions.transpose();
        auto const parts = harmonics(pair_.d, rank_, degree);
        for (auto& wave : waves_) {
            Matrix in_wave = Matrix::Zero(rows, touched * radial_functions);
            for (int l = (degree + rank_) % 2; l <= degree + rank_; l += 2) {
                // powers of -i, less those that depend on the degrees across k
                double const sign = (degree + rank_ - l) / 2 % 2 == 0 ? 1.0 : -1.0;
                auto const radial = transforms(l, degree, wave.k);
                for (Eigen::Index f = 0; f < touched; ++f)
                    for (Eigen::Index g = 0; g < rows; ++g)
                        in_wave.row(g).segment<radial_functions>(f * radial_functions) +=
                            (functions[static_cast<std::size_t>(g)].i % 2 == 0 ? sign : -sign) *
                            parts[static_cast<std::size_t>(l)](g, f) *
                            radial[static_cast<std::size_t>(functions[static_cast<std::size_t>(f)].i)]
                                .transpose();
            }
            wave.functions.push_back(in_wave);
        }
    }
    // [in waves]

    /// Of the functions of r, times what a collision takes of each order i up to `degree`.
    std::vector<RadialVector> transforms(int l, int degree, double k) const {
        std::vector<RadialVector> result(static_cast<std::size_t>(degree + 1), RadialVector::Zero());
        for (std::size_t q = 0; q < distances_.size(); ++q) {
            RadialVector const share =
                distances_[q].volume * bessel(pair_.d, l, k * distances_[q].r) * distances_[q].functions;
            for (std::size_t i = 0; i < result.size(); ++i) result[i] += taken_[i][q] * share;
        }
        return result;
    }

    /// Rows of S from lower degrees and this one to this one.
    // [flights between collisions]
    Matrix flights_to(int to) const {
        Matrix result = Matrix::Zero(size(to), size(to) - first(to));
        for (auto const& wave : waves_) {
            Flights const flights(medium_, pair_.step, wave.k, to);
            auto const& met = wave.functions[static_cast<std::size_t>(to)];
            for (int from = 1; from <= to; ++from) {
                // those with the same velocities across k
                auto const& sent = wave.functions[static_cast<std::size_t>(from)];
                auto const functions = of_degree(pair_.d, rank_, from);
                Vector weights(sent.rows());
                for (Eigen::Index f = 0; f < sent.rows(); ++f) {
                    int const across = functions[static_cast<std::size_t>(f)].tangential_degree();
                    weights[f] = wave.weight * flights.at_degree[static_cast<std::size_t>(across)](
                                                   from - across, to - across);
                }
                result.middleRows(first(from), sent.cols()).noalias() +=
                    sent.transpose() * (weights.asDiagonal() * met.topRows(sent.rows()));
            }
        }
        return result;
    }
    // [flights between collisions]

    /// Cholesky's factor of M + S degree by degree. By time reversal what is odd and even has the opposite
    /// sign in both directions: with the signs of the rows of odd degrees turned it is symmetric, and of even
    /// degrees positive, of odd ones negative.
    // [factor]
    void factorize(int degree) {
        factor_.conservativeResizeLike(Matrix::Zero(size(degree), size(degree)));
        for (int to = solved_ + 1; to <= degree; solved_ = to++) {
            Eigen::Index const before = first(to), now = size(to) - before;
            Matrix column = signs(to).asDiagonal() * flights_to(to);
            double const sign = to % 2 == 0 ? 1.0 : -1.0;
            for_each_function(to, to, [&](VelocityFunction const& f, Eigen::Index row) {
                column.block<radial_functions, radial_functions>(row, row - before) += sign * mass(f);
            });
            Matrix const left = factor_.topLeftCorner(before, before)
                                    .triangularView<Eigen::Lower>()
                                    .solve(column.topRows(before));
            Matrix const signed_left = signs(to - 1).asDiagonal() * left;
            Eigen::LLT<Matrix> const cholesky(sign *
                                              (column.bottomRows(now) - left.transpose() * signed_left));
            if (cholesky.info() != Eigen::Success)
                throw std::domain_error(
                    "the encounter of two particles could not be solved at these frictions");
            factor_.block(before, 0, now, before) = signed_left.transpose();
            factor_.block(before, before, now, now) = cholesky.matrixL();
        }
    }
    /// Plus for functions of even degree, minus for those of odd.
    Vector signs(int degree) const {
        Vector result = Vector::Ones(size(degree));
        for (int n = 1; n <= degree; n += 2) result.segment(first(n), size(n) - first(n)).setConstant(-1.0);
        return result;
    }
    // [factor]

    /// Calls action(function of the velocity, row) for those of the degrees [from, to].
    template <class Action>
    void for_each_function(int from, int to, Action const& action) const {
        for (int n = from; n <= to; ++n) {
            auto const functions = of_degree(pair_.d, rank_, n);
            for (Eigen::Index row = first(n), f = 0; row < size(n); row += radial_functions, ++f)
                action(functions[static_cast<std::size_t>(f)], row);
        }
    }
    RadialMatrix const& mass(VelocityFunction const& f) const { return mass_[static_cast<std::size_t>(f.i)]; }

    /// A signal by its projections on the functions, M x ...
    Vector projected(std::vector<Source> const& signal, int degree) const {
        Vector result = Vector::Zero(size(degree));
        for_each_function(1, degree, [&](VelocityFunction const& f, Eigen::Index row) {
            for (auto const& source : signal)
                if (source.function == f)
                    for (auto const& [r, volume, functions] : distances_)
                        result.segment<radial_functions>(row) +=
                            volume * source.amplitude(pair_, r) * functions;
        });
        return result;
    }
    /// ... and x.
    Matrix in_functions(Matrix const& signals, int degree) const {
        Matrix result(signals.rows(), signals.cols());
        for_each_function(1, degree, [&](VelocityFunction const& f, Eigen::Index row) {
            result.middleRows<radial_functions>(row) =
                mass(f).llt().solve(signals.middleRows<radial_functions>(row));
        });
        return result;
    }

    Encounter pair_;
    int rank_;
    std::vector<Distance> distances_;
    std::vector<Wave> waves_;
    std::vector<Eigen::Index> first_{0};      ///< row of the first function of each degree
    std::vector<std::vector<double>> taken_;  ///< by collisions, of each order i at each distance
    std::vector<RadialMatrix> mass_;          ///< M, of each order i
    double medium_ = 0.0;
    int solved_ = 0;  ///< highest degree of the factor in this medium
    Matrix factor_;   ///< of M + S
};

FlyingPair::FlyingPair(Encounter const& pair, int rank) : waves_(std::make_unique<Waves>(pair, rank)) {}
FlyingPair::~FlyingPair() = default;

double FlyingPair::force_memory(double medium, int degree) {
    return waves_->memory(medium, degree, {{force_source}})(0, 0);
}

FlyingPair::Stress FlyingPair::stress_memory(double medium, int degree) {
    Matrix const memory =
        xy_share(waves_->d()) *
        waves_->memory(medium, degree, {{stress_source}, {relaxation_along, relaxation_across}});
    return {memory(0, 0), memory(1, 1), memory(0, 1)};
}

}  // namespace dpd::theory
