// SPDX-License-Identifier: GPL-3.0-or-later
//
// Makes the saturated record of a collapse and carries it out.
#pragma once

#include <utility>
#include <vector>

#include "engine/construct/fan_measure.h"
#include "engine/construct/full_surface.h"
#include "engine/construct/star_samples.h"
#include "engine/construct/tile.h"
#include "engine/mesh/collapse.h"

namespace ptin {

/// One a thread; keeps scratch buffers.
class RecordMaker {
 public:
  RecordMaker(Tile& tile, const FullSurface& full) : tile_(tile), full_(full) {}

  /// Collapses the centre of `s` into link[j]: appends the record (DESIGN.md, section 2: own part,
  /// and the union and maximum of what the star carries), hands the samples of the star to the fan,
  /// and changes the mesh.
  /// @throws Error resource_exhausted when the rank would exceed 65 535
  void collapse_and_record(StarSamples& s, std::size_t j);

 private:
  /// The samples of one fan triangle; the worst comes first, since the next choice of w screens by
  /// it.
  struct FanList {
    std::vector<Sample> samples;
    double worst = 0.0;
    void add(const Sample& sample, double residual) {
      samples.push_back(sample);
      if (samples.size() == 1) {
        worst = residual;
      } else if (residual > worst) {
        worst = residual;
        std::swap(samples.front(), samples.back());
      }
    }
  };
  struct OwnPart {
    double error = 0.0;
    double deviation = 0.0;
  };
  [[nodiscard]] OwnPart measure(const StarSamples& s);
  [[nodiscard]] double spoke_deviation(const StarSamples& s) const;
  [[nodiscard]] VertexSplit make_record(const StarSamples& s, const OwnPart& own,
                                        const CollapseSite& site) const;
  void hand_over_samples(const StarSamples& s);
  void hand_over_block(const StarSamples& s, const Sample& block);
  void store_list(std::size_t i);

  Tile& tile_;
  const FullSurface& full_;
  FanFrame fan_;
  std::vector<double> triangle_, residual_;  ///< Of each sample, padded.
  std::vector<FanList> lists_;               ///< One for each fan triangle.
  std::vector<TriangleId> fan_ids_;
};

}  // namespace ptin
