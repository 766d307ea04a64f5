// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/geodesic_path.h"

#include <cstddef>

#include <geodesic.h>

namespace ptin::serve {

namespace {

/// A geodesic between two positions, on which others are found by their distance.
class Geodesic {
 public:
  Geodesic(const geod_geodesic& earth, MapPoint from, MapPoint to) : from_(from), to_(to) {
    geod_inverseline(&line_, &earth, from.y, from.x, to.y, to.x, GEOD_DISTANCE_IN | GEOD_LONGITUDE);
  }
  [[nodiscard]] double length() const { return line_.s13; }
  [[nodiscard]] MapPoint at(double distance) const {
    if (distance <= 0) return from_;
    if (distance >= length()) return to_;
    MapPoint place;
    geod_position(&line_, distance, &place.y, &place.x, nullptr);
    return place;
  }

 private:
  MapPoint from_, to_;
  geod_geodesicline line_{};
};

}  // namespace

std::vector<MapPoint> along_geodesics(std::span<const MapPoint> path, std::uint64_t samples) {
  constexpr double kSemiMajor = 6378137, kFlattening = 1 / 298.257223563;  // WGS 84
  geod_geodesic earth;
  geod_init(&earth, kSemiMajor, kFlattening);
  std::vector<Geodesic> parts;
  std::vector<double> reached{0.0};  // At each vertex, from the beginning.
  for (std::size_t i = 1; i < path.size(); ++i) {
    parts.emplace_back(earth, path[i - 1], path[i]);
    reached.push_back(reached.back() + parts.back().length());
  }
  std::vector<MapPoint> places;
  std::size_t part = 0;
  for (std::uint64_t s = 0; s < samples; ++s) {
    const double at = reached.back() * static_cast<double>(s) / static_cast<double>(samples - 1);
    while (part + 1 < parts.size() && reached[part + 1] < at) ++part;
    places.push_back(s + 1 == samples ? path.back() : parts[part].at(at - reached[part]));
  }
  return places;
}

}  // namespace ptin::serve
