/// @file
/// Words that a figure's data files and pictures share.
#pragma once

#include <string>

#include "figure.hpp"

namespace dpd {

/// Name of a part of the data files, for gnuplot's `index`.
std::string part_name(std::string const& curve, Criterion const& criterion);

/// What a figure regenerates: "NG2007 Fig. 2", or what it is about where its number is none.
std::string source_of(Figure const& figure);

/// A caption broken into lines that fit below the plot.
std::string wrapped(std::string const& text);

}  // namespace dpd
