#include "archive.hpp"

#include <H5Cpp.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <concepts>
#include <mutex>
#include <type_traits>
#include <utility>

#include "errors.hpp"
#include "version.hpp"

namespace dpd {
namespace {

// The HDF5 library keeps global state and is not built thread-safe; runs of a campaign take turns.
std::recursive_mutex library;

template <class T>
H5::PredType const& type_of() {
    if constexpr (std::same_as<T, double>) return H5::PredType::NATIVE_DOUBLE;
    if constexpr (std::same_as<T, std::uint64_t>) return H5::PredType::NATIVE_UINT64;
    if constexpr (std::same_as<T, std::uint32_t>) return H5::PredType::NATIVE_UINT32;
    if constexpr (std::same_as<T, std::int32_t>) return H5::PredType::NATIVE_INT32;
}

H5::StrType const text_type(H5::PredType::C_S1, H5T_VARIABLE);

// Runs `action`; an HDF5 error becomes one line that names the file.
template <class Action>
auto guarded(std::filesystem::path const& path, char const* verb, Action&& action) {
    std::scoped_lock const lock(library);
    H5::Exception::dontPrint();
    try {
        return action();
    } catch (H5::Exception const& error) {
        throw InputError(fmt::format("{}: cannot {}: {}", path.string(), verb, error.getDetailMsg()));
    }
}

H5::LinkCreatPropList with_groups() {
    H5::LinkCreatPropList properties;
    properties.setCreateIntermediateGroup(true);
    return properties;
}

H5::DataSet create(H5::H5File& file, std::string const& name, H5::DataType const& type,
                   H5::DataSpace const& space,
                   H5::DSetCreatPropList const& properties = H5::DSetCreatPropList::DEFAULT) {
    return file.createDataSet(name, type, space, properties, H5::DSetAccPropList::DEFAULT, with_groups());
}

}  // namespace

struct Archive::File {
    H5::H5File h5;
};

Archive::Archive(std::filesystem::path path, Mode mode)
    : file_(std::make_unique<File>()), path_(std::move(path)), temporary_(path_), mode_(mode) {
    temporary_ += ".part";
    if (mode_ == Mode::write && path_.has_parent_path() &&
        !std::filesystem::is_directory(path_.parent_path()))
        throw InputError(fmt::format("{}: cannot create: the directory does not exist", path_.string()));
    guarded(path_, mode_ == Mode::read ? "open" : "create", [&] {
        file_->h5 = mode_ == Mode::read ? H5::H5File(path_.string(), H5F_ACC_RDONLY)
                                        : H5::H5File(temporary_.string(), H5F_ACC_TRUNC);
    });
}

Archive::~Archive() {
    std::scoped_lock const lock(library);
    file_.reset();
    std::error_code ignored;
    if (mode_ == Mode::write) std::filesystem::remove(temporary_, ignored);
}

void Archive::commit() {
    guarded(path_, "write", [&] { file_->h5.close(); });
    std::filesystem::rename(temporary_, path_);
}

bool Archive::has(std::string const& name) const {
    return guarded(path_, "read", [&] {
        for (std::size_t slash = name.find('/'); slash != std::string::npos;
             slash = name.find('/', slash + 1))
            if (!file_->h5.nameExists(name.substr(0, slash))) return false;
        return file_->h5.nameExists(name);
    });
}

std::vector<std::string> Archive::observables() const {
    std::vector<std::string> names;
    if (!has("observables")) return names;
    return guarded(path_, "read", [&] {
        H5::Group const group = file_->h5.openGroup("observables");
        for (hsize_t k = 0; k < group.getNumObjs(); ++k) {
            std::string const name = group.getObjnameByIdx(k),
                              value = fmt::format("observables/{}/value", name);
            if (has(value) && file_->h5.openDataSet(value).getSpace().getSimpleExtentNdims() == 1)
                names.push_back(name);
        }
        return names;
    });
}

void Archive::operator()(std::string const& name, double& value) {
    std::vector<double> one{value};
    (*this)(name, one);
    value = one.at(0);
}

void Archive::operator()(std::string const& name, std::uint64_t& value) {
    std::vector<std::uint64_t> one{value};
    (*this)(name, one);
    value = one.at(0);
}

void Archive::operator()(std::string const& name, std::string& value) {
    guarded(path_, reading() ? "read" : "write", [&] {
        H5::DataSpace const scalar(H5S_SCALAR);
        if (reading())
            file_->h5.openDataSet(name).read(value, text_type);
        else
            create(file_->h5, name, text_type, scalar).write(value, text_type);
    });
}

namespace {

template <class T>
void vector_io(H5::H5File& file, bool reading, std::string const& name, std::vector<T>& values) {
    if (reading) {
        H5::DataSet const set = file.openDataSet(name);
        values.resize(static_cast<std::size_t>(set.getSpace().getSimpleExtentNpoints()));
        if (!values.empty()) set.read(values.data(), type_of<T>());
    } else {
        hsize_t const size = values.size();
        H5::DataSet const set = create(file, name, type_of<T>(), H5::DataSpace(1, &size));
        if (!values.empty()) set.write(values.data(), type_of<T>());
    }
}

}  // namespace

void Archive::operator()(std::string const& name, std::vector<double>& values) {
    guarded(path_, reading() ? "read" : "write", [&] { vector_io(file_->h5, reading(), name, values); });
}

void Archive::operator()(std::string const& name, std::vector<std::uint64_t>& values) {
    guarded(path_, reading() ? "read" : "write", [&] { vector_io(file_->h5, reading(), name, values); });
}

// Transposed, whatever the array's own layout: a file does not tell how its writer kept an array in memory.
template <class Scalar, int columns, int options>
void Archive::array(std::string const& name, Eigen::Array<Scalar, Eigen::Dynamic, columns, options>& values) {
    Eigen::Array<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor> by_column;
    guarded(path_, reading() ? "read" : "write", [&] {
        if (reading()) {
            H5::DataSet const set = file_->h5.openDataSet(name);
            hsize_t size[2];
            set.getSpace().getSimpleExtentDims(size);
            if (columns != Eigen::Dynamic && std::cmp_not_equal(size[0], columns))
                throw InputError(fmt::format("{}: {} has {} columns; allowed: {}", path_.string(), name,
                                             size[0], columns));
            by_column.resize(static_cast<Eigen::Index>(size[1]), static_cast<Eigen::Index>(size[0]));
            if (by_column.size() > 0) set.read(by_column.data(), type_of<Scalar>());
            values = by_column;
        } else {
            by_column = values;
            hsize_t const size[2] = {static_cast<hsize_t>(values.cols()),
                                     static_cast<hsize_t>(values.rows())};
            H5::DataSet const set = create(file_->h5, name, type_of<Scalar>(), H5::DataSpace(2, size));
            if (by_column.size() > 0) set.write(by_column.data(), type_of<Scalar>());
        }
    });
}

template void Archive::array(std::string const&, Eigen::ArrayXd&);
template void Archive::array(std::string const&, Eigen::ArrayXXd&);
template void Archive::array(std::string const&, Eigen::ArrayX2d&);
template void Archive::array(std::string const&, Eigen::ArrayX3d&);
template <int columns, class Scalar = double>
using Rows = Eigen::Array<Scalar, Eigen::Dynamic, columns, Eigen::RowMajor>;
template void Archive::array(std::string const&, Rows<2>&);
template void Archive::array(std::string const&, Rows<3>&);
template void Archive::array(std::string const&, Rows<2, std::int32_t>&);
template void Archive::array(std::string const&, Rows<3, std::int32_t>&);
template void Archive::array(std::string const&, Eigen::Array<std::uint32_t, Eigen::Dynamic, 1>&);

namespace {

void set_attribute(H5::H5Object const& object, std::string const& name, std::string const& value) {
    object.createAttribute(name, text_type, H5::DataSpace(H5S_SCALAR)).write(text_type, value);
}

void set_attribute(H5::H5Object const& object, std::string const& name,
                   std::vector<std::int32_t> const& value) {
    hsize_t const size = value.size();
    object.createAttribute(name, H5::PredType::NATIVE_INT32, H5::DataSpace(1, &size))
        .write(H5::PredType::NATIVE_INT32, value.data());
}

// The root metadata that H5MD 1.1 asks for.
void write_h5md_metadata(H5::H5File& file) {
    H5::Group const h5md = file.createGroup("h5md");
    set_attribute(h5md, "version", std::vector<std::int32_t>{1, 1});
    set_attribute(h5md.createGroup("author"), "name", std::string("dpdref"));
    H5::Group const creator = h5md.createGroup("creator");
    set_attribute(creator, "name", std::string("dpdref"));
    set_attribute(creator, "version", std::string(version));
}

}  // namespace

void Archive::describe_as_h5md() {
    guarded(path_, "write", [&] { write_h5md_metadata(file_->h5); });
}

void Archive::describe_time(std::string const& name, std::uint64_t first_step, std::uint64_t interval,
                            double time_step) {
    // H5MD's form for a fixed interval: a scalar increment with the attribute "offset"
    auto const axis = [&]<class T>(std::string const& which, T increment, T offset) {
        H5::DataSpace const scalar(H5S_SCALAR);
        H5::DataSet const set = create(file_->h5, fmt::format("{}/{}", name, which), type_of<T>(), scalar);
        set.write(&increment, type_of<T>());
        set.createAttribute("offset", type_of<T>(), scalar).write(type_of<T>(), &offset);
    };
    guarded(path_, "write", [&] {
        axis("step", interval, first_step);
        axis("time", double(interval) * time_step, double(first_step) * time_step);
    });
}

// ---------------------------------------------------------------------------------------------------------

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
