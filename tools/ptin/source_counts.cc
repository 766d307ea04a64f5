// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/source_counts.h"

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

bool has_surface(const StoreFile& store) {
  const StoreFacts& facts = store.facts();
  if (facts.free_of_voids) return true;
  return facts.min_height <= facts.max_height &&
         (facts.source_samples == 0 || facts.source_samples > source_count(store, "lone_samples"));
}

}  // namespace ptin::tools
