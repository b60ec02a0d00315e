#include "integrals.hpp"

#include <boost/math/quadrature/tanh_sinh.hpp>
#include <numbers>
#include <stdexcept>

namespace dpd::theory {

void require_positive(std::initializer_list<Quantity> quantities) {
    for (auto const& [name, value] : quantities)
        if (!(value > 0.0) || !std::isfinite(value))
            throw std::invalid_argument(std::string(name) + " must be positive and finite");
}

void require_finite(std::initializer_list<Quantity> quantities) {
    for (auto const& [name, value] : quantities)
        if (!std::isfinite(value)) throw std::invalid_argument(std::string(name) + " must be finite");
}

double integral_of_weight(int d, double rc, Weight weight) {
    return volume_integral(d, rc, [=](double r) { return weight_at(weight, r / rc); });
}
double integral_of_squared_weight(int d, double rc, Weight weight) {
    return volume_integral(d, rc, [=](double r) { return square(weight_at(weight, r / rc)); });
}
double integral_of_weight_r2(int d, double rc, Weight weight) {
    return volume_integral(d, rc, [=](double r) { return weight_at(weight, r / rc) * r * r; });
}

double unit_sphere_surface(int d) {
    if (d == 2) return 2.0 * std::numbers::pi;
    if (d == 3) return 4.0 * std::numbers::pi;
    throw std::invalid_argument("d must be 2 or 3");
}

namespace {
// A value whose sums do not overflow, which the quadrature takes for granted.
double summable(double value) {
    constexpr double largest = 1e300;
    if (!(std::abs(value) < largest))
        throw std::domain_error("no finite value: a parameter is too large or too small");
    return value;
}
}  // namespace

// [volume integral]
double volume_integral(int d, double rc, std::function<double(double)> const& f) {
    require_positive({{"rc", rc}});
    // Double-exponential quadrature, because (1 - x)^(1/2) has no finite slope at the cutoff and because S1
    // at a large gamma dt/m has a boundary layer there.
    static boost::math::quadrature::tanh_sinh<double> quadrature;  // its lazily grown table is locked
    constexpr double tolerance = 1e-12;
    double const radial = quadrature.integrate(
        [&](double x) { return summable(power(x, d - 1) * f(rc * x)); }, 0.0, 1.0, tolerance);
    return unit_sphere_surface(d) * power(rc, d) * radial;
}
// [volume integral]

}  // namespace dpd::theory
