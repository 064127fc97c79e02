// SPDX-License-Identifier: BSD-3-Clause
// Parts of the Nastran bulk data reader and writer. Format: MSC Nastran Quick Reference Guide,
// "Bulk Data Entries" (also Simcenter Nastran and OptiStruct, which read the same).
#pragma once

#include <list>
#include <string>
#include <string_view>
#include <vector>

#include "file_formats.hpp"
#include "node_orders.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

/// One entry of the bulk data with its continuation lines. Field 0 is the name; a line of small
/// fields and one of free ones hold eight more, a line of large fields four.
struct BulkCard {
  std::string name;                      ///< in capitals, without "*"
  bool has_free = false;                 ///< a line of it is in free fields
  bool has_fixed = false;                ///< a line of it is in small or large ones
  std::vector<std::string_view> fields;  ///< without space; data() is null where the line has ended
  std::vector<std::string_view> lines;   ///< of the file, without their ends
  std::vector<bool> is_large;            ///< of each line
  std::list<std::string> expanded;       ///< lines with tabs, which go to the next multiple of 8

  void clear();
  std::string_view field(std::size_t i) const {
    return i < fields.size() ? fields[i] : std::string_view();
  }
};

/// Reads the entries of the bulk data one after the other.
class BulkReader {
 public:
  explicit BulkReader(const FileBytes& file) : scanner_(file) {}

  Scanner& scanner() { return scanner_; }
  /// Behind BEGIN BULK, or at the start of a file that has none.
  void move_to_bulk();
  /// The next entry; false at ENDDATA and at the end. Comments go to comment(), if they stand
  /// before the first line of the entry.
  bool next(BulkCard& card);
  const std::vector<std::string_view>& comments() const { return comments_; }

 private:
  void add_line(BulkCard& card, std::string_view line) const;

  Scanner scanner_;
  std::vector<std::string_view> comments_;
};

/// Part of a line before a comment.
std::string_view without_comment(std::string_view line);

std::string nastran_real(double value);     ///< decimals that read back exactly, with a point
std::string nastran_real_16(double value);  ///< as many digits as 16 characters hold
/// A unit of the last digit of nastran_real_16 for numbers of this size.
double spacing_16(double value);

const NodeOrders& nastran_node_orders();

void write_patched_nastran(const Mesh& mesh, OutputFile& output);
/// 0 where each GRID is in free fields, which hold all digits.
double nastran_spacing(const Mesh& mesh);
double new_nastran_spacing(const Mesh& mesh);

void check_nastran(const Mesh& mesh, const std::filesystem::path& path);
void write_new_nastran(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
