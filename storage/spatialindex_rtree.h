// SPDX-License-Identifier: GPL-3.0-or-later
//
// The second implementation of RecordIndex: libspatialindex's disk R-tree, bulk-loaded beside the
// file on demand.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "storage/index.h"
#include "storage/store_file.h"

namespace ptin {

struct SpatialIndexOptions {
  /// The tree is in BASE.dat and BASE.idx. Empty: the store's path with ".sidx" behind it.
  std::string base = {};
  /// Where the bulk loader's external sorter writes when it needs more than `memory_bytes`. Empty:
  /// the folder of `base`.
  std::string temporary_folder = {};
  std::uint64_t memory_bytes = std::uint64_t{256} << 20;
};

/// An R-tree over the boxes of the record pages in four dimensions (x, y, height codes, [0,
/// error]), packed by sort-tile-recursive. A search asks the predicate of the boxes of nodes, with
/// an infinite deviation, since deviation is no dimension of the tree. For the pages in a leaf it
/// asks the predicate of the descriptors, exactly. So the answers are those of the packed R-tree.
///
/// The tree is built when it is not there, when it is of another store (its first page holds the
/// store's fingerprint), or when its table of pages is damaged. It is a cache: written under
/// temporary names and renamed, but not synced. Every page carries a checksum, verified whenever it
/// is read.
///
/// Threads: searches take turns, since libspatialindex reads through one stream.
class SpatialIndexRTree final : public RecordIndex {
 public:
  /// Opens the tree of `store`, and builds it first where that is needed. Shares `store`.
  /// @throws Error io_error, resource_exhausted, not_found (no such folder), corruption (of the
  /// store)
  static std::unique_ptr<SpatialIndexRTree> open(std::shared_ptr<const StoreFile> store,
                                                 const SpatialIndexOptions& options = {});
  ~SpatialIndexRTree() override;

  /// As RecordIndex::search.  @throws Error corruption (of the tree, too), io_error
  void search(const AttributePredicate& predicate, std::vector<PageId>& pages,
              IoCounters& counters) const override;

  /// Whether open() had to build the tree.
  [[nodiscard]] bool was_built() const noexcept;

 private:
  struct Tree;
  explicit SpatialIndexRTree(std::unique_ptr<Tree> tree);
  std::unique_ptr<Tree> tree_;
};

}  // namespace ptin
