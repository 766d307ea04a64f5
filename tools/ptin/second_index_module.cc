// SPDX-License-Identifier: GPL-3.0-or-later
//
// second_index.so: the second index with libspatialindex. What it needs of storage it finds in the
// program that loads it (second_index.list), which is of the same build.
#include <memory>

#include "storage/spatialindex_rtree.h"

/// SpatialIndexRTree::open(), for dlsym(): the caller owns the result.
extern "C" __attribute__((visibility("default"))) ptin::RecordIndex* ptin_open_second_index(
    const std::shared_ptr<const ptin::StoreFile>& store, const ptin::SpatialIndexOptions& options) {
  return ptin::SpatialIndexRTree::open(store, options).release();
}
