/// @file
/// HDF5: metadata of H5MD.

#include "hdf5.hpp"

#include "version.hpp"

namespace dpd::hdf5 {
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

}  // namespace

void write_h5md_metadata(H5::H5File& file) {
    H5::Group const h5md = file.createGroup("h5md");
    set_attribute(h5md, "version", std::vector<std::int32_t>{1, 1});
    set_attribute(h5md.createGroup("author"), "name", std::string("dpdref"));
    H5::Group const creator = h5md.createGroup("creator");
    set_attribute(creator, "name", std::string("dpdref"));
    set_attribute(creator, "version", std::string(version));
}

}  // namespace dpd::hdf5
