#include "trajectory.hpp"

#include <array>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <utility>

#include "files.hpp"
#include "hdf5.hpp"

namespace dpd {

using namespace hdf5;

namespace {

std::string const all = "particles/all/";
std::array<std::string, 6> const elements{all + "position/step",  all + "position/time",
                                          all + "position/value", all + "velocity/value",
                                          all + "image/value",    all + "box/edges/value"};
constexpr char const* owner = "dpdref_run";

// Time-dependent H5MD elements are data sets that grow along their first axis.
void create_element(H5::H5File& h5, std::string const& name, H5::DataType const& type,
                    std::vector<hsize_t> shape) {
    shape.insert(shape.begin(), 0);
    std::vector<hsize_t> limit = shape, chunk = shape;
    limit[0] = H5S_UNLIMITED;
    chunk[0] = shape.size() > 1 ? 1 : 1024;
    H5::DSetCreatPropList properties;
    properties.setChunk(static_cast<int>(chunk.size()), chunk.data());
    properties.setFletcher32();
    H5Pset_obj_track_times(properties.getId(), false);  // same run, same bytes
    create(h5, name, type, H5::DataSpace(static_cast<int>(shape.size()), shape.data(), limit.data()),
           properties);
}

// A trajectory without frames. Space in its file is taken at the end only: the bytes do not depend on when it
// was closed and opened again.
void create_empty(std::filesystem::path const& path, TrajectoryOf const& what) {
    H5::FileCreatPropList properties;
    H5Pset_file_space_strategy(properties.getId(), H5F_FSPACE_STRATEGY_NONE, false, 1);
    H5::FileAccPropList access;
    // values are written by `write`, which says so if they cannot be, and not by closing
    access.setSieveBufSize(0);
    // not closed after an error, when the library would fail again
    auto* const file = new H5::H5File(path.string(), H5F_ACC_TRUNC, properties, access);
    H5::H5File& h5 = *file;
    hsize_t const particles = what.particles, dimension = what.box_length.size();
    write_h5md_metadata(h5);
    create_element(h5, elements[0], H5::PredType::NATIVE_UINT64, {});
    create_element(h5, elements[1], H5::PredType::NATIVE_DOUBLE, {});
    create_element(h5, elements[2], H5::PredType::NATIVE_DOUBLE, {particles, dimension});
    create_element(h5, elements[3], H5::PredType::NATIVE_DOUBLE, {particles, dimension});
    create_element(h5, elements[4], H5::PredType::NATIVE_INT32, {particles, dimension});
    create_element(h5, elements[5], H5::PredType::NATIVE_DOUBLE, {dimension, dimension});
    for (char const* element : {"velocity", "image", "box/edges"})
        for (char const* stamp : {"step", "time"})
            h5.link(H5L_TYPE_HARD, all + "position/" + stamp, all + element + "/" + stamp);
    std::vector<std::uint32_t> id(what.particles);
    for (std::size_t p = 0; p < id.size(); ++p) id[p] = static_cast<std::uint32_t>(p);
    H5::DSetCreatPropList untimed;
    H5Pset_obj_track_times(untimed.getId(), false);
    create(h5, all + "id", type_of<std::uint32_t>(), H5::DataSpace(1, &particles), untimed)
        .write(id.data(), type_of<std::uint32_t>());
    H5::Group const box = h5.openGroup(all + "box");
    box.createAttribute("dimension", H5::PredType::NATIVE_INT32, H5::DataSpace(H5S_SCALAR))
        .write(H5::PredType::NATIVE_INT32, std::array{static_cast<std::int32_t>(dimension)}.data());
    std::vector<char const*> const boundary(dimension, "periodic");
    box.createAttribute("boundary", text_type(), H5::DataSpace(1, &dimension))
        .write(text_type(), boundary.data());
    // not part of H5MD: the images across y move with this rate times the height of the box
    box.createAttribute("shear_rate", H5::PredType::NATIVE_DOUBLE, H5::DataSpace(H5S_SCALAR))
        .write(H5::PredType::NATIVE_DOUBLE, &what.shear_rate);
    h5.createAttribute(owner, text_type(), H5::DataSpace(H5S_SCALAR)).write(text_type(), what.run);
    h5.flush(H5F_SCOPE_GLOBAL);
    h5.close();
    delete file;
}

// What the library's call returned, or an exception that says what the system said.
template <class Result>
Result must(Result result) {
    if (result < 0) {
        int const error = errno;
        bool const full = error == ENOSPC || error == EFBIG || error == EDQUOT;
        throw H5::FileIException("append", full ? std::generic_category().message(error) : "HDF5 failed");
    }
    return result;
}

// Part of a data set along its first axis.
struct Rows {
    hid_t file = -1, memory = -1;
    Rows(hid_t set, hsize_t from, hsize_t count) : file(must(H5Dget_space(set))) {
        std::array<hsize_t, 3> size{}, start{};
        int const rank = must(H5Sget_simple_extent_dims(file, size.data(), nullptr));
        size[0] = count;
        start[0] = from;
        must(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr));
        memory = must(H5Screate_simple(rank, size.data(), nullptr));
    }
    ~Rows() {
        H5Sclose(file);
        H5Sclose(memory);
    }
    Rows(Rows const&) = delete;
    Rows& operator=(Rows const&) = delete;
};

}  // namespace

struct Trajectory::File {
    std::filesystem::path path, part;
    TrajectoryOf what;
    std::uint64_t frames = 0;
    bool cut = false;  // the committed file has frames that do not count
    // open while frames are appended; not closed after an error, when the library would fail again
    hid_t h5 = -1;
    std::array<hid_t, 6> sets{};

    ~File() {
        std::error_code ignored;
        std::filesystem::remove(part, ignored);
    }

    std::size_t dimension() const { return what.box_length.size(); }

    // The box vectors, one per row; in shear the second leads to the displaced image.
    std::vector<double> edges(double time) const {
        std::vector<double> matrix(dimension() * dimension(), 0.0);
        for (std::size_t axis = 0; axis < dimension(); ++axis)
            matrix[axis * (dimension() + 1)] = what.box_length[axis];
        matrix[dimension()] = std::fmod(what.shear_rate * what.box_length[1] * time, what.box_length[0]);
        return matrix;
    }

    void open_part() {
        h5 = must(H5Fopen(part.c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
        for (std::size_t e = 0; e < elements.size(); ++e)
            sets[e] = must(H5Dopen2(h5, elements[e].c_str(), H5P_DEFAULT));
    }

    void close_part() {
        for (hid_t& set : sets) must(H5Dclose(std::exchange(set, -1)));
        must(H5Fclose(std::exchange(h5, -1)));
    }

    void write(std::uint64_t frame, std::size_t element, H5::DataType const& type, void const* data) const {
        hid_t const set = sets[element];
        std::array<hsize_t, 3> size{frame + 1, what.particles, dimension()};
        if (element == 5) size[1] = dimension();
        must(H5Dset_extent(set, size.data()));
        Rows const rows(set, frame, 1);
        must(H5Dwrite(set, type.getId(), rows.memory, rows.file, H5P_DEFAULT, data));
    }

    void write_frame(std::uint64_t frame, std::uint64_t step, double time,
                     std::vector<double> const& position, std::vector<double> const& velocity,
                     std::vector<std::int32_t> const& image) const {
        write(frame, 0, H5::PredType::NATIVE_UINT64, &step);
        write(frame, 1, H5::PredType::NATIVE_DOUBLE, &time);
        write(frame, 2, H5::PredType::NATIVE_DOUBLE, position.data());
        write(frame, 3, H5::PredType::NATIVE_DOUBLE, velocity.data());
        write(frame, 4, H5::PredType::NATIVE_INT32, image.data());
        write(frame, 5, H5::PredType::NATIVE_DOUBLE, edges(time).data());
        // so that the frame takes its place in the file before the next one, whenever that is closed
        must(H5Fflush(h5, H5F_SCOPE_GLOBAL));
    }

    // The frames that count, one by one as they were appended, so that the file is the same to the last byte.
    void write_again() {
        create_empty(part, what);
        open_part();
        H5::H5File const from(path.string(), H5F_ACC_RDONLY);
        std::size_t const numbers = what.particles * dimension();
        std::vector<double> position(numbers), velocity(numbers);
        std::vector<std::int32_t> image(numbers);
        for (std::uint64_t frame = 0; frame < frames; ++frame) {
            auto const read = [&](std::size_t element, H5::DataType const& type, void* data) {
                H5::DataSet const set = from.openDataSet(elements[element]);
                Rows const rows(set.getId(), frame, 1);
                must(H5Dread(set.getId(), type.getId(), rows.memory, rows.file, H5P_DEFAULT, data));
            };
            std::uint64_t step = 0;
            double time = 0.0;
            read(0, H5::PredType::NATIVE_UINT64, &step);
            read(1, H5::PredType::NATIVE_DOUBLE, &time);
            read(2, H5::PredType::NATIVE_DOUBLE, position.data());
            read(3, H5::PredType::NATIVE_DOUBLE, velocity.data());
            read(4, H5::PredType::NATIVE_INT32, image.data());
            write_frame(frame, step, time, position, velocity, image);
        }
    }

    // The frames so far, open for more.
    void begin_part() {
        if (cut) {
            write_again();
            return;
        }
        std::error_code error;
        std::filesystem::copy_file(path, part, std::filesystem::copy_options::overwrite_existing, error);
        if (error) throw InputError(fmt::format("{}: cannot be written: {}", path.string(), error.message()));
        open_part();
    }
};

Trajectory::Trajectory(std::filesystem::path path, TrajectoryOf what, std::uint64_t frames,
                       std::uint64_t step)
    : file_(std::make_unique<File>()) {
    auto& file = *file_;
    file.part = std::filesystem::path(path).concat(".part");
    file.path = std::move(path);
    file.what = std::move(what);
    file.frames = frames;
    bool const exists = std::filesystem::exists(file.path);
    if (!exists && frames > 0)
        throw InputError(
            fmt::format("{}: is gone, and with it {} frames; allowed: put it back, or remove the "
                        "results beside it to begin anew",
                        file.path.string(), frames));
    if (exists)
        guarded(file.path, "open", [&] {
            H5::H5File h5;
            std::string of;
            if (H5::H5File::isHdf5(file.path.string())) h5 = H5::H5File(file.path.string(), H5F_ACC_RDONLY);
            if (h5.getId() > 0 && h5.attrExists(owner)) h5.openAttribute(owner).read(text_type(), of);
            if (of != file.what.run)
                throw InputError(
                    fmt::format("{}: exists and is not the trajectory of this scene and seed; allowed: "
                                "another name for the results, or move it",
                                file.path.string()));
            if (frames == 0) return;
            std::vector<std::uint64_t> steps;
            vector_io(h5, true, elements[0], steps);
            if (steps.size() < frames || steps[frames - 1] != step)
                throw InputError(
                    fmt::format("{}: lacks frames, the run has {} of them; allowed: put it back, or "
                                "remove the results beside it to begin anew",
                                file.path.string(), frames));
            file.cut = steps.size() > frames;
        });
    if (frames > 0) return;
    guarded(file.path, "create", [&] { create_empty(file.part, file.what); });
    put_in_place(file.part, file.path);
}

Trajectory::~Trajectory() = default;

void Trajectory::append(std::uint64_t step, double time, std::vector<double> const& position,
                        std::vector<double> const& velocity, std::vector<std::int32_t> const& image) {
    auto& file = *file_;
    guarded(file.path, "append to", [&] {
        if (file.h5 < 0) file.begin_part();
        file.write_frame(file.frames, step, time, position, velocity, image);
        ++file.frames;
    });
}

void Trajectory::commit() {
    auto& file = *file_;
    if (file.h5 < 0) return;
    guarded(file.path, "write", [&] { file.close_part(); });
    put_in_place(file.part, file.path);
    file.cut = false;
}

}  // namespace dpd
