// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/lon_lat_nodes.h"

#include <algorithm>
#include <cmath>

#include "tools/http/problem.h"
#include "tools/serve/transformations.h"

namespace ptin::serve {

namespace {

constexpr double kMostOff = 0.005;
/// Nodes are written with nine decimals: a tenth of a millimetre.
constexpr double kNodesPerDegree = 1e9;
constexpr int kTried = 7;

/// The weights of four nodes at a share of the way from the first to the last.
std::array<double, LonLatNodes::kAside> shares_of_nodes(double at) {
  const double t = 3 * at;
  return {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2, -t * (t - 1) * (t - 3) / 2,
          t * (t - 1) * (t - 2) / 6};
}

/// Longitude and latitude at shares of a window, near a longitude.
std::optional<MapPoint> lon_lat_at(const BothWays& ways, const Window& w, MapPoint share,
                                   double near) {
  double x = std::lerp(w.min_x, w.max_x, share.x), y = std::lerp(w.min_y, w.max_y, share.y);
  int succeeded = 0;
  ways.back->Transform(1, &x, &y, nullptr, &succeeded);
  if (succeeded == 0 || !std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
  return MapPoint{x + 360 * std::round((near - x) / 360), y};
}

}  // namespace

MapPoint LonLatNodes::at(double x, double y) const {
  const auto across = shares_of_nodes(x), up = shares_of_nodes(y);
  MapPoint place{0, 0};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double share = across[i % kAside] * up[i / kAside];
    place.x += share * nodes[i].x;
    place.y += share * nodes[i].y;
  }
  return place;
}

std::optional<LonLatNodes> lon_lat_nodes(const Window& window, const CrsFacts& terrain) {
  if (terrain.wkt.empty() || !terrain.is_understood || terrain.geographic) return std::nullopt;
  std::shared_ptr<const BothWays> ways;
  try {
    ways = both_ways("OGC:CRS84", terrain.wkt);
  } catch (const http::Problem&) {  // There is no transformation.
    return std::nullopt;
  }
  LonLatNodes all;
  for (std::size_t i = 0; i < all.nodes.size(); ++i) {
    const MapPoint share{static_cast<double>(i % LonLatNodes::kAside) / 3,
                         static_cast<double>(i / LonLatNodes::kAside) / 3};
    const auto place = lon_lat_at(*ways, window, share, i == 0 ? 0.0 : all.nodes[0].x);
    if (!place) return std::nullopt;
    all.nodes[i] = {std::round(place->x * kNodesPerDegree) / kNodesPerDegree,
                    std::round(place->y * kNodesPerDegree) / kNodesPerDegree};
  }
  double off = 1 / kNodesPerDegree;
  for (int i = 0; i < kTried * kTried; ++i) {
    const MapPoint share{(i % kTried + 0.5) / kTried, (i / kTried + 0.5) / kTried};
    const MapPoint told = all.at(share.x, share.y);
    const auto place = lon_lat_at(*ways, window, share, told.x);
    if (!place) return std::nullopt;
    off = std::max({off, std::abs(place->x - told.x), std::abs(place->y - told.y)});
  }
  all.within = 2 * off;
  return all.within <= kMostOff ? std::optional(all) : std::nullopt;
}

}  // namespace ptin::serve
