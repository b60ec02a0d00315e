#include "archive.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <functional>
#include <string_view>
#include <utility>

#include "files.hpp"
#include "hdf5.hpp"

namespace dpd {
using namespace hdf5;

namespace {

// How a file ends: these words, 16 hexadecimal digits, a line break. HDF5 does not look behind its last
// address.
constexpr std::string_view digest_is = "dpdref digest crc64 ";
constexpr std::size_t ending = digest_is.size() + 17;
// That it has to end like this, where the ending itself may be lost.
constexpr char const* has_digest = "dpdref_digest";

std::string ending_of(std::string_view bytes) { return fmt::format("{}{:016x}\n", digest_is, digest(bytes)); }

std::string tail_of(std::filesystem::path const& path) {
    std::ifstream file(path, std::ios::binary);
    std::string tail(ending, '\0');
    file.seekg(-std::ptrdiff_t(ending), std::ios::end);
    file.read(tail.data(), std::ptrdiff_t(ending));
    return file ? tail : "";
}

}  // namespace

struct Archive::File {
    H5::H5File h5;
};

bool Archive::is_ours(std::filesystem::path const& path) { return tail_of(path).starts_with(digest_is); }

void Archive::refuse(std::string const& name, std::string const& problem) const {
    throw Damaged(
        fmt::format("{}: {}: {}; allowed: a file as it was written", path_.string(), name, problem));
}

Archive::Archive(std::filesystem::path path, Mode mode)
    : file_(std::make_unique<File>()), path_(std::move(path)), mode_(mode) {
    if (mode_ == Mode::write) {
        if (path_.has_parent_path() && !std::filesystem::is_directory(path_.parent_path()))
            throw InputError(fmt::format("{}: cannot create: the directory does not exist", path_.string()));
        guarded(path_, "create", [&] {
            file_->h5 = create_in_memory();
            file_->h5.createAttribute(has_digest, H5::PredType::NATIVE_INT32, H5::DataSpace(H5S_SCALAR));
        });
        return;
    }
    std::error_code ignored;
    if (std::filesystem::exists(path_, ignored) && !std::filesystem::is_regular_file(path_, ignored))
        throw InputError(fmt::format("{}: cannot open: is no regular file", path_.string()));
    if (is_ours(path_)) {
        std::string bytes = read_file(path_);
        std::string const end = bytes.substr(bytes.size() - ending);
        bytes.resize(bytes.size() - ending);
        if (end != ending_of(bytes))
            throw Damaged(fmt::format("{}: is damaged: its digest is wrong", path_.string()));
        guarded(path_, "open", [&] { file_->h5 = open_bytes(bytes); });
    } else {
        guarded(path_, "open", [&] {
            file_->h5 = H5::H5File(path_.string(), H5F_ACC_RDONLY);
            if (file_->h5.attrExists(has_digest))
                throw Damaged(fmt::format("{}: is damaged: its digest is gone", path_.string()));
        });
    }
}

Archive::~Archive() {
    std::scoped_lock const lock(library);
    file_.reset();
}

void Archive::commit() {
    std::string bytes = guarded(path_, "write", [&] { return bytes_of(file_->h5); });
    bytes += ending_of(bytes);
    write_file(path_, bytes);
}

bool Archive::has(std::string const& name) const {
    return guarded(path_, "read", [&] {
        for (std::size_t slash = name.find('/'); slash != std::string::npos;
             slash = name.find('/', slash + 1))
            if (std::string const group = name.substr(0, slash);
                !file_->h5.nameExists(group) || file_->h5.childObjType(group) != H5O_TYPE_GROUP)
                return false;
        return file_->h5.nameExists(name);
    });
}

std::vector<std::string> Archive::observables() const {
    std::vector<std::string> names;
    if (!has("observables")) return names;
    // a column counts as a list
    auto const add = [&](std::string const& name, std::string const& path) {
        H5::DataSet const set = file_->h5.openDataSet(path);
        H5::DataSpace const space = set.getSpace();
        std::array<hsize_t, 2> size{1, 1};
        bool const numbers = set.getTypeClass() == H5T_FLOAT || set.getTypeClass() == H5T_INTEGER;
        if (!numbers || space.getSimpleExtentNdims() > 2) return;
        space.getSimpleExtentDims(size.data());
        if (size[1] == 1) names.push_back(name);
    };
    std::function<void(std::string const&)> const look = [&](std::string const& group_name) {
        std::string const path = "observables" + (group_name.empty() ? "" : "/" + group_name);
        H5::Group const group = file_->h5.openGroup(path);
        for (hsize_t k = 0; k < group.getNumObjs(); ++k) {
            std::string const name = group.getObjnameByIdx(k), full = path + "/" + name,
                              below = group_name.empty() ? name : group_name + "/" + name;
            bool const is_group = file_->h5.childObjType(full) == H5O_TYPE_GROUP;
            if (!is_group)
                add(below, full);  // one value for all times
            else if (has(full + "/value"))
                add(below, full + "/value");
            else if (group_name.empty())
                look(name);  // of a subsystem
        }
    };
    return guarded(path_, "read", [&] {
        look("");
        return names;
    });
}

void Archive::operator()(std::string const& name, double& value) {
    std::vector<double> one{value};
    (*this)(name, one);
    if (one.size() != 1) refuse(name, "is not one number");
    value = one.front();
}

void Archive::operator()(std::string const& name, std::uint64_t& value) {
    std::vector<std::uint64_t> one{value};
    (*this)(name, one);
    if (one.size() != 1) refuse(name, "is not one number");
    value = one.front();
}

void Archive::operator()(std::string const& name, std::string& value) {
    guarded(path_, reading() ? "read" : "write", [&] {
        H5::DataSpace const scalar(H5S_SCALAR);
        if (reading())
            file_->h5.openDataSet(name).read(value, text_type());
        else
            create(file_->h5, name, text_type(), scalar).write(value, text_type());
    });
}

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
            H5::DataSpace const space = set.getSpace();
            hsize_t size[2];
            if (space.getSimpleExtentNdims() != 2) refuse(name, "is no table");
            space.getSimpleExtentDims(size);
            if (columns != Eigen::Dynamic && std::cmp_not_equal(size[0], columns))
                refuse(name, fmt::format("has {} columns, not {}", size[0], columns));
            check_is_there(set);
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

}  // namespace dpd
