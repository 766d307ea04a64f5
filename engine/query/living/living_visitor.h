// SPDX-License-Identifier: GPL-3.0-or-later
//
// Who takes the triangles of a place: of a file (LivingReader), or of a mesh in a browser, which knows
// no files.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/query/living/living_stars.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/living/raster_square.h"

namespace ptin {

/// Takes the triangles of a place.
class LivingVisitor {
 public:
  LivingVisitor() = default;
  LivingVisitor(const LivingVisitor&) = delete;
  LivingVisitor& operator=(const LivingVisitor&) = delete;
  virtual ~LivingVisitor() = default;
  /// Called once, before a page is read: about so many records are on the pages that will be, or samples
  /// of a raster in the place. False ends it.
  virtual bool expect(std::uint64_t /*records*/) { return true; }
  /// Called before the triangles of T0, and of each page or tile: at most so many come, and those that the
  /// level has not decided yet. False ends it.
  virtual bool begin(std::size_t /*most_triangles*/) { return true; }
  /// Called with what lives on a page of the stars that meet the box, of whose heights and triangles
  /// nothing more is asked yet. True: it took them; false: the triangles come one by one.
  virtual bool take_stars(const LivingStars& /*stars*/) { return false; }
  /// The same of the full TIN of a raster: called with the cells of a tile that meets the box.
  virtual bool take_cells(const RasterSquare& /*square*/) { return false; }
  virtual void take(const LivingTriangle& t) = 0;
};

/// A visitor made of two functions, begin() and take().
template <class Begin, class Take>
class VisitorOf final : public LivingVisitor {
 public:
  VisitorOf(const Begin& begin, const Take& take) : begin_(begin), take_(take) {}
  bool begin(std::size_t most_triangles) override { return begin_(most_triangles); }
  void take(const LivingTriangle& t) override { take_(t); }

 private:
  Begin begin_;
  Take take_;
};

}  // namespace ptin
