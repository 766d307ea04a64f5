// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/own_pixel_size.h"

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"

namespace ptin::tools {

namespace {

/// A count that the build wrote about its source; 0 when it wrote none.
/// @throws Error corruption  what stands there is no count
std::uint64_t source_count(const nlohmann::json& metadata, const char* key,
                           const std::string& path) {
  const auto source = metadata.find("source");
  if (source == metadata.end()) return 0;
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::corruption,
                "the metadata's " + what + "; ptin build did not write this, build the file anew",
                path);
  };
  if (!source->is_object()) refuse("\"source\" is no object");
  const auto count = source->find(key);
  if (count == source->end()) return 0;
  if (!count->is_number_unsigned()) refuse(std::string("\"").append(key) + "\" is no count");
  return count->get<std::uint64_t>();
}

}  // namespace

std::array<double, 2> own_pixel_size(const StoreFile& store) {
  const StoreFacts& facts = store.facts();
  const nlohmann::json metadata = metadata_of(store);
  const auto number = [&](const char* key) { return source_count(metadata, key, store.path()); };
  const std::uint64_t samples =
      facts.source_samples + number("void_samples") + number("lone_samples");
  const std::uint64_t places =
      (static_cast<std::uint64_t>(facts.bounds.max_x - facts.bounds.min_x) + 1) *
      (static_cast<std::uint64_t>(facts.bounds.max_y - facts.bounds.min_y) + 1);
  if (samples < places) {
    throw Error(ErrorCode::invalid_argument,
                "this terrain was not built from a raster, so it has no pixel size of its own; "
                "give --pixel-size",
                store.path());
  }
  return {facts.map.step_x, facts.map.step_y};
}

}  // namespace ptin::tools
