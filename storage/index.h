// SPDX-License-Identifier: GPL-3.0-or-later
//
// The index: from a monotone predicate to the record pages that may hold a record for which it is
// true.
#pragma once

#include <vector>

#include "storage/attributes.h"
#include "storage/file/io_counters.h"
#include "storage/page_store.h"

namespace ptin {

/// The small concept behind both indexes: the packed R-tree (packed_rtree.h, the default) and
/// libspatialindex's bulk-loaded disk R-tree (spatialindex_rtree.h). Threads: const, callable from
/// several threads at once.
class RecordIndex {
 public:
  RecordIndex() = default;
  RecordIndex(const RecordIndex&) = delete;
  RecordIndex& operator=(const RecordIndex&) = delete;
  virtual ~RecordIndex() = default;

  /// Pages whose attributes satisfy `predicate`, ascending, each once. Every page with a record
  /// that satisfies it is there; no page is there whose own attributes (the union over its records)
  /// do not.
  /// @throws Error corruption
  virtual void search(const AttributePredicate& predicate, std::vector<PageId>& pages,
                      IoCounters& counters) const = 0;
};

}  // namespace ptin
