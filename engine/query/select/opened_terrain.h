// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file of a terrain, opened: what every question starts from.
#pragma once

#include <memory>
#include <string>

#include "engine/mesh/tin.h"
#include "engine/query/select/retrieval.h"
#include "storage/index.h"
#include "storage/store_file.h"

namespace ptin {

/// A store, its T0 as a mesh, and the index that searches use. T0, the map, and those upper levels
/// of the index that were touched stay in memory; everything else is paged. A copy shares all of
/// them.
/// Threads: all functions but use_index() and use_floor() are const and may be called at once.
class OpenedTerrain {
 public:
  /// @throws Error as StoreFile::open; corruption when the stored T0 is not a valid TIN
  explicit OpenedTerrain(const std::string& path, PageAccess access = PageAccess::kMapped,
                         ReplacedFile replaced = ReplacedFile::kRefused);
  /// @throws Error corruption when the stored T0 is not a valid TIN
  explicit OpenedTerrain(std::shared_ptr<const StoreFile> store);

  [[nodiscard]] const StoreFile& store() const noexcept { return *store_; }
  /// T0 with neighbours. Every question starts from a copy of it.
  [[nodiscard]] const Tin& t0() const noexcept { return *t0_; }
  /// The index in use.
  [[nodiscard]] const RecordIndex& index() const noexcept {
    return index_ ? *index_ : store_->index();
  }
  /// Whether another index than the packed R-tree is in use.
  [[nodiscard]] bool uses_other_index() const noexcept { return index_ != nullptr; }
  /// The store and the index in use, borrowed from this object.
  [[nodiscard]] RecordSource record_source() const noexcept { return {*store_, index()}; }

  /// Uses `index` instead of the packed R-tree, for tests and `--index spatialindex`; the answers
  /// are the same. Terrain's questions go by it; free functions that look up stars do not. Null: the
  /// packed R-tree again. Not thread-safe.
  void use_index(std::shared_ptr<const RecordIndex> index);

  /// The heights of a raster, from which the full TIN follows; null: the file has none, or stars are to
  /// answer, or another index is in use, which is asked for records.
  /// @throws Error as StoreFile::floor()
  [[nodiscard]] const Floor* floor() const {
    return uses_floor_ && !uses_other_index() ? store_->floor() : nullptr;
  }
  /// Has the full TIN answered from the heights of a raster, where the file has them, or from stars as a
  /// level is, for tests and `--by stars`; the answers are the same. Not thread-safe.
  void use_floor(bool uses) noexcept { uses_floor_ = uses; }

 private:
  std::shared_ptr<const StoreFile> store_;
  std::shared_ptr<const Tin> t0_;             ///< T0 with neighbours; a query starts from a copy.
  std::shared_ptr<const RecordIndex> index_;  ///< Null: the store's own.
  bool uses_floor_ = true;
};

}  // namespace ptin
