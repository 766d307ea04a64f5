// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/terrain.h"

#include <utility>

#include "engine/query/questions.h"

namespace ptin {

RefinedTin Terrain::refine(const RefineRequest& request) const {
  return ptin::refine(*this, request);
}

TinParts Terrain::parts(PartRequest request) const { return TinParts(*this, std::move(request)); }

MovingWindow Terrain::moving_window() const { return moving_window({}); }

MovingWindow Terrain::moving_window(const MovingWindowOptions& options) const {
  return MovingWindow(*this, options);
}

LocateResult Terrain::locate(std::span<const MapPoint> points) const { return locate(points, {}); }

LocateResult Terrain::locate(std::span<const MapPoint> points, const LocateRequest& request) const {
  return ptin::locate(*this, points, request);
}

ProfileResult Terrain::profile(std::span<const MapPoint> line) const { return profile(line, {}); }

ProfileResult Terrain::profile(std::span<const MapPoint> line,
                               const ProfileRequest& request) const {
  return ptin::profile(*this, line, request);
}

ProfileResult Terrain::profile(std::span<const std::vector<MapPoint>> lines) const {
  return profile(lines, {});
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

HighestResult Terrain::highest() const { return highest({}); }

HighestResult Terrain::highest(const HighestRequest& request) const {
  return ptin::highest(*this, request);
}

ClassChanges Terrain::class_changes(const ClassChangesRequest& request) const {
  return ptin::class_changes(*this, request);
}

SightResult Terrain::sight(const SightPair& pair) const { return sight(pair, {}); }

SightResult Terrain::sight(const SightPair& pair, const SightRequest& request) const {
  return ptin::sight(*this, pair, request);
}

SightSolver Terrain::sight_lines(const SightRequest& request) const {
  return SightSolver(*this, request);
}

SightSolver Terrain::sight_lines(const SightRequest& request, std::uint64_t coarse_records) const {
  return SightSolver(*this, request, coarse_records);
}

Viewshed Terrain::viewshed(const ViewshedRequest& request) const {
  return ptin::viewshed(*this, request);
}

Isolines Terrain::isolines(const IsolineRequest& request) const {
  return ptin::isolines(*this, request);
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

HierarchyReport Terrain::check_hierarchy() const { return check_hierarchy({}); }

HierarchyReport Terrain::check_hierarchy(const HierarchyRequest& request) const {
  return ptin::check_hierarchy(*this, request);
}

}  // namespace ptin
