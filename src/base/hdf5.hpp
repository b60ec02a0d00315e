/// @file
/// What the files of arrays, trajectories and configurations share of the HDF5 library; seen by no other file.
#pragma once

#include <H5Cpp.h>
#include <fmt/format.h>

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "errors.hpp"

namespace dpd::hdf5 {

// The HDF5 library keeps global state and is not built thread-safe; runs of a campaign take turns.
inline std::recursive_mutex library;

template <class T>
H5::PredType const& type_of() {
    if constexpr (std::same_as<T, double>) return H5::PredType::NATIVE_DOUBLE;
    if constexpr (std::same_as<T, std::uint64_t>) return H5::PredType::NATIVE_UINT64;
    if constexpr (std::same_as<T, std::uint32_t>) return H5::PredType::NATIVE_UINT32;
    if constexpr (std::same_as<T, std::int32_t>) return H5::PredType::NATIVE_INT32;
}

inline H5::StrType text_type() { return {H5::PredType::C_S1, H5T_VARIABLE}; }

// Runs `action`; an HDF5 error becomes one line that names the file.
template <class Action>
auto guarded(std::filesystem::path const& path, char const* verb, Action&& action) {
    std::scoped_lock const lock(library);
    H5::Exception::dontPrint();
    try {
        return action();
    } catch (H5::Exception const& error) {
        throw Damaged(fmt::format("{}: cannot {}: {}", path.string(), verb, error.getDetailMsg()));
    }
}

// A new file that is in memory only.
H5::H5File create_in_memory();

// The bytes of a file that is in memory.
std::string bytes_of(H5::H5File& file);

// A file in memory for reading.
H5::H5File open_bytes(std::string const& bytes);

inline H5::LinkCreatPropList with_groups() {
    H5::LinkCreatPropList properties;
    properties.setCreateIntermediateGroup(true);
    return properties;
}

inline H5::DataSet create(H5::H5File& file, std::string const& name, H5::DataType const& type,
                          H5::DataSpace const& space,
                          H5::DSetCreatPropList const& properties = H5::DSetCreatPropList::DEFAULT) {
    return file.createDataSet(name, type, space, properties, H5::DSetAccPropList::DEFAULT, with_groups());
}

// A data set may declare more values than its file holds; memory for them is not taken. H5::Exception.
void check_is_there(H5::DataSet const& set);

template <class T>
void vector_io(H5::H5File& file, bool reading, std::string const& name, std::vector<T>& values) {
    if (reading) {
        H5::DataSet const set = file.openDataSet(name);
        check_is_there(set);
        values.resize(static_cast<std::size_t>(set.getSpace().getSimpleExtentNpoints()));
        if (!values.empty()) set.read(values.data(), type_of<T>());
    } else {
        hsize_t const size = values.size();
        H5::DataSet const set = create(file, name, type_of<T>(), H5::DataSpace(1, &size));
        if (!values.empty()) set.write(values.data(), type_of<T>());
    }
}

// The root metadata that H5MD 1.1 asks for.
void write_h5md_metadata(H5::H5File& file);

}  // namespace dpd::hdf5
