// SPDX-License-Identifier: GPL-3.0-or-later
//
// libspatialindex's tree in the place of the packed R-tree, for whoever asks for it.
#pragma once

#include <memory>

#include "storage/index.h"
#include "storage/spatialindex_rtree.h"
#include "storage/store_file.h"

namespace ptin::tools {

/// SpatialIndexRTree::open(). The program links no libspatialindex: it loads second_index.so, which
/// lies beside the whole program and does (tools/ptin/second_index_loaded.cc). Tests link it
/// (second_index_linked.cc).
/// @throws Error as SpatialIndexRTree::open(); not_found where the library is not installed
[[nodiscard]] std::unique_ptr<RecordIndex> open_second_index(
    const std::shared_ptr<const StoreFile>& store, const SpatialIndexOptions& options);

}  // namespace ptin::tools
