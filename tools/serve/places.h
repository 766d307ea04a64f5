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
#include "engine/query/questions.h"
#include "tools/region/straight_sides.h"

namespace ptin::serve {

/// Longitudes and latitudes, in this order, of WGS 84.
inline constexpr std::string_view kCrs84 = "http://www.opengis.net/def/crs/OGC/1.3/CRS84";

/// Takes positions from the CRS that a client asked in to that of a terrain, and back. Axes stand
/// as x (east, longitude), y (north, latitude), whatever the CRS says. Threads: one.
class Places {
 public:
  /// @param asked  "CRS84" or its URI, "native", or "EPSG:25832" or its URI; empty: CRS84, or native
  ///               where the terrain's CRS is not known.
  /// @param bounds Of the terrain, map units. Where their x turns around the Earth (degrees, and the
  ///               planes of cylinders such as Mercator's), a position of the client is taken into
  ///               their turn: -179.96 is 180.04 of a terrain that lies across the antimeridian.
  /// @param who    As both_ways() takes it.
  /// @throws http::Problem 400  no CRS that is known here; the terrain's is not known; as both_ways()
  ///                       503  as both_ways()
  Places(const CrsFacts& terrain, const std::string& asked,
         const std::optional<Window>& bounds = std::nullopt, const std::string& who = {});
  ~Places();
  Places(const Places&) = delete;
  Places& operator=(const Places&) = delete;

  /// @param parameter  Gave the places.
  /// @throws http::Problem 400  no position of the terrain's CRS; names the first one
  void to_terrain(std::span<MapPoint> places, std::string_view parameter = "coords") const;
  [[nodiscard]] MapPoint to_terrain(MapPoint place, std::string_view parameter = "coords") const;
  /// A line of straight sides in the client's CRS, with the places between its corners that keep it so
  /// in the terrain's; every side goes the shorter way around the Earth, in `native` as the numbers
  /// say. Where it leaves a terrain that goes around the whole Earth at one end and enters it at the
  /// other, it is given once for each, a turn apart, and is_in_turn_of_terrain() tells which part of
  /// which counts.
  /// @param sides  Tells how near, and how many places at most; what turns is known here.
  /// @throws http::Problem 400, 413  as tools::transformed_sides()
  [[nodiscard]] std::vector<std::vector<MapPoint>> line_to_terrain(
      std::vector<MapPoint> line, tools::SideTarget sides,
      std::string_view parameter = "coords") const;
  /// Whether an x of the terrain's CRS lies within half a turn of its middle.
  [[nodiscard]] bool is_in_turn_of_terrain(double x) const noexcept;
  /// Takes each longitude of the client to within half a turn of the one before it, the first one of
  /// `from`: a polygon across the antimeridian does not go around the Earth. Other coordinates, and
  /// `native` ones, stay.
  void go_on(std::span<MapPoint> line, double from) const;
  /// Takes longitudes of the client to -180 to 180, each by itself.
  void wrap(std::span<MapPoint> places) const;
  /// Positions that have none in the client's CRS become NaN. Of degrees the first one is from -180
  /// to 180, and the others go on from it: a line across the antimeridian does not jump.
  void from_terrain(std::span<MapPoint> places) const;
  /// The smallest window of the terrain's CRS that holds one of the client's, which may lie across
  /// the antimeridian (west larger than east).
  /// @throws http::Problem 400  it reaches where the terrain's CRS has no positions; it is inverted; it
  ///                            holds both ends of a terrain that goes around the whole Earth
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
  /// An x of the terrain's CRS in the turn around the Earth that the terrain lies in.
  [[nodiscard]] double turned(double x) const noexcept;
  /// Shifts by which a range of x of the terrain's CRS meets the terrain: several where
  /// it meets it in several turns and lies within it in none.
  [[nodiscard]] std::vector<double> shifts_onto_terrain(double low, double high) const;
  void transform_to_terrain(std::span<MapPoint> places, std::string_view parameter) const;

  struct Inside;
  std::unique_ptr<Inside> inside_;
  std::string uri_;
  bool geographic_ = false;
  bool client_turns_ = false;  ///< x of the client is a longitude in degrees.
  double turn_ = 0;            ///< Length of the terrain's x around the Earth; 0: it does not turn.
  std::optional<Window> bounds_;
};

/// The window of CRS84 around a window of the terrain's CRS, longitudes from -180 to 180: across the
/// antimeridian west is larger than east. None where that CRS is not known.
[[nodiscard]] std::optional<Window> lon_lat_of(const Window& window, const CrsFacts& terrain);

/// The URI of a terrain's own CRS: "http://www.opengis.net/def/crs/EPSG/0/32611"; "" where it has
/// no code.
[[nodiscard]] std::string uri_of(const CrsFacts& terrain);

}  // namespace ptin::serve
