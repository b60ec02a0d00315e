/// @file
/// Positions and velocities of particles in the files of others: H5MD, extended XYZ, LAMMPS data.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace dpd {

/// Where particles are and how they move. Arrays are particles x dimension, one particle after the other, in
/// the order of their ids where the file has some.
struct Configuration {
    std::vector<double> length;    ///< sides of the box
    std::vector<double> position;  ///< from the lower corner of the box; not folded back into it
    std::vector<double> velocity;  ///< empty: the file has none
};

/// The last frame of a file whose bytes these are. What they are, the end of `name` says: .h5, .h5md or
/// .hdf5, .xyz or .extxyz, .data or .lmp. InputError, naming the file, for what is not of so many particles
/// in so many dimensions, in a box with right angles, all of it finite.
Configuration read_configuration(std::string_view bytes, std::string const& name, std::size_t particles,
                                 std::size_t dimension);

}  // namespace dpd
