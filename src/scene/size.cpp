#include "size.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace dpd {
namespace {

// Bytes; the least of what the machine has and the process may take.
double memory() {
    double bytes = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        bytes = std::min(bytes, double(limit.rlim_cur));
    return bytes;
}

void check(TomlReader const& table, std::string const& key, std::string const& what, double bytes) {
    double const available = memory();
    if (!(bytes <= available))
        table.fail(key, fmt::format("gives {}, which need {:.3g} bytes; allowed: what fits into {:.3g}", what,
                                    bytes, available));
}

// Cells of a grid of at least that width.
double cells(Scene const& scene, double width) {
    double product = 1.0;
    for (double const side : scene.length) product *= std::max(1.0, std::floor(side / width));
    return product;
}

void check_correlation(Scene const& scene, TomlReader& sample, std::string const& name,
                       std::optional<CorrelationParameters> const& correlation) {
    if (!correlation) return;
    constexpr double bytes_per_lag = 8.0 + 2.0 * 8.0 * double(curve_blocks);
    double const origins =
        double(correlation->lags) * double(correlation->spacing) / double(correlation->origin_spacing) + 1.0;
    double const particles = double(scene.particles + scene.wall_particles);
    auto const table = sample.required_table(name);
    check(table, "longest", fmt::format("{} lags", correlation->lags),
          bytes_per_lag * double(correlation->lags));
    check(table, "origins", fmt::format("{:.0f} time origins at a time", origins),
          8.0 * scene.dimension * particles * origins);
}

}  // namespace

void check_size(Scene const& scene, TomlReader& root) {
    auto particles = root.required_table("particles");
    int const d = scene.dimension;
    double const cutoff = scene.cutoff();
    double const all = scene.density() * scene.volume();
    double const ball = (d == 2 ? std::numbers::pi : 4.0 * std::numbers::pi / 3.0) * std::pow(cutoff, d);
    double const pairs = 0.5 * all * std::min(all, scene.density() * ball);
    // two vectors of doubles, images, ids, a sorted copy; a pair's two rows, unit vector, distance, impulse
    double const bytes_per_particle = 2.0 * (2.0 * 8.0 * d + 4.0 * d + 4.0), bytes_per_pair = 8.0 * (d + 3);
    bool const walls = all > 2.0 * double(scene.particles);
    auto const wall_table = root.table("walls");
    check(walls ? *wall_table : particles,
          walls                     ? "thickness"
          : particles.has("number") ? "number"
                                    : "density",
          fmt::format("{:.3g} particles", all), bytes_per_particle * all + bytes_per_pair * pairs);
    if (scene.search == Search::cell) {
        double width = cutoff > 0.0 ? cutoff : INFINITY;
        if (scene.sample.radial_distribution)
            width = std::min(width, scene.sample.radial_distribution->range);
        if (scene.sample.bond_order) width = std::min(width, scene.sample.bond_order->range);
        constexpr double bytes_per_cell = 16.0, most_cells = 1e9;  // which are counted by 32 bits
        double const count = cells(scene, width);
        bool const mapped = scene.coarse_graining && !scene.coarse_graining->length.empty();
        auto const box = root.required_table(mapped ? "coarse_graining" : "box");
        if (count > most_cells)
            box.fail("length", fmt::format("gives {:.3g} cells of the pair search, which need {:.3g} bytes; "
                                           "allowed: at most {:g} cells",
                                           count, bytes_per_cell * count, most_cells));
        check(box, "length", fmt::format("{:.3g} cells of the pair search", count), bytes_per_cell * count);
    }
    if (auto const* const rescale = scene.stage<Rescale>(); rescale && rescale->mode != Rescaling::global)
        check(root.required_table("rescale"), "cell",
              fmt::format("{:.3g} cells", cells(scene, rescale->cell)),
              8.0 * (d + 3) * cells(scene, rescale->cell));
    if (auto sample = root.table("sample")) {
        check_correlation(scene, *sample, "mean_square_displacement", scene.sample.mean_square_displacement);
        check_correlation(scene, *sample, "velocity_autocorrelation", scene.sample.velocity_autocorrelation);
        double const samples = double(scene.production_steps) / double(scene.sample.interval) *
                               double(scene.sample.observables.size());
        check(*sample, "interval", fmt::format("{:.3g} samples", samples), 8.0 * samples);
    }
}

}  // namespace dpd
