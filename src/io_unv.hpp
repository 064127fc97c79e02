// SPDX-License-Identifier: BSD-3-Clause
// Parts of the UNV reader and writer. Format: I-deas universal files, "Universal Dataset Number"
// 781, 780, 2411, 2412, 2477 (https://www.ceas3.uc.edu/sdrluff/).
#pragma once

#include <optional>
#include <string_view>

#include "file_formats.hpp"
#include "node_orders.hpp"

namespace roughmesh::detail {

/// What a dataset of elements says by the number of a finite element descriptor.
struct UnvType {
  bool is_known = false;
  bool is_ignored = false;  ///< rigid bars, springs, dampers, gaps, masses: kept in the file only
  bool is_beam = false;     ///< has a line of three numbers more
  ElementType type = {};
};
UnvType unv_type(Tag descriptor);
/// The descriptor of new elements; 0 where the format has none.
int unv_descriptor(const ElementType& type, bool is_plane);
const NodeOrders& unv_node_orders();

void check_unv(const Mesh& mesh, const std::filesystem::path& path);
void write_new_unv(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

/// "1.0000000000000000D+00": 17 digits, which read back exactly.
std::string unv_real(double value, char exponent_letter);

}  // namespace roughmesh::detail
