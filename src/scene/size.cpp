#include "size.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace dpd {
namespace {

// The limit of a control group or, where a container shows no more than its own, of the root; infinite
// without.
double limit_of_group(std::string const& root, std::string path, char const* file) {
    double least = INFINITY;
    for (;;) {
        double bytes = 0.0;
        if (std::ifstream(root + path + file) >> bytes) least = std::min(least, bytes);  // "max" is no number
        if (path.empty()) return least;
        path.resize(path.find_last_of('/'));
    }
}

}  // namespace

double memory_at_hand() {
    double bytes = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        bytes = std::min(bytes, double(limit.rlim_cur));
    std::ifstream groups(
        "/proc/self/cgroup");  // lines "number:controllers:/path"; no controllers in version 2
    for (std::string line; std::getline(groups, line);) {
        std::size_t const first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        std::string const controllers = line.substr(first + 1, second - first - 1);
        std::string path = line.substr(second + 1);
        if (path == "/") path.clear();
        if (controllers.empty())
            bytes = std::min(bytes, limit_of_group("/sys/fs/cgroup", path, "/memory.max"));
        else if (controllers == "memory")
            bytes = std::min(bytes, limit_of_group("/sys/fs/cgroup/memory", path, "/memory.limit_in_bytes"));
    }
    return bytes;
}

namespace {

// What a run needs, part by part. InputError if it does not fit: names the largest part.
class Needs {
public:
    void add(TomlReader const& table, std::string const& key, std::string const& what, double bytes) {
        all_ += bytes;
        if (bytes > largest_ || complaint_ == nullptr) {
            largest_ = bytes;
            complaint_ = [=, this] {
                std::string const whole =
                    all_ > bytes ? fmt::format(" of {:.3g} of the whole run", all_) : "";
                table.fail(key,
                           fmt::format("gives {}, which need {:.3g} bytes{}; allowed: what fits into {:.3g}",
                                       what, bytes, whole, available_));
            };
        }
        if (!(all_ <= available_)) complaint_();
    }

private:
    double available_ = memory_at_hand(), all_ = 0.0, largest_ = 0.0;
    std::function<void()> complaint_;
};

// Cells of a grid of at least that width.
double cells(Scene const& scene, double width) {
    double product = 1.0;
    for (double const side : scene.length) product *= std::max(1.0, std::floor(side / width));
    return product;
}

void add_correlation(Needs& needs, Scene const& scene, TomlReader& sample, std::string const& name,
                     std::optional<CorrelationParameters> const& correlation) {
    if (!correlation) return;
    double const origins =
        double(correlation->lags) * double(correlation->spacing) / double(correlation->origin_spacing) + 1.0;
    double const particles = double(scene.particles + scene.wall_particles);
    auto const table = sample.required_table(name);
    needs.add(table, "longest", fmt::format("{} lags", correlation->lags),
              bytes_per_lag * double(correlation->lags));
    needs.add(table, "origins", fmt::format("{:.0f} time origins at a time", origins),
              8.0 * (scene.dimension * particles + double(correlation->lags)) * origins);
}

}  // namespace

void check_size(Scene const& scene, TomlReader& root) {
    auto particles = root.required_table("particles");
    Needs needs;
    int const d = scene.dimension;
    double const cutoff = scene.cutoff();
    double const all = scene.density() * scene.volume();
    double const ball = (d == 2 ? std::numbers::pi : 4.0 * std::numbers::pi / 3.0) * std::pow(cutoff, d);
    double const pairs = 0.5 * all * std::min(all, scene.density() * ball);
    // two vectors of doubles, images, ids, a sorted copy; a pair's two rows, unit vector, distance, impulse
    double const bytes_per_particle = 2.0 * (2.0 * 8.0 * d + 4.0 * d + 4.0), bytes_per_pair = 8.0 * (d + 3);
    bool const walls = all > 2.0 * double(scene.particles);
    auto const wall_table = root.table("walls");
    needs.add(walls ? *wall_table : particles,
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
        needs.add(box, "length", fmt::format("{:.3g} cells of the pair search", count),
                  bytes_per_cell * count);
    }
    if (auto const* const rescale = scene.stage<Rescale>(); rescale && rescale->mode != Rescaling::global)
        needs.add(root.required_table("rescale"), "cell",
                  fmt::format("{:.3g} cells", cells(scene, rescale->cell)),
                  8.0 * (d + 3) * cells(scene, rescale->cell));
    if (auto sample = root.table("sample")) {
        add_correlation(needs, scene, *sample, "mean_square_displacement",
                        scene.sample.mean_square_displacement);
        add_correlation(needs, scene, *sample, "velocity_autocorrelation",
                        scene.sample.velocity_autocorrelation);
        double const samples = double(scene.steps() - scene.equilibration_steps) /
                               double(scene.sample.interval) * double(scene.sample.observables.size());
        needs.add(*sample, "interval", fmt::format("{:.3g} samples", samples), 8.0 * samples);
    }
}

}  // namespace dpd
