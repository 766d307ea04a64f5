// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a terrain lies on the globe: from its grid to longitude, latitude and height, and what is
// known of the surface that its heights are measured from.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/tiles/ellipsoid.h"

namespace ptin::tools {

/// What heights are measured from.
enum class VerticalDatum {
  kEllipsoidal,  ///< An ellipsoid, as viewers of the globe assume.
  kOrthometric,  ///< The sea's level or the like, up to 110 m away from the ellipsoid.
  kUnknown,      ///< Nothing says.
};

/// What the CRS says about its heights.
[[nodiscard]] VerticalDatum vertical_datum(const CrsFacts& crs);

/// Degrees; longitudes go on beyond 180 where a terrain lies across that meridian.
struct GlobeBox {
  double west = 0.0;
  double south = 0.0;
  double east = 0.0;
  double north = 0.0;
};

/// A box for formats that know none across the antimeridian: such a one goes around the Earth.
[[nodiscard]] GlobeBox unwrapped(const GlobeBox& box) noexcept;
/// Its middle, longitude from -180 to 180 and latitude, where west is above east across the antimeridian.
[[nodiscard]] MapPoint middle_of(const GlobeBox& box) noexcept;

/// How a store's grid is laid on the globe.
struct GlobeOptions {
  /// Heights are turned into ellipsoidal ones by PROJ. Else they are taken as they are, in metres.
  bool to_ellipsoid = false;
};

/// The transformation of one thread. Every point is transformed by itself, so a point gets the same
/// longitude, latitude and height wherever and with whatever it is asked.
class GlobePath {
 public:
  ~GlobePath();
  GlobePath(const GlobePath&) = delete;
  GlobePath& operator=(const GlobePath&) = delete;

  /// @param x, y    Grid units, between grid points too.
  /// @param height  Height's unit.
  /// @throws Error invalid_argument  PROJ cannot transform the point
  [[nodiscard]] GlobePoint to_globe(double x, double y, double height) const;
  /// A position in map units; not finite where PROJ knows none.
  [[nodiscard]] MapPoint to_map(double lon, double lat) const;

 private:
  friend class Globe;
  GlobePath() = default;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Lays one store's grid on the globe. Threads: const functions may be called at once.
class Globe {
 public:
  /// @throws Error invalid_argument  the CRS is unknown, or no place on Earth; a pole lies within
  ///                                 the terrain; `to_ellipsoid` and PROJ knows no way, or lacks a
  ///                                 grid
  /// Cost: what PROJ takes to look up a CRS, some 10 ms.
  Globe(const StoreFacts& facts, const CrsFacts& crs, const GlobeOptions& options = {});

  /// A transformation for as long as this lives; kept for the next one who asks.
  class Lease {
   public:
    Lease(const Globe& globe, std::unique_ptr<GlobePath> path)
        : globe_(&globe), path_(std::move(path)) {}
    ~Lease();
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    [[nodiscard]] const GlobePath& operator*() const noexcept { return *path_; }
    [[nodiscard]] const GlobePath* operator->() const noexcept { return path_.get(); }

   private:
    const Globe* globe_;
    std::unique_ptr<GlobePath> path_;
  };
  [[nodiscard]] Lease path() const;

  /// Holds the terrain's domain. A little larger than need be where its sides are bent in degrees.
  [[nodiscard]] const GlobeBox& box() const noexcept { return box_; }
  /// Bounds of all heights after they were transformed, metres. They are reached where heights are
  /// taken as they are.
  [[nodiscard]] double min_height() const noexcept { return min_height_; }
  [[nodiscard]] double max_height() const noexcept { return max_height_; }
  [[nodiscard]] double metres_per_height() const noexcept { return metres_per_height_; }

  /// A box of the grid that holds every position within `box`; empty when none lies in the domain.
  [[nodiscard]] GridBox grid_box(const GlobeBox& box) const;

 private:
  [[nodiscard]] std::unique_ptr<GlobePath> make_path() const;
  void find_box(const GlobePath& path);

  StoreFacts facts_;
  CrsFacts crs_;
  GlobeOptions options_;
  double metres_per_height_ = 1.0;
  double degrees_per_map_unit_ = 0.0;  ///< 0: the map is a plane.
  double middle_lon_ = 0.0;
  GlobeBox box_;
  double min_height_ = 0.0;
  double max_height_ = 0.0;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<GlobePath>> idle_;
};

}  // namespace ptin::tools
