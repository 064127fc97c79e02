// SPDX-License-Identifier: BSD-3-Clause
// Job files: what is read is checked, and comes out of a report as it went in.
#include <cstdlib>

#include "roughmesh/options.hpp"

#include "input_file.hpp"
#include "options_json.hpp"
#include "readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace roughmesh;
  fuzz::run([&] {
    const RoughenOptions options = read_job(fuzz::input_file(data, size));
    const nlohmann::ordered_json json = detail::options_to_json(options);
    const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    detail::options_from_json(nlohmann::json::parse(text), "report");
    if (options.surfaces.empty()) std::abort();
    for (const Roughness& roughness : options.surfaces) mask_options(roughness);
  });
  return 0;
}
