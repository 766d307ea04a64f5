// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/terrain.h"

#include <utility>

#include "engine/error.h"
#include "engine/query/paper/isoline_extraction.h"
#include "engine/query/paper/point_location.h"
#include "engine/query/paper/visibility.h"
#include "engine/query/questions.h"

namespace ptin {

Terrain Terrain::answering(AnswerBy by, const DetailRequest& detail) const {
  Terrain terrain = *this;
  if (by == AnswerBy::kStars || is_by_splits(by)) {
    terrain.use_floor(false);
  }
  if (by != AnswerBy::kHeights) {
    return terrain;
  }
  terrain.use_floor(true);
  if (detail.tolerance || detail.vertices) {
    refuse("heights answer for the full TIN, and a level of detail is asked for: ask by stars");
  }
  if (uses_other_index()) {
    refuse("heights are found without an index, and another one is in use: ask without it");
  }
  if (terrain.floor() == nullptr) {
    refuse(
        "the file has no heights of a raster to answer from: it was built from points or a TIN, "
        "with "
        "an error left out, or by an older version; ask by stars",
        store().path());
  }
  return terrain;
}

RefinedTin Terrain::refine(const RefineRequest& request) const {
  return ptin::refine(*this, request);
}

TinParts Terrain::parts(PartRequest request) const { return TinParts(*this, std::move(request)); }

MovingWindow Terrain::moving_window(const MovingWindowOptions& options) const {
  return MovingWindow(*this, options);
}

LocateResult Terrain::locate(std::span<const MapPoint> points, const LocateRequest& request,
                             AnswerBy by) const {
  const Terrain terrain = answering(by, request.detail);
  return is_by_splits(by) ? paper::locate(terrain, points, request)
                          : ptin::locate(terrain, points, request);
}

ProfileResult Terrain::profile(std::span<const MapPoint> line,
                               const ProfileRequest& request) const {
  return ptin::profile(*this, line, request);
}

ProfileResult Terrain::profile(std::span<const std::vector<MapPoint>> lines,
                               const ProfileRequest& request) const {
  return ptin::profile(*this, lines, request);
}

RasterResult Terrain::raster(const RasterRequest& request, const RasterReceiver& receive) const {
  return ptin::raster(*this, request, receive);
}

RasterResult Terrain::raster(const RasterRequest& request, std::span<double> heights,
                             std::span<PointState> states) const {
  return ptin::raster(*this, request, heights, states);
}

RasterResult Terrain::heights_at(std::span<const MapPoint> centres, const LocateRequest& request,
                                 std::span<double> heights) const {
  return ptin::heights_at(*this, centres, request, heights);
}

HighestResult Terrain::highest(const HighestRequest& request) const {
  return ptin::highest(*this, request);
}

ClassChanges Terrain::class_changes(const ClassChangesRequest& request) const {
  return ptin::class_changes(*this, request);
}

SightResult Terrain::sight(const SightPair& pair, const SightRequest& request, AnswerBy by) const {
  SightSolver solver = sight_lines(request, 0, by);
  SightResult result = solver.solve(pair);
  result.cost.add_counts(solver.base_cost());
  return result;
}

SightSolver Terrain::sight_lines(const SightRequest& request, std::uint64_t coarse_records,
                                 AnswerBy by) const {
  const Terrain terrain = answering(by, request.detail);
  return is_by_splits(by) ? paper::sight_lines(terrain, request)
                          : SightSolver(terrain, request, coarse_records);
}

Viewshed Terrain::viewshed(const ViewshedRequest& request) const {
  return ptin::viewshed(*this, request);
}

Isolines Terrain::isolines(const IsolineRequest& request, AnswerBy by) const {
  const Terrain terrain = answering(by, request.detail);
  return is_by_splits(by) ? paper::isolines(terrain, request) : ptin::isolines(terrain, request);
}

VolumeResult Terrain::volume(const VolumeRequest& request) const {
  return ptin::volume(*this, request);
}

std::vector<VolumeResult> Terrain::volumes(const VolumeRequest& request,
                                           std::span<const double> levels) const {
  return ptin::volumes(*this, request, levels);
}

StreamSummary Terrain::stream(const StreamRequest& request, const ByteSink& sink) const {
  return write_stream(*this, request, sink);
}

HierarchyReport Terrain::check_hierarchy(const HierarchyRequest& request) const {
  return ptin::check_hierarchy(*this, request);
}

}  // namespace ptin
