// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/error.hpp"

#include <algorithm>
#include <utility>

namespace roughmesh {
namespace {

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }, '?');
  return text;
}

}  // namespace

Error::Error(std::string message) : std::runtime_error(one_line(std::move(message))) {}

}  // namespace roughmesh
