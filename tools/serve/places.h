// SPDX-License-Identifier: GPL-3.0-or-later
//
// Positions in the CRS of a client and in that of a terrain.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/query/terrain.h"
#include "tools/region/straight_sides.h"

namespace ptin::serve {

/// Takes positions from the CRS that a client asked in to that of a terrain, and back. Axes stand
/// as x (east, longitude), y (north, latitude), whatever the CRS says. Threads: one.
class Places {
 public:
  /// @param asked  "CRS84" or its URI, "native", or "EPSG:25832" or its URI; empty: CRS84, or native
  ///               where the terrain's CRS is not known.
  /// @param bounds Of the terrain, map units. Where they are degrees, a longitude of the client is
  ///               taken into their turn of the circle: -179.96 is 180.04 of a terrain that lies
  ///               across the antimeridian.
  /// @throws http::Problem 400  no CRS that is known here; the terrain's is not known; there is no
  ///                            transformation
  Places(const CrsFacts& terrain, const std::string& asked,
         const std::optional<Window>& bounds = std::nullopt);
  ~Places();
  Places(const Places&) = delete;
  Places& operator=(const Places&) = delete;

  /// @param parameter  Gave the places.
  /// @throws http::Problem 400  no position of the terrain's CRS; names the first one
  void to_terrain(std::span<MapPoint> places, std::string_view parameter = "coords") const;
  [[nodiscard]] MapPoint to_terrain(MapPoint place, std::string_view parameter = "coords") const;
  /// A line of straight sides in the client's CRS, with the places between its corners that keep it
  /// so in the terrain's. Of degrees a side goes the shorter way around.
  /// @param sides  Tells how near, and how many places at most; what turns is known here.
  /// @throws http::Problem 400, 413  as tools::transformed_sides()
  [[nodiscard]] std::vector<MapPoint> line_to_terrain(std::span<const MapPoint> line,
                                                      tools::SideTarget sides,
                                                      std::string_view parameter) const;
  /// Positions that have none in the client's CRS become NaN. Of degrees the first one is from -180
  /// to 180, and the others go on from it: a line across the antimeridian does not jump.
  void from_terrain(std::span<MapPoint> places) const;
  /// The smallest window of the terrain's CRS that holds one of the client's, which may lie across
  /// the antimeridian (west larger than east).
  /// @throws http::Problem 400  it reaches where the terrain's CRS has no positions; it is inverted
  [[nodiscard]] Window to_terrain(const Window& window) const;
  /// The window of the client's CRS around one of the terrain's, across the antimeridian as above;
  /// none where a part of it has no positions there.
  [[nodiscard]] std::optional<Window> from_terrain(const Window& window) const;

  /// The URI of the client's CRS, as OGC names it; "" of one that has none.
  [[nodiscard]] const std::string& uri() const noexcept { return uri_; }
  /// True where positions of the client are longitude and latitude.
  [[nodiscard]] bool is_geographic() const noexcept { return geographic_; }
  /// True where the authority of that CRS has north (latitude) as the first axis.
  [[nodiscard]] bool is_north_first() const;
  /// True where nothing is transformed.
  [[nodiscard]] bool is_native() const noexcept;

 private:
  /// A longitude of the terrain's CRS in the turn of the circle that the terrain lies in.
  [[nodiscard]] double turned(double x) const noexcept;

  struct Inside;
  std::unique_ptr<Inside> inside_;
  std::string uri_;
  bool geographic_ = false;
  bool client_turns_ = false;     ///< x of the client is a longitude in degrees.
  bool turns_ = false;            ///< x of the terrain is a longitude in degrees.
  std::optional<Window> bounds_;  ///< Of a terrain whose x is one.
};

/// The window of CRS84 around a window of the terrain's CRS, longitudes from -180 to 180: across the
/// antimeridian west is larger than east. None where that CRS is not known.
[[nodiscard]] std::optional<Window> lon_lat_of(const Window& window, const CrsFacts& terrain);

/// The URI of a terrain's own CRS: "http://www.opengis.net/def/crs/EPSG/0/32611"; "" where it has
/// no code.
[[nodiscard]] std::string uri_of(const CrsFacts& terrain);

}  // namespace ptin::serve
