// SPDX-License-Identifier: BSD-3-Clause
#include "hash.hpp"

#define XXH_INLINE_ALL  // nothing to link, and no symbols that clash with another copy
#include <xxhash.h>

namespace roughmesh::detail {

std::uint64_t hash(std::string_view bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace roughmesh::detail
