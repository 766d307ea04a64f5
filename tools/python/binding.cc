// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/python/binding.h"

#include "engine/error.h"

namespace ptin::python {

std::span<const MapPoint> points_of(const Numbers& xy) {
  const auto* const first = reinterpret_cast<const MapPoint*>(xy.data());
  if (xy.ndim() == 1 && xy.shape(0) == 2) return {first, 1};
  if (xy.ndim() == 2 && xy.shape(1) == 2) return {first, static_cast<std::size_t>(xy.shape(0))};
  refuse("positions are an array of shape (N, 2), or one position of two numbers");
}

std::optional<Region> region_of(const RegionArgument& argument) {
  if (!argument) return std::nullopt;
  if (const auto* const window = std::get_if<std::array<double, 4>>(&*argument)) {
    return Window{(*window)[0], (*window)[1], (*window)[2], (*window)[3]};
  }
  Polygon polygon;
  for (const Numbers& ring : std::get<std::vector<Numbers>>(*argument)) {
    const std::span<const MapPoint> points = points_of(ring);
    polygon.rings.emplace_back(points.begin(), points.end());
  }
  return polygon;
}

const char* name_of(PointState state) noexcept {
  switch (state) {
    case PointState::kSurface:
      return "surface";
    case PointState::kVoid:
      return "void";
    case PointState::kOutside:
      break;
  }
  return "outside";
}

}  // namespace ptin::python
