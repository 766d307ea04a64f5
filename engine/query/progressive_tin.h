// SPDX-License-Identifier: GPL-3.0-or-later
//
// ProgressiveTin: the one object behind the program, the service and any binding. Plain requests
// in, plain results out.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/mesh/tin.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/predicate.h"
#include "storage/index.h"
#include "storage/store_file.h"

namespace ptin {

/// Whether the result covers the whole domain (coarse outside of the region) or keeps the triangles
/// that meet the region.
enum class ResultForm { kWholeDomain, kMeetingRegion };

struct RefineRequest {
  /// Where to refine; none means everywhere. Window, point, segment or polygon, in map units
  /// (predicate.h).
  std::optional<Region> region;
  /// Certified error asked for, in the height's unit, >= 0. None means every record: the full TIN.
  /// 0 means every sample exact: flat and coplanar parts stay coarse.
  std::optional<double> tolerance;
  /// Exactly this many vertices of the mesh, T0 and void ones counted (within the region: its most
  /// important records). Excludes `tolerance`. More than there are gives all of them, and
  /// RefinedTin::exact. Counted before triangles outside of the region are left out
  /// (kMeetingRegion).
  std::optional<std::uint64_t> vertices;
  /// Any further monotone predicate; intersected with the above. Borrowed for the call.
  const AttributePredicate* also = nullptr;
  ResultForm form = ResultForm::kWholeDomain;  ///< Without a region both forms are the same.
  bool page_of_triangle = false;               ///< Fill RefinedTin::page_of_triangle.
  /// Bytes that the query may take for records and mesh; known from the index before anything is
  /// read.
  std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30;
  std::stop_token stop;
};

/// A refined TIN. Positions are grid positions; `map` and `heights` of the store turn them into map
/// units.
struct RefinedTin {
  Tin tin;  ///< Compact: every vertex and triangle is alive (kMeetingRegion: renumbered).
  std::vector<std::uint32_t> page_of_triangle;  ///< Filled on request (render --pages): page of the
                                                ///< record that made it, or kNone.
  std::uint64_t vertices = 0;                   ///< Of the mesh, void ones included.
  std::uint64_t void_vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t t0_vertices = 0;
  /// Bound at every sample in the region (everywhere when there is none); >= base_error.
  double certified_error = 0.0;
  double certified_deviation = 0.0;  ///< Bound at any point, likewise.
  /// Every triangle that meets the region is one of the full TIN, and base_error is 0.
  bool exact = false;
  QueryCost cost;
};

/// A progressive TIN on disk. Keeps T0, the map and the upper index levels it touched; everything
/// else is paged. Threads: all functions are const and may be called at once; no query blocks
/// another.
class ProgressiveTin {
 public:
  struct OpenOptions {
    PageAccess access = PageAccess::kMapped;
  };
  /// @throws Error as StoreFile::open
  static ProgressiveTin open(const std::string& path) { return open(path, OpenOptions{}); }
  static ProgressiveTin open(const std::string& path, const OpenOptions& options);
  /// @throws Error corruption when the stored T0 is not a valid TIN
  explicit ProgressiveTin(std::shared_ptr<const StoreFile> store);

  [[nodiscard]] const StoreFile& store() const noexcept { return *store_; }
  /// T0 with neighbours: what every question starts from a copy of.
  [[nodiscard]] const Tin& t0() const noexcept { return *t0_; }
  /// The index in use.
  [[nodiscard]] const RecordIndex& index() const noexcept {
    return index_ ? *index_ : store_->index();
  }

  /// Uses `index` instead of the packed R-tree (the same answers; tests and `--index
  /// spatialindex`). Not thread-safe.
  void use_index(std::shared_ptr<const RecordIndex> index);

  /// Refines T0: retrieves the records for which the request's predicate is true, sorts them by
  /// rank (counting sort), applies them. Exact (P1), certified (P2), valid (P3), closed and lean
  /// (P4), joined (P5).
  /// @throws Error invalid_argument    tolerance negative or NaN; `vertices` below |T0|; both
  ///                                   given; region not finite
  ///               resource_exhausted  the index says that the answer exceeds memory_limit_bytes;
  ///                                   names `export`
  ///               corruption, io_error, cancelled
  /// Cost: k records retrieved: O(|T0| + k) time and memory; index pages usually O(k / B + log_B
  /// n).
  [[nodiscard]] RefinedTin refine(const RefineRequest& request) const;

 private:
  std::shared_ptr<const StoreFile> store_;
  std::shared_ptr<const Tin> t0_;             ///< T0 with neighbours; a query starts from a copy.
  std::shared_ptr<const RecordIndex> index_;  ///< Null: the store's own.
};

}  // namespace ptin
