// SPDX-License-Identifier: BSD-3-Clause
#include "field_lattice.hpp"

namespace roughmesh::detail {

std::string lattice_obstacle(const Correlation&) { return "the method lattice is not built yet"; }

PreparedField prepare_lattice(const Correlation& correlation, const FieldOptions&) {
  throw InputError(lattice_obstacle(correlation));
}

}  // namespace roughmesh::detail
