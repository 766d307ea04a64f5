// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/facts/source_count.h"

#include <string>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"

namespace ptin::tools {

std::uint64_t source_count(const StoreFile& store, const char* key) {
  const nlohmann::json metadata = metadata_of(store);
  const auto source = metadata.find("source");
  if (source == metadata.end()) return 0;
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::corruption,
                "the metadata's " + what + "; ptin build did not write this, build the file anew",
                store.path());
  };
  if (!source->is_object()) refuse("\"source\" is no object");
  const auto count = source->find(key);
  if (count == source->end()) return 0;
  if (!count->is_number_unsigned()) refuse(std::string("\"").append(key) + "\" is no count");
  return count->get<std::uint64_t>();
}

std::optional<MapPoint> own_pixel_of(const StoreFile& store) {
  const StoreFacts& facts = store.facts();
  const std::uint64_t samples = facts.source_samples + source_count(store, "void_samples") +
                                source_count(store, "lone_samples");
  const std::uint64_t places =
      (static_cast<std::uint64_t>(facts.bounds.max_x - facts.bounds.min_x) + 1) *
      (static_cast<std::uint64_t>(facts.bounds.max_y - facts.bounds.min_y) + 1);
  if (samples < places) return std::nullopt;
  return MapPoint{facts.map.step_x, facts.map.step_y};
}

}  // namespace ptin::tools
