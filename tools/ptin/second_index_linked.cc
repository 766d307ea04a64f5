// SPDX-License-Identifier: GPL-3.0-or-later
//
// The second index of programs that link libspatialindex: tests, benchmarks, and what is built for
// sanitizers.
#include "tools/second_index.h"

namespace ptin::tools {

std::unique_ptr<RecordIndex> open_second_index(const std::shared_ptr<const StoreFile>& store,
                                               const SpatialIndexOptions& options) {
  return SpatialIndexRTree::open(store, options);
}

}  // namespace ptin::tools
