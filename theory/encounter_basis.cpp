/// @file
/// What both solvers of the encounter share, computed once.
#include "encounter_basis.hpp"

#include <algorithm>
#include <stdexcept>

namespace dpd::theory {

Weight weight_of(Thermostat const& thermostat) {
    auto const* friction = std::get_if<Shardlow>(&thermostat);
    return friction ? friction->weight : Weight::constant;
}

// [loss]
double loss(Encounter const& pair, int i, double r) {
    if (r >= 1.0 || i == 0) return 0.0;
    if (auto const* lowe = std::get_if<Lowe>(&pair.thermostat)) return lowe->Gamma;
    auto const& shardlow = std::get<Shardlow>(pair.thermostat);
    double const w = shardlow.gamma * weight_at(shardlow.weight, r);
    if (pair.step == 0.0) return 2.0 * w * i;
    return (1.0 - std::pow(1.0 - 2.0 * update_a(shardlow.scheme, w * pair.step), i)) / pair.step;
}
// [loss]

namespace encounter {

void check(Encounter const& pair, int degree) {
    unit_sphere_surface(pair.d);  // checks d
    auto const* shardlow = std::get_if<Shardlow>(&pair.thermostat);
    double const rate = shardlow ? shardlow->gamma : std::get<Lowe>(pair.thermostat).Gamma;
    for (double const r : {rate, pair.medium})
        if (!(r > 0.0) || !std::isfinite(r))
            throw std::invalid_argument("the frictions of an encounter must be positive and finite");
    if (!(pair.step >= 0.0) || !std::isfinite(pair.step))
        throw std::invalid_argument("the step of an encounter must be zero or positive and finite");
    if (!shardlow && rate * pair.step > 1.0)
        throw std::domain_error(
            "memory of Lowe's thermostat is known up to one update of a pair per step, Gamma dt = 1");
    if (degree < 2 || degree % 2 != 0)
        throw std::invalid_argument("the degree of an encounter must be even and at least 2");
}

double tensor_size(int d) { return std::sqrt((d - 1.0) / d); }
double xy_share(int d) { return 1.0 / ((d - 1.0) * (d + 2.0)); }

// [sources]
Source const force_source{u_r,
                          [](Encounter const& pair, double r) { return 0.5 * speed * loss(pair, 1, r); }};
Source const stress_source{u_r, [](Encounter const& pair, double r) {
                               return 0.5 * speed * tensor_size(pair.d) * r * loss(pair, 1, r);
                           }};
Source const relaxation_along{u_r_u_r, [](Encounter const& pair, double r) {
                                  return -std::numbers::sqrt2 * tensor_size(pair.d) * loss(pair, 2, r);
                              }};
Source const relaxation_across{u_r_u_t, [](Encounter const& pair, double r) {
                                   return -std::sqrt(2.0 * (pair.d - 1.0)) * loss(pair, 1, r);
                               }};
// [sources]

namespace {
/// By how much the rotation of r^ takes tensors of u_t^m to those of u_t^(m+1).
// [turning]
double turning(int d, int rank, int m) {
    if (rank == 1) return 1.0;
    return m == 0 ? std::sqrt(2.0 * d / (d - 1)) : std::sqrt(2.0 * (d - 2) / (d - 1));
}
// [turning]
}  // namespace

// [streaming]
std::vector<Streamed> stream(int d, int rank, VelocityFunction const& function) {
    auto const [m, i, p] = function;
    int const e = function.tangential_degree();
    double const a = laguerre_index(d, m);
    std::vector<Streamed> result;
    auto const add = [&](VelocityFunction to, double slope, double rotation, double pushed = 0.0) {
        if (to.i >= 0 && to.p >= 0) result.push_back({to, slope, rotation, pushed});
    };
    // along r^, and the centrifugal change of u_r and |u_t|
    add({m, i + 1, p}, std::sqrt(i + 1.0), -std::sqrt(i + 1.0) * e);
    add({m, i - 1, p}, std::sqrt(i), std::sqrt(i) * (e + d - 1), std::sqrt(i));
    add({m, i - 1, p + 1}, 0.0, -2.0 * std::sqrt(i * (p + 1) * (p + a + 1.0)));
    add({m, i + 1, p - 1}, 0.0, 2.0 * std::sqrt((i + 1) * p * (p + a)));
    // r^ turns
    if (m < highest_m(d, rank)) {
        add({m + 1, i, p}, 0.0, turning(d, rank, m) * std::sqrt(2.0 * (p + a + 1.0)));
        add({m + 1, i, p - 1}, 0.0, -turning(d, rank, m) * std::sqrt(2.0 * p));
    }
    if (m > 0) {
        add({m - 1, i, p}, 0.0, -turning(d, rank, m - 1) * std::sqrt(2.0 * (p + a)));
        add({m - 1, i, p + 1}, 0.0, turning(d, rank, m - 1) * std::sqrt(2.0 * (p + 1)));
    }
    return result;
}
// [streaming]

VelocityBasis::VelocityBasis(int d, int rank, int degree) {
    for (int m = 0; m <= highest_m(d, rank); ++m)
        for (int p = 0; 2 * p + m <= degree + 1; ++p)
            for (int i = 0; i + 2 * p + m <= degree + 1; ++i) {
                VelocityFunction const f{m, i, p};
                if (f.degree() % 2 == 1)
                    odd.push_back(f);
                else if (f.degree() <= degree)
                    even.push_back(f);
            }
    streaming.resize(odd.size());
    for (int k = 0; k < static_cast<int>(even.size()); ++k)
        for (auto const& [to, slope, rotation, pushed] : stream(d, rank, even[k]))
            if (int const row = odd_index(to); row >= 0)
                streaming[row].push_back({k, slope, rotation, pushed});
}

int VelocityBasis::index_in(std::vector<VelocityFunction> const& list, VelocityFunction const& f) {
    auto const found = std::ranges::find(list, f);
    return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

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

RadialMesh::RadialMesh(int d, int inside, double outermost) : d_(d) {
    constexpr double growth = 2.0;
    // finer at r = 0, where r^ turns fast, and at the edge, where the friction sets in
    for (int j = 0; j <= inside; ++j) ends_.push_back(0.5 * (1.0 - std::cos(std::numbers::pi * j / inside)));
    ends_.back() = 1.0;
    double width = ends_[inside] - ends_[inside - 1];
    while (ends_.back() < outermost) {
        width = std::min(growth * width, 0.5 * ends_.back() + 0.1);
        ends_.push_back(ends_.back() + width);
    }
}

std::vector<Point> RadialMesh::points(int element) const {
    using Gauss = boost::math::quadrature::gauss<double, 10>;  // holds the nodes >= 0 only
    double const start = ends_[element], width = ends_[element + 1] - start;
    std::vector<Point> result;
    for (std::size_t g = 0; g < Gauss::abscissa().size(); ++g)
        for (double const sign : {-1.0, 1.0}) {
            double const r = start + 0.5 * width * (1.0 + sign * Gauss::abscissa()[g]);
            auto const [value, slope] = shape_functions((r - start) / width);
            double const volume =
                unit_sphere_surface(d_) * std::pow(r, d_ - 1) * 0.5 * width * Gauss::weights()[g];
            result.push_back({r, volume, value, slope / width});
        }
    return result;
}

}  // namespace encounter
}  // namespace dpd::theory
