// SPDX-License-Identifier: BSD-3-Clause
// Options as a JSON object, for job files and reports. Private: the public headers know no JSON
// library.
#pragma once

#include <nlohmann/json.hpp>

#include "roughmesh/options.hpp"

namespace roughmesh::detail {

/// Every option as used, absent ones as null.
nlohmann::ordered_json options_to_json(const RoughenOptions& options);

/// The other way. @throws InputError  unknown key or value of the wrong type, naming `source`
RoughenOptions options_from_json(const nlohmann::json& object, const std::string& source);

}  // namespace roughmesh::detail
