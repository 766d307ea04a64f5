// SPDX-License-Identifier: GPL-3.0-or-later
//
// The questions: what each takes, and what is told of its answer. A question is the struct that holds
// its values and a function add_question() that adds the rows of its parameters; of each kind of row
// of its answers a function has the fields.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "tools/ask/answer_facts.h"
#include "tools/ask/field.h"
#include "tools/ask/groups.h"
#include "tools/formats/mesh.h"

namespace ptin::ask {

// Heights at positions: `ptin locate`, and over HTTP `position`, `area`, `trajectory` and `/v1`.

void add_question(Parameters& rows, LocateRequest& request);

/// A located point as it is told.
struct LocatedRow {
  LocatedRow(const MapPoint& at, const LocatedPoint& point, const AffineMap& map);

  MapPoint at;  ///< In the CRS of whoever asked, as are the corners of its triangle.
  const LocatedPoint& point;
  std::array<MapPoint, 3> corners{};
  const std::string* id = nullptr;  ///< Null: the input has none.
};
[[nodiscard]] Fields<LocatedRow> located_fields();

// Heights along lines: `ptin profile`, and over HTTP `profile` and `trajectory`.

void add_question(Parameters& rows, ProfileRequest& request);
/// Has distances run over ground where map units are degrees, which are no lengths: in metres.
void set_ground(ProfileRequest& request, const Ground& ground);
/// The unit of distances along lines.
[[nodiscard]] std::string length_unit_of(const CrsFacts& crs);

/// A point of a profile as it is told.
struct ProfileRow {
  const ProfilePoint& point;
  MapPoint at;                      ///< In the CRS of whoever asked.
  double deviation = 0.0;           ///< Certified.
  bool has_stations = true;         ///< Some points are stations.
  const std::string* id = nullptr;  ///< The name of its line; null: the input has none.
};
[[nodiscard]] Fields<ProfileRow> profile_fields();

/// A line of a profile as it is told.
struct ProfileLineRow {
  std::span<const ProfilePoint> points;
  const ProfileResult& profile;
  const std::string* id = nullptr;
};
[[nodiscard]] Fields<ProfileLineRow> profile_line_fields();
/// The stretches of one line that have heights: calls `take` with the first and the last place of each.
void for_each_stretch(std::span<const ProfilePoint> points,
                      const std::function<void(std::size_t first, std::size_t last)>& take);

/// A profile as a whole.
struct ProfileAnswer {
  const ProfileResult& profile;
  const CrsFacts& crs;
  const std::vector<std::string>* ids = nullptr;  ///< Names of the lines; null: the input has none.
  /// How far a side of the client's CRS is from the line walked, map units.
  double bent_at_most = 0.0;
};
[[nodiscard]] Fields<ProfileAnswer> profile_answer_fields();

// Lines of sight: `ptin sight`, and `sight` over HTTP.

struct SightQuestion {
  SightRequest request;
  std::optional<double> hertz;                ///< The link whose first Fresnel zone is measured.
  std::vector<double> end_heights{2.0, 2.0};  ///< Over HTTP: of the ends of `coords`.
};
void add_question(Parameters& rows, SightQuestion& question);
/// Fills in what the ground tells: distances, the Earth, and the wavelength in the height's unit.
void set_ground(SightQuestion& question, const Ground& ground);
/// The records of the coarse level that so many pairs share; 0: they are too few for one.
[[nodiscard]] std::uint64_t coarse_records_for(std::size_t pairs);

/// A line of sight as it is told.
struct SightRow {
  /// @param to_client  Takes places to the CRS of whoever asked; none: they stay.
  explicit SightRow(const SightResult& line,
                    const std::function<void(std::span<MapPoint>)>& to_client = {});

  const SightResult& result;
  std::optional<SightPoint> obstruction, clearance, fresnel;
  const std::string* id = nullptr;  ///< Null: the input has none.
};
[[nodiscard]] Fields<SightRow> sight_fields();

// What one observer sees: `ptin viewshed`, and `viewshed` over HTTP.

struct ViewshedQuestion {
  ViewshedQuestion() { request.eye_height = 2; }  // Of somebody who stands there.

  ViewshedRequest request;
  double x = 0, y = 0;  ///< The observer's position on the command line.
  double radius = 0;    ///< Map units, of a geographic CRS metres; over HTTP in the heights' unit.
};
void add_question(Parameters& rows, ViewshedQuestion& question);
/// Fills in what the ground tells below the eye, which is set: lengths of map units, and the Earth.
void set_ground(ViewshedRequest& request, const Ground& ground);

[[nodiscard]] Fields<Viewshed> viewshed_fields();
/// A vertex as a feature.
[[nodiscard]] Fields<Viewshed::Target> target_fields();

// Isolines: `ptin isoline`, and `isolines` over HTTP.

struct IsolineQuestion {
  IsolineRequest request;
  Levels levels;
  RegionText region;
};
void add_question(Parameters& rows, IsolineQuestion& question);

/// A state of isolines that change while splits arrive; written as the fields `step`, `splits` and
/// `error`.
struct IsolineStep {
  std::uint64_t step = 0;        ///< From 0.
  std::uint64_t splits = 0;      ///< Applied to T0 by then.
  double certified_error = 0.0;  ///< The error of the TIN whose isolines these are.
};
/// A line as a feature; or what lies between two levels.
struct IsolineRow {
  std::uint64_t id = 0;
  double elevation = 0.0;  ///< The level; the lower one of a band.
  bool ring = false;
  const IsolineStep* step = nullptr;  ///< Null: there are no steps.
  double upper = 0.0;                 ///< The upper level of a band.
};
[[nodiscard]] Fields<IsolineRow> isoline_row_fields();
[[nodiscard]] Fields<IsolineRow> band_row_fields();

struct IsolineAnswer {
  const Isolines* isolines;
  std::uint64_t lines = 0, rings = 0, points = 0;  ///< Written.
};
[[nodiscard]] Fields<IsolineAnswer> isoline_fields();
struct BandAnswer {
  std::vector<double> levels;
  std::uint64_t features = 0, polygons = 0;
};
[[nodiscard]] Fields<BandAnswer> band_fields();

// The highest or lowest point: `ptin highest`, and `highest` over HTTP.

struct HighestQuestion {
  HighestRequest request;
  RegionText region;
};
void add_question(Parameters& rows, HighestQuestion& question);

/// @param lowest  The lowest point was asked for.
[[nodiscard]] Fields<HighestResult> highest_fields(bool lowest = false);

/// The point, or one of the vertices, as a feature.
struct HighestPlace {
  HeightAt at;
  std::size_t rank = 1;
  bool at_vertex = true;
  const HighestResult* result = nullptr;  ///< The answer, for the point; null: a further vertex.
};
[[nodiscard]] Fields<HighestPlace> highest_place_fields();
/// The point, then the other vertices; none where there is no surface.
[[nodiscard]] std::vector<HighestPlace> places_of(const HighestResult& result);

// Volumes: `ptin volume`.

struct VolumeQuestion {
  Levels levels;
  std::string against;  ///< The other terrain; empty: levels.
  RegionText region;
  DetailRequest detail;
};
void add_question(Parameters& rows, VolumeQuestion& question);

/// The volumes of a level, or over the other terrain.
struct VolumeRow {
  const VolumeResult* result;
  std::optional<double> level;
};
[[nodiscard]] Fields<VolumeRow> volume_row_fields();

struct VolumeAnswer {
  std::vector<VolumeRow> rows;
  std::string against;                     ///< The other terrain; empty: none.
  std::optional<AnswerFacts> other_facts;  ///< What is certain of the other terrain.
  std::string ground_unit;
};
[[nodiscard]] Fields<VolumeAnswer> volume_fields();

// Meshes: `ptin refine`, `stream` and `unstream`.

struct MeshAnswer {
  const RefinedTin* refined;
  std::uint64_t vertices = 0, triangles = 0;  ///< What the output has.
  const tools::LocalFrame* frame = nullptr;   ///< Null: the output has none.
};
[[nodiscard]] Fields<MeshAnswer> mesh_fields();
[[nodiscard]] Fields<tools::LocalFrame> frame_fields();
[[nodiscard]] Fields<StreamSummary> stream_fields();

}  // namespace ptin::ask
