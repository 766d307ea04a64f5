// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sets of points of every kind that breaks triangulations.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "engine/construct/points/point_buckets.h"
#include "engine/geometry/point.h"
#include "tests/construct/memory_file.h"
#include "tests/construct/read_buckets.h"

namespace ptin {

enum class PointKind {
  kEven,        ///< Uniform in a square.
  kGrid,        ///< Every point of a grid: everything cocircular.
  kClusters,    ///< Dense heaps far apart.
  kOutliers,    ///< One heap, and a few points at the ends of the world.
  kRows,        ///< Long collinear rows, far from each other.
  kCorridor,    ///< A narrow strip across the square.
  kRing,        ///< On and near a circle: the hull is most of it.
  kDuplicates,  ///< A few positions, many times.
};

inline constexpr std::array kPointKinds = {
    PointKind::kEven, PointKind::kGrid,     PointKind::kClusters, PointKind::kOutliers,
    PointKind::kRows, PointKind::kCorridor, PointKind::kRing,     PointKind::kDuplicates};

inline std::string name_of(PointKind kind) {
  static constexpr const char* kNames[] = {"Even", "Grid",     "Clusters", "Outliers",
                                           "Rows", "Corridor", "Ring",     "Duplicates"};
  return kNames[static_cast<int>(kind)];
}

/// `n` points, or nearly so, with duplicates.
inline std::vector<GridPoint> points_of(PointKind kind, std::uint64_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed * 31 + static_cast<std::uint64_t>(kind));
  const auto up_to = [&](std::int64_t most) {
    return static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(most + 1));
  };
  const auto normal = [&](double sigma) {
    return static_cast<std::int32_t>(std::lround(std::normal_distribution(0.0, sigma)(random)));
  };
  const auto side = static_cast<std::int32_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  const std::int32_t spread = 100 * side;
  std::vector<GridPoint> points{{0, 0}, {1, 0}, {0, 1}};
  for (std::uint64_t i = 0; points.size() < n; ++i) {
    switch (kind) {
      case PointKind::kEven:
        points.push_back({up_to(spread), up_to(spread)});
        break;
      case PointKind::kGrid:
        points.push_back(
            {static_cast<std::int32_t>(i) % side, static_cast<std::int32_t>(i) / side});
        break;
      case PointKind::kClusters: {
        const std::int32_t c = up_to(9);
        points.push_back({c * c * 1000 * side + 500'000 + normal(side * (1 + 10 * (c % 3))),
                          (c * 7919 % 10) * 9000 * side + 500'000 + normal(side * 3.0)});
        break;
      }
      case PointKind::kOutliers:
        points.push_back(i % 1000 == 999 ? GridPoint{up_to(kGridMax), up_to(kGridMax)}
                                         : GridPoint{500'000'000 + up_to(spread), up_to(spread)});
        break;
      case PointKind::kRows:
        points.push_back({up_to(spread) * 7, up_to(4) * 1'000'000});
        break;
      case PointKind::kCorridor: {
        const std::int32_t x = up_to(1'000'000);
        points.push_back({x, x / 3 + up_to(200)});
        break;
      }
      case PointKind::kRing: {
        const double angle = std::uniform_real_distribution(0.0, 6.283185307)(random);
        const double radius = 1e8 - (i % 3 == 0 ? up_to(100'000) : 0);
        points.push_back({static_cast<std::int32_t>(2e8 + radius * std::cos(angle)),
                          static_cast<std::int32_t>(2e8 + radius * std::sin(angle))});
        break;
      }
      case PointKind::kDuplicates:
        points.push_back({up_to(side / 4), up_to(side / 4)});
        break;
    }
  }
  return points;
}

inline std::string height_text(GridPoint p) {
  const double z = std::sin(p.x * 1e-3) * 50 + std::cos(p.y * 1.7e-3) * 30;
  return std::to_string(std::lround(z * 4));
}

inline std::string text_of(const std::vector<GridPoint>& points) {
  std::string text;
  for (const GridPoint p : points) {
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + height_text(p) + "\n";
  }
  return text;
}

inline PointBuckets buckets_of(const std::vector<GridPoint>& points,
                               std::uint64_t memory_bytes = 1 << 20) {
  const MemoryFile file("set.xyz", text_of(points));
  return read_buckets({file.path()}, {}, memory_bytes);
}

inline PointBuckets buckets_of(PointKind kind, std::uint64_t n, std::uint64_t seed) {
  return buckets_of(points_of(kind, n, seed));
}

}  // namespace ptin
