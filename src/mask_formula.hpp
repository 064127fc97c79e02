// SPDX-License-Identifier: BSD-3-Clause
// Expressions in the position and normal of a point, read by muparser
// (https://github.com/beltoforion/muparser).
#pragma once

#include <memory>
#include <string>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// An expression in the grammar of FormulaMask. Its text can do nothing but compute: assignment,
/// strings and every function that is not listed there are refused. For one thread at a time.
class MaskFormula {
 public:
  /// @throws InputError  not such an expression: names it, the character and what to write instead
  explicit MaskFormula(const std::string& expression);
  ~MaskFormula();
  MaskFormula(const MaskFormula&) = delete;
  MaskFormula& operator=(const MaskFormula&) = delete;

  /// The value at a point, depending on nothing else; may be infinite or not a number.
  double value(const Vec3& point, const Vec3& normal);

  /// @throws InputError  always: the formula is not a number at this point
  [[noreturn]] void refuse_value(const Vec3& point) const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace roughmesh::detail
