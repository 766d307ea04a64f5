// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/source_counts.h"

namespace ptin::tools {

bool has_surface(const StoreFile& store) {
  const StoreFacts& facts = store.facts();
  if (facts.free_of_voids) return true;
  return facts.min_height <= facts.max_height &&
         (facts.source_samples == 0 || facts.source_samples > source_count(store, "lone_samples"));
}

}  // namespace ptin::tools
