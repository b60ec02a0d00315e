#include "live.hpp"

#include <fmt/format.h>

#include "build.hpp"
#include "errors.hpp"

namespace dpd {
namespace {

template <int d>
class Running : public Live {
public:
    Running(std::string text, Scene scene)
        : text_(std::move(text)), scene_(std::move(scene)), simulation_(build<d>(scene_, sampling())) {
        measure_from(scene_.equilibration_steps);
    }

    void change(std::vector<std::string> const& overrides) override {
        Scene changed = parse_scene(text_, "scene", overrides);
        if (changed.dimension != d || changed.particles != scene_.particles ||
            changed.wall_particles != scene_.wall_particles)
            throw InputError(fmt::format("scene: has {} particles; allowed: {}, as those that are there",
                                         changed.particles, scene_.particles));
        Simulation<d> next = build<d>(changed, sampling());
        next.particles = simulation_.particles;
        next.particles.mass = changed.mass;
        next.step = simulation_.step;
        next.time = simulation_.time;
        add_flow(next.particles, simulation_.box, -1.0);
        for (int axis = 0; axis < d; ++axis)
            next.particles.position.col(axis) *= next.box.length[axis] / simulation_.box.length[axis];
        add_flow(next.particles, next.box, 1.0);
        next.box.wrap(next.particles, next.time);
        simulation_ = std::move(next);
        scene_ = std::move(changed);
        measure_from(simulation_.step + scene_.equilibration_steps);
    }

    void measure_again() override { measure_from(simulation_.step); }

    void advance(std::uint64_t steps) override {
        for (std::uint64_t k = 0; k < steps && !complete(); ++k) simulation_.advance();
    }

    bool complete() const override { return simulation_.step >= first_ + scene_.production_steps; }

    Scene const& scene() const override { return scene_; }
    Record const& record() const override { return recorder_->record(); }
    std::uint64_t step() const override { return simulation_.step; }
    std::uint64_t measured_steps() const override {
        return simulation_.step > first_ ? simulation_.step - first_ : 0;
    }
    double time() const override { return simulation_.time; }
    double kinetic_temperature() const override {
        return dpd::kinetic_temperature(simulation_.particles, simulation_.box);
    }
    double offset() const override { return simulation_.box.offset(simulation_.time); }
    std::vector<double> positions() const override { return by_id(simulation_.particles.position); }
    std::vector<double> velocities() const override { return by_id(simulation_.particles.velocity); }

private:
    std::function<void(Simulation<d>&)> sampling() {
        return [this](Simulation<d>& simulation) { (*recorder_)(simulation); };
    }

    void measure_from(std::uint64_t step) {
        first_ = step;
        SampleParameters parameters = scene_.sample;
        parameters.equilibration = first_;
        parameters.steps = first_ + scene_.production_steps;
        recorder_ = std::make_unique<Recorder<d>>(parameters, simulation_);
    }

    static void add_flow(Particles<d>& particles, Box<d> const& box, double sign) {
        for (Eigen::Index p = 0; p < particles.size(); ++p)
            particles.velocity(p, 0) += sign * box.flow_velocity(particles.position(p, 1));
    }

    std::vector<double> by_id(Field<d> const& field) const {
        std::vector<double> values(static_cast<std::size_t>(field.size()));
        for (Eigen::Index p = 0; p < field.rows(); ++p)
            for (int axis = 0; axis < d; ++axis)
                values[simulation_.particles.id[p] * std::size_t(d) + std::size_t(axis)] = field(p, axis);
        return values;
    }

    std::string text_;
    Scene scene_;
    Simulation<d> simulation_;
    std::unique_ptr<Recorder<d>> recorder_;
    std::uint64_t first_ = 0;
};

}  // namespace

std::unique_ptr<Live> Live::begin(std::string const& text, std::vector<std::string> const& overrides) {
    Scene scene = parse_scene(text, "scene", overrides);
    if (scene.dimension == 2) return std::make_unique<Running<2>>(text, std::move(scene));
    return std::make_unique<Running<3>>(text, std::move(scene));
}

}  // namespace dpd
