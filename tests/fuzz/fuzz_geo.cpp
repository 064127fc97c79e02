// SPDX-License-Identifier: BSD-3-Clause
// The check of geometry scripts and of STEP files, which hostile files reach before gmsh does.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "geo_script.hpp"
#include "step_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace roughmesh::detail;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  find_unsafe(bytes);
  makes_mesh(bytes);
  is_step(bytes);
  step_length_unit(bytes);
  return 0;
}
