// SPDX-License-Identifier: GPL-3.0-or-later
//
// The triangles of a TIN that meet a place, page by page, in constant memory.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "engine/query/living/level_stars.h"
#include "engine/query/living/living_visitor.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "storage/floor.h"

namespace ptin {

/// Which triangles of a TIN are wanted. What is borrowed is borrowed for the call.
struct LivingPlace {
  GridBox box;  ///< Grid units, closed: triangles whose box meets it.
  /// Codes: triangles whose corners span an interval that meets it. The default wants void
  /// triangles too.
  Interval heights = kAllHeights;
  /// A further condition of pages (StarFilter::also); borrowed; null: none.
  const StarPredicate* stars = nullptr;
  bool asks_each_star = false;  ///< LivingFilter::each is `stars`.
  /// Ascending ordered heights, borrowed: triangles with a step within what their corners span
  /// (steps_within()). Empty: all.
  std::span<const std::uint64_t> steps;
  /// A further condition of a triangle; none: all are wanted.
  std::function<bool(const LivingTriangle&)> wanted;
};

/// Reads places of the TIN of one level of detail, one after the other. Threads: one owner.
class LivingReader {
 public:
  /// @param terrain, detail  Borrowed for the life of the reader.
  LivingReader(const OpenedTerrain& terrain, const Detail& detail)
      : terrain_(terrain),
        store_(terrain.store()),
        heights_(store_.facts().heights),
        stars_(store_, detail) {}

  /// Hands each triangle of a place to the visitor once: those of T0, then page by page in the order
  /// of the file, then those that the level tells last; of the full TIN of a raster tile by tile along
  /// the curve (floor_cells.h). False when the visitor ended it.
  /// @throws Error corruption, io_error, cancelled; resource_exhausted where a number of vertices cuts
  ///     between more records of one error than fit the memory; what the visitor throws
  /// Cost: a search of the index and the pages with such stars, or tiles, announced together. Memory: one
  /// page; where a number of vertices cuts between records of one error, besides the triangles of
  /// the place that die at that error.
  bool read(const LivingPlace& place, QueryContext& context, LivingVisitor& visitor);

 private:
  bool read_floor(const Floor& floor, const LivingPlace& place, QueryContext& context,
                  LivingVisitor& visitor);
  [[nodiscard]] bool asks_directory() const;
  template <class Page>
  bool take_all(std::span<const Page> pages, std::uint64_t records, const LivingPlace& place,
                QueryContext& context, LivingVisitor& visitor);
  template <class Page>
  bool take_page(const Page& page, const LivingPlace& place, QueryContext& context,
                 LivingVisitor& visitor);
  [[nodiscard]] bool is_wanted(const LivingTriangle& t, const LivingPlace& place) const;

  const OpenedTerrain& terrain_;
  const StoreFile& store_;
  HeightEncoding heights_;
  LivingFilter filter_;
  Floor::Recent recent_;
  LevelStars stars_;
};

}  // namespace ptin
