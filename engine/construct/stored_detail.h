// SPDX-License-Identifier: GPL-3.0-or-later
//
// What of a build's records and deaths a file keeps: the rounding of heights is added, bounds become
// short numbers, and the finest detail is left out (engine/DESIGN.md, section 2.7).
#pragma once

#include "engine/construct/hierarchy/segment.h"
#include "storage/star.h"

namespace ptin {

/// One rule for errors and for deaths, each of which is the error of a record: a triangle whose
/// successor is left out is one of the file's finest TIN.
struct StoredDetail {
  double height_rounding = 0.0;  ///< Most that storing a height rounds it, height's unit.
  double max_error = 0.0;        ///< BuildOptions::max_error; 0: nothing is left out.

  /// An error or deviation with the rounding, as a short number (storage/short_float.h). REQUIRES: bound >= 0 or +infinity.
  [[nodiscard]] float rounded(float bound) const noexcept;
  /// True for the error of a record, the rounding included, that the file leaves out.
  [[nodiscard]] bool leaves_out(float error) const noexcept;
  /// A death as the file has it, from that of the build.
  [[nodiscard]] float death(float built) const noexcept;

  /// Adds the rounding to errors and deviations, and gives the triangles their deaths.
  void add_rounding(StarredRecords& records) const noexcept;
  /// Leaves records out with their stars; the others keep their order. To be called after
  /// add_rounding(). Those kept are the records of the monotone predicate error > max_error, which
  /// are closed. Returns the largest error and deviation of those left out; 0 when none is.
  RecordBounds leave_out(StarredRecords& records) const noexcept;
};

}  // namespace ptin
