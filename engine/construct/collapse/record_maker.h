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
  /// @param full  The full surface under the tile, when the tile holds all samples of its window:
  /// then records
  ///              are measured to the end and saturated. Null when it holds witnesses: then `error`
  ///              of a record is its own part alone, `deviation` 0, and what it depends on is noted
  ///              in the tile; tightening does the rest (tighten.h).
  RecordMaker(Tile& tile, const FullSurface* full) : tile_(tile), full_(full) {}

  /// Collapses the centre of `s` into link[j]: appends the record (engine/DESIGN.md, section 2.2: own part,
  /// and the union and maximum of what the star carries), hands the samples of the star to the fan,
  /// and changes the mesh.
  /// @throws Error resource_exhausted when the rank would exceed 65 535
  void collapse_and_record(StarSamples& s, std::size_t j);

 private:
  [[nodiscard]] VertexSplit make_record(const StarSamples& s, const FanError& own,
                                        const CollapseSite& site);
  void note_dependencies(const Star& star);
  void prefetch_records(const Star& star) const;

  Tile& tile_;
  const FullSurface* full_;
  FanFrame fan_;
  FanAssignment assignment_;
  SampleHandOver hand_over_;
  std::vector<TriangleId> fan_ids_;
};

}  // namespace ptin
