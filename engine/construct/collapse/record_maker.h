// SPDX-License-Identifier: GPL-3.0-or-later
//
// Makes the saturated record of a collapse and carries it out.
#pragma once

#include <vector>

#include "engine/construct/collapse/sample_hand_over.h"
#include "engine/construct/measure/fan_error.h"
#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"
#include "engine/mesh/collapse.h"

namespace ptin {

/// One a thread; keeps scratch buffers.
class RecordMaker {
 public:
  /// @param tile  Must outlive this object.
  /// @param full  The full surface under a tile that holds all samples of its window: `error` and
  ///     `deviation` of a record are measured to the end and saturated. Null for a tile that holds
  ///     carried samples: `error` of a record is its own part alone and `deviation` is 0; the rest is
  ///     for tightening (construct/hierarchy/tighten.h).
  RecordMaker(Tile& tile, const FullSurface* full) : tile_(tile), full_(full) {}

  /// Collapses the centre of `s` into link[j]: appends the record (its own part, and the union and
  /// maximum of what the star carries: engine/DESIGN.md, section 2.2) and its star, hands the
  /// samples of the star to the fan, and changes the mesh.
  /// @param s  As gather_star() leaves it. REQUIRES: the collapse into link[j] is allowed.
  /// @throws Error resource_exhausted  the rank would exceed 65 535, or as SampleLists::take
  void collapse_and_record(StarSamples& s, std::size_t j);

 private:
  [[nodiscard]] VertexSplit make_record(const StarSamples& s, const FanError& own,
                                        const CollapseSite& site);
  void append_star(const Star& star, std::size_t j);
  void prefetch_records(const Star& star) const;

  Tile& tile_;
  const FullSurface* full_;
  FanFrame fan_;
  FanAssignment assignment_;
  SampleHandOver hand_over_;
  std::vector<TriangleId> fan_ids_;
};

}  // namespace ptin
