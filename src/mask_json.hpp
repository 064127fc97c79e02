// SPDX-License-Identifier: BSD-3-Clause
// Masks as tables of a job file: { kind = "box", min = [0, 0, 0], max = [1, 1, 1], fade = 0.1 }.
#pragma once

#include <stdexcept>

#include <nlohmann/json.hpp>

#include "roughmesh/options.hpp"

namespace roughmesh::detail {

/// A table that is no mask; what() says what is expected.
struct WrongMask : std::runtime_error {
  using std::runtime_error::runtime_error;
};

nlohmann::ordered_json mask_to_json(const Mask& mask);

/// @throws WrongMask
Mask mask_from_json(const nlohmann::json& table);

}  // namespace roughmesh::detail
