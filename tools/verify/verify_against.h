// SPDX-License-Identifier: GPL-3.0-or-later
//
// `verify --against`: the promises of a file, checked at every sample of its source.
//
// Independent of the builder where certainty is measured: triangles are scanned over samples in
// integers, and distances to borders are measured, by code of this room. Samples are read as a build
// reads them, and the library's refine() is what is being verified.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/query/questions.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

/// What was found at one tolerance, over all windows.
struct ToleranceCheck {
  std::optional<double> tolerance;  ///< None: the full TIN.
  double certified_error = 0.0;     ///< The largest that an answer certified.
  double certified_deviation = 0.0;
  /// The largest vertical distance at a sample of the right class, less the rounding of the
  /// arithmetic that measures it (10^-12 of the largest height).
  double worst_error = 0.0;
  /// The largest vertical distance to the full TIN at a random point.
  double worst_deviation = 0.0;
  std::uint64_t samples = 0;  ///< Samples with a height.
  std::uint64_t void_samples = 0;
  /// Those of void_samples that have a height, but touch no surface triangle of the full TIN.
  std::uint64_t lone_samples = 0;
  std::uint64_t reclassified = 0;  ///< Samples of the wrong class, but near enough to the border.
  /// The largest distance found between the border of voids in the source and in the TIN, whichever
  /// way it is measured; ground units.
  double worst_border_move = 0.0;
  /// The largest vertical distance at a point of a breakline or of the boundary, where both TINs are
  /// surface.
  double worst_breakline_error = 0.0;
  std::uint64_t faults = 0;
};

struct AgainstReport {
  std::vector<ToleranceCheck> checks;
  std::vector<std::string> faults;  ///< The first `listed_faults` ones, in words.
  std::uint64_t fault_count = 0;
};

struct AgainstOptions {
  std::vector<std::optional<double>> tolerances;
  std::size_t listed_faults = 20;
  /// The side of a window over a raster, in grid units. Windows join because regions refined apart
  /// do (P5).
  std::int32_t window_side = 512;
  /// Windows over points are halved until they hold no more than this.
  std::size_t samples_per_window = 50'000;
  /// Random points in each window, at which the deviation is measured.
  unsigned random_points = 64;
  std::stop_token stop;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Checks every window of the terrain. Memory: one window, and a box for each window; `source` has
/// memory of its own (SampleResources).
/// @throws Error  as Terrain::refine() and SourceSamples::read()
[[nodiscard]] AgainstReport verify_against(const Terrain& terrain, SourceSamples& source,
                                           const AgainstOptions& options);

}  // namespace ptin::tools
