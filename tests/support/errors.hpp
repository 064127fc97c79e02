// SPDX-License-Identifier: BSD-3-Clause
// What a refusal says.
#pragma once

#include <functional>
#include <string>

#include "roughmesh/error.hpp"

namespace roughmesh::test {

/// Message of the InputError that the action throws.
inline std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace roughmesh::test
