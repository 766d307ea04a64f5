// SPDX-License-Identifier: GPL-3.0-or-later
//
// A reference simplifier: small, slow and obviously right. It collapses vertices in a random order
// into random valid neighbours, and saturates the attributes as engine/DESIGN.md, section 2.2, says; so
// tests of queries need no builder.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/mesh/tin.h"
#include "storage/record.h"
#include "storage/store_file.h"
#include "storage/store_writer.h"

namespace ptin::reference {

/// A full TIN taken apart: what a store holds, and what it was made from.
struct Hierarchy {
  Tin full;
  StoreFacts facts;
  CoarsestTin t0;
  std::vector<VertexSplit> records;
  StarredRecords stars;  ///< The same records, as they were made; tests may change the others.
};

struct Options {
  double left =
      0.02;  ///< Stop when this share of the vertices is left (or no collapse is possible).
  bool measured =
      true;  ///< Measure errors at all samples; otherwise only at the vertex that goes (for speed).
};

/// A raster of width x height samples, `spacing` grid units apart, random smooth heights, `voids`
/// of them missing.
[[nodiscard]] Tin random_grid(std::mt19937_64& random, int width, int height, int spacing,
                              double voids);

/// The Delaunay triangulation of random points; some fall on a border, some together on a coarse
/// lattice.
[[nodiscard]] Tin random_points(std::mt19937_64& random, int count, int side);

[[nodiscard]] Hierarchy simplify(Tin full, std::mt19937_64& random, const Options& options = {});
/// The same with Options::measured off.
[[nodiscard]] inline Hierarchy simplify_unmeasured(Tin full, std::mt19937_64& random) {
  Options options;
  options.measured = false;
  return simplify(std::move(full), random, options);
}

/// Any of the above terrains, of moderate size.
[[nodiscard]] Hierarchy random_hierarchy(std::uint64_t seed);

/// Writes the store, in `segments` segments, under a name of its own; removed with the returned
/// object.
struct TemporaryStore {
  std::string path;
  explicit TemporaryStore(const Hierarchy& hierarchy, std::uint32_t page_bytes = 4096,
                          int segments = 3, const DirectoryOptions& directory = {});
  ~TemporaryStore();
  TemporaryStore(const TemporaryStore&) = delete;
  TemporaryStore& operator=(const TemporaryStore&) = delete;
  [[nodiscard]] std::shared_ptr<const StoreFile> open(
      PageAccess access = PageAccess::kMapped) const;
};

/// A triangle without numbering: keys of its corners counter-clockwise, smallest first, and its
/// class.
using Corners = std::tuple<VertexKey, VertexKey, VertexKey, TriangleClass>;
[[nodiscard]] Corners corners_of(const Tin& tin, TriangleId t);
/// All triangles that are alive, sorted: equal for equal TINs, however numbered.
[[nodiscard]] std::vector<Corners> canonical(const Tin& tin);

[[nodiscard]] CoarsestTin coarsest_of(const Tin& tin);

}  // namespace ptin::reference
