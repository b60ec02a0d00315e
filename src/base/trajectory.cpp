#include "trajectory.hpp"

#include <array>
#include <cmath>

#include "hdf5.hpp"

namespace dpd {

using namespace hdf5;

struct Trajectory::File {
    H5::H5File h5;
    std::filesystem::path path;
    hsize_t frames = 0;
    hsize_t particles = 0;
    hsize_t dimension = 0;
    std::vector<double> box_length;
    double shear_rate = 0.0;

    // The box vectors, one per row; in shear the second leads to the displaced image.
    std::vector<double> edges(double time) const {
        std::vector<double> matrix(dimension * dimension, 0.0);
        for (std::size_t axis = 0; axis < dimension; ++axis)
            matrix[axis * (dimension + 1)] = box_length[axis];
        matrix[dimension] = std::fmod(shear_rate * box_length[1] * time, box_length[0]);
        return matrix;
    }

    // Time-dependent H5MD elements are data sets that grow along their first axis.
    void create_element(std::string const& name, H5::DataType const& type, std::vector<hsize_t> shape) {
        shape.insert(shape.begin(), 0);
        std::vector<hsize_t> limit = shape, chunk = shape;
        limit[0] = H5S_UNLIMITED;
        chunk[0] = shape.size() > 1 ? 1 : 1024;
        H5::DSetCreatPropList properties;
        properties.setChunk(static_cast<int>(chunk.size()), chunk.data());
        create(h5, name, type, H5::DataSpace(static_cast<int>(shape.size()), shape.data(), limit.data()),
               properties);
    }

    void resize(std::string const& name, hsize_t count) {
        H5::DataSet set = h5.openDataSet(name);
        std::array<hsize_t, 3> size{};
        set.getSpace().getSimpleExtentDims(size.data());
        size[0] = count;
        set.extend(size.data());
    }

    void write_frame(std::string const& name, H5::DataType const& type, void const* data) {
        resize(name, frames + 1);
        H5::DataSet const set = h5.openDataSet(name);
        H5::DataSpace space = set.getSpace();
        int const rank = space.getSimpleExtentNdims();
        std::array<hsize_t, 3> count{}, start{};
        space.getSimpleExtentDims(count.data());
        count[0] = 1;
        start[0] = frames;
        space.selectHyperslab(H5S_SELECT_SET, count.data(), start.data());
        set.write(data, type, H5::DataSpace(rank, count.data()), space);
    }
};

namespace {

std::string const all = "particles/all/";
std::array<std::string, 6> const elements{all + "position/step",  all + "position/time",
                                          all + "position/value", all + "velocity/value",
                                          all + "image/value",    all + "box/edges/value"};

}  // namespace

Trajectory::Trajectory(std::filesystem::path const& path, std::vector<double> const& box_length,
                       std::size_t particles, double shear_rate, std::uint64_t keep_until_step)
    : file_(std::make_unique<File>()) {
    file_->path = path;
    file_->particles = particles;
    file_->dimension = box_length.size();
    file_->box_length = box_length;
    file_->shear_rate = shear_rate;
    if (keep_until_step > 0 && std::filesystem::exists(path)) {
        guarded(path, "reopen", [&] {
            file_->h5 = H5::H5File(path.string(), H5F_ACC_RDWR);
            std::vector<std::uint64_t> steps;
            vector_io(file_->h5, true, elements[0], steps);
            while (file_->frames < steps.size() && steps[file_->frames] <= keep_until_step) ++file_->frames;
            for (auto const& element : elements) file_->resize(element, file_->frames);
        });
        return;
    }
    guarded(path, "create", [&] {
        auto& file = *file_;
        file.h5 = H5::H5File(path.string(), H5F_ACC_TRUNC);
        write_h5md_metadata(file.h5);
        file.create_element(elements[0], H5::PredType::NATIVE_UINT64, {});
        file.create_element(elements[1], H5::PredType::NATIVE_DOUBLE, {});
        file.create_element(elements[2], H5::PredType::NATIVE_DOUBLE, {file.particles, file.dimension});
        file.create_element(elements[3], H5::PredType::NATIVE_DOUBLE, {file.particles, file.dimension});
        file.create_element(elements[4], H5::PredType::NATIVE_INT32, {file.particles, file.dimension});
        file.create_element(elements[5], H5::PredType::NATIVE_DOUBLE, {file.dimension, file.dimension});
        for (char const* element : {"velocity", "image", "box/edges"})
            for (char const* stamp : {"step", "time"})
                file.h5.link(H5L_TYPE_HARD, all + "position/" + stamp, all + element + "/" + stamp);
        std::vector<std::uint32_t> id(particles);
        for (std::size_t p = 0; p < particles; ++p) id[p] = static_cast<std::uint32_t>(p);
        vector_io(file.h5, false, all + "id", id);
        H5::Group const box = file.h5.openGroup(all + "box");
        box.createAttribute("dimension", H5::PredType::NATIVE_INT32, H5::DataSpace(H5S_SCALAR))
            .write(H5::PredType::NATIVE_INT32, std::array{static_cast<std::int32_t>(file.dimension)}.data());
        std::vector<char const*> const boundary(file.dimension, "periodic");
        box.createAttribute("boundary", text_type, H5::DataSpace(1, &file.dimension))
            .write(text_type, boundary.data());
        // not part of H5MD: the images across y move with this rate times the height of the box
        box.createAttribute("shear_rate", H5::PredType::NATIVE_DOUBLE, H5::DataSpace(H5S_SCALAR))
            .write(H5::PredType::NATIVE_DOUBLE, &shear_rate);
        file.h5.flush(H5F_SCOPE_GLOBAL);
    });
}

Trajectory::~Trajectory() {
    std::scoped_lock const lock(library);
    file_.reset();
}

void Trajectory::append(std::uint64_t step, double time, std::vector<double> const& position,
                        std::vector<double> const& velocity, std::vector<std::int32_t> const& image) {
    guarded(file_->path, "append to", [&] {
        file_->write_frame(elements[0], H5::PredType::NATIVE_UINT64, &step);
        file_->write_frame(elements[1], H5::PredType::NATIVE_DOUBLE, &time);
        file_->write_frame(elements[2], H5::PredType::NATIVE_DOUBLE, position.data());
        file_->write_frame(elements[3], H5::PredType::NATIVE_DOUBLE, velocity.data());
        file_->write_frame(elements[4], H5::PredType::NATIVE_INT32, image.data());
        file_->write_frame(elements[5], H5::PredType::NATIVE_DOUBLE, file_->edges(time).data());
        ++file_->frames;
        file_->h5.flush(H5F_SCOPE_GLOBAL);
    });
}

}  // namespace dpd
