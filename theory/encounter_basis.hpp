/// @file
/// What both solvers of the encounter share (encounter.cpp, encounter_flights.cpp): polynomials of the
/// velocity, finite elements in the distance, and what a collision takes. Not installed.
#pragma once

#include <Eigen/Dense>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "encounter.hpp"
#include "integrals.hpp"

namespace dpd::theory::encounter {

/// Thermal speed of one component of g, whose variance is 2.
constexpr double speed = std::numbers::sqrt2;

/// A polynomial in the velocity u = g/speed: Hermite of order i along r^, and across it the m-th power of
/// u_t times Laguerre of order p in u_t^2/2, all orthonormal under the Maxwell distribution.
struct VelocityFunction {
    int m;  ///< power of u_t
    int i;  ///< order of the Hermite polynomial along r^
    int p;  ///< order of the Laguerre polynomial in u_t^2/2
    /// Degree in u_t.
    int tangential_degree() const { return 2 * p + m; }
    /// Degree in u.
    int degree() const { return i + tangential_degree(); }
    bool operator==(VelocityFunction const&) const = default;
};

constexpr VelocityFunction one{0, 0, 0};
constexpr VelocityFunction u_r{0, 1, 0};      ///< u_r
constexpr VelocityFunction u_t{1, 0, 0};      ///< u_t, normalized
constexpr VelocityFunction u_r_u_r{0, 2, 0};  ///< (u_r^2 - 1)/2^(1/2)
constexpr VelocityFunction u_r_u_t{1, 1, 0};  ///< u_r u_t, normalized

/// Index of the Laguerre polynomials.
inline double laguerre_index(int d, int m) { return 0.5 * (d - 1) + m - 1; }
/// Highest power of u_t in a tensor of that rank.
inline int highest_m(int d, int rank) { return d == 2 ? std::min(rank, 1) : rank; }

/// What streaming makes of a function, in another: slope d/dr + rotation/r + pushed (mean force).
struct Streamed {
    VelocityFunction to;             ///< the other
    double slope, rotation, pushed;  ///< shares
};
/// u.grad of a function that turns with r^ like a tensor of that rank.
std::vector<Streamed> stream(int d, int rank, VelocityFunction const& function);

/// Share of an even function in what streaming makes of it in an odd one, as in Streamed.
struct Coupling {
    int from;                        ///< index of the even function
    double slope, rotation, pushed;  ///< shares
};

/// Functions of the velocity that turn with r^ like a tensor of a rank from 0 to 2, up to a degree: the even
/// ones up to `degree`, the odd ones up to degree + 1, which are all that streaming makes of the even.
class VelocityBasis {
public:
    /// `rank` of the tensor, `degree` even.
    VelocityBasis(int d, int rank, int degree);

    /// Index in a list, or -1.
    static int index_in(std::vector<VelocityFunction> const& list, VelocityFunction const& f);
    /// Among the even functions.
    int even_index(VelocityFunction const& f) const { return index_in(even, f); }
    /// Among the odd ones.
    int odd_index(VelocityFunction const& f) const { return index_in(odd, f); }

    std::vector<VelocityFunction> even;            ///< functions of even degree
    std::vector<VelocityFunction> odd;             ///< functions of odd degree
    std::vector<std::vector<Coupling>> streaming;  ///< of each odd function
};

/// Throws std::invalid_argument for what has no meaning.
void check(Encounter const& pair, int degree);

/// A source of a correlation: a function of the velocity times an amplitude that depends on r.
struct Source {
    VelocityFunction function;                                         ///< of the velocity
    std::function<double(Encounter const& pair, double r)> amplitude;  ///< at a distance
};
/// w r^.g, and its tensor's norm is 1.
extern Source const force_source;
/// s, and B in its two parts; both in units of their tensors, of which \f$\langle T_{xy}U_{xy}\rangle=\langle
/// T:U\rangle\f$ xy_share(d).
extern Source const stress_source, relaxation_along, relaxation_across;
double xy_share(int d);
/// Norm of the tensor r^ r^ less its trace.
double tensor_size(int d);

constexpr int order = 4;  ///< of the polynomials in r on an element
using ElementVector = Eigen::Matrix<double, order + 1, 1>;
using ElementMatrix = Eigen::Matrix<double, order + 1, order + 1>;

/// A quadrature point of an element: r, its share of the volume, and the shape functions and their slopes.
struct Point {
    double r;                 ///< distance
    double volume;            ///< its share of the volume
    ElementVector shape;      ///< values of the shape functions
    ElementVector slope;      ///< their derivatives by r
    double mean_force = 0.0;  ///< d ln g/dr
};

/// Value and slope of the Lagrange polynomials through Chebyshev's points of [0, 1].
std::pair<ElementVector, ElementVector> shape_functions(double x);

constexpr int elements_inside = 8;  ///< of the range, for an ideal gas
constexpr double mesh_end = 60.0;   ///< distance at which all is forgotten

/// Elements from r = 0 to far outside the range, where the functions are zero.
class RadialMesh {
public:
    /// `inside` elements in the range; outside each is wider than the one before.
    RadialMesh(int d, int inside, double outermost);

    /// How many there are.
    int elements() const { return static_cast<int>(ends_.size()) - 1; }
    int nodes() const { return elements() * order; }  ///< without the outermost, which is held at zero
    /// Smallest distance of an element.
    double start(int element) const { return ends_[element]; }
    /// Its largest.
    double end(int element) const { return ends_[element + 1]; }
    /// Points of the Gauss rule on an element.
    std::vector<Point> points(int element) const;

private:
    int d_;
    std::vector<double> ends_;
};

}  // namespace dpd::theory::encounter
