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

/// What both indexes have in common: the packed R-tree (storage/packed_rtree.h, the default) and
/// libspatialindex's bulk-loaded disk R-tree (storage/spatialindex_rtree.h). Threads: const,
/// callable from several threads at once.
class RecordIndex {
 public:
  RecordIndex() = default;
  RecordIndex(const RecordIndex&) = delete;
  RecordIndex& operator=(const RecordIndex&) = delete;
  virtual ~RecordIndex() = default;

  /// Appends to `pages` the pages whose attributes, the union and maximum over their records,
  /// satisfy `predicate`: each once, ascending, and no others. Since the predicate is monotone,
  /// every page with a record that satisfies it is among them.
  /// @throws Error corruption, io_error
  virtual void search(const AttributePredicate& predicate, std::vector<PageId>& pages,
                      IoCounters& counters) const = 0;
};

}  // namespace ptin
