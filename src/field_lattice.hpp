// SPDX-License-Identifier: BSD-3-Clause
// The sampling method `lattice`: white noise on lattices under Gaussian kernels, linear in the
// number of points.
#pragma once

#include <string>

#include "field_method.hpp"

namespace roughmesh::detail {

/// Why the method cannot sample this correlation, with the way out; empty if it can.
std::string lattice_obstacle(const Correlation& correlation);

/// @throws InputError  a correlation with an obstacle; a tolerance below 1e-8; a cutoff that leaves
/// nothing; places too far
///                     from the origin to be told apart at this tolerance; too little free memory
PreparedField prepare_lattice(const Correlation& correlation, const FieldOptions& options);

}  // namespace roughmesh::detail
