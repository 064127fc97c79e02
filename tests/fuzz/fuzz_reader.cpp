// SPDX-License-Identifier: BSD-3-Clause
// Entry point of libFuzzer, compiled once for each kind of mesh file: ROUGHMESH_FUZZ_EXTENSION.
#include <cstddef>
#include <cstdint>

#include "readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  roughmesh::fuzz::run([&] { roughmesh::fuzz::read_and_write(bytes, ROUGHMESH_FUZZ_EXTENSION); });
  return 0;
}
