/// @file
/// HDF5: metadata of H5MD.

#include "hdf5.hpp"

#include <atomic>

#include "version.hpp"

namespace dpd::hdf5 {
namespace {

void set_attribute(H5::H5Object const& object, std::string const& name, std::string const& value) {
    object.createAttribute(name, text_type(), H5::DataSpace(H5S_SCALAR)).write(text_type(), value);
}

void set_attribute(H5::H5Object const& object, std::string const& name,
                   std::vector<std::int32_t> const& value) {
    hsize_t const size = value.size();
    object.createAttribute(name, H5::PredType::NATIVE_INT32, H5::DataSpace(1, &size))
        .write(H5::PredType::NATIVE_INT32, value.data());
}

// The library tells files in memory apart by their names.
std::string unused_name() {
    static std::atomic<unsigned long> count = 0;
    return fmt::format("in memory {}", ++count);
}

H5::FileAccPropList in_memory() {
    constexpr std::size_t step = std::size_t{1} << 16;
    H5::FileAccPropList properties;
    properties.setCore(step, false);
    return properties;
}

}  // namespace

H5::H5File create_in_memory() {
    return {unused_name(), H5F_ACC_TRUNC, H5::FileCreatPropList::DEFAULT, in_memory()};
}

std::string bytes_of(H5::H5File& file) {
    file.flush(H5F_SCOPE_GLOBAL);
    auto const size = H5Fget_file_image(file.getId(), nullptr, 0);
    if (size < 0) throw H5::FileIException("bytes_of", "no image");
    std::string bytes(static_cast<std::size_t>(size), '\0');
    if (H5Fget_file_image(file.getId(), bytes.data(), bytes.size()) != size)
        throw H5::FileIException("bytes_of", "no image");
    return bytes;
}

H5::H5File open_bytes(std::string const& bytes) {
    auto properties = in_memory();
    // copied by the library, which does not write to it
    if (H5Pset_file_image(properties.getId(), const_cast<char*>(bytes.data()), bytes.size()) < 0)
        throw H5::FileIException("open_bytes", "no image");
    return {unused_name(), H5F_ACC_RDONLY, H5::FileCreatPropList::DEFAULT, properties};
}

void check_is_there(H5::DataSet const& set) {
    constexpr std::uint64_t packed = 2000;  // values per byte; no filter packs tighter
    if (std::uint64_t(set.getSpace().getSimpleExtentNpoints()) > packed * (set.getStorageSize() + 1))
        throw H5::DataSetIException("read", "more values than bytes");
}

void write_h5md_metadata(H5::H5File& file) {
    H5::Group const h5md = file.createGroup("h5md");
    set_attribute(h5md, "version", std::vector<std::int32_t>{1, 1});
    set_attribute(h5md.createGroup("author"), "name", std::string("dpdref"));
    H5::Group const creator = h5md.createGroup("creator");
    set_attribute(creator, "name", std::string("dpdref"));
    set_attribute(creator, "version", std::string(version));
}

}  // namespace dpd::hdf5
