// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/crs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include "engine/construct/grid/dataset_crs.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/grid/plain_datum.h"
#include "engine/construct/grid/vertical_part.h"
#include "engine/crs/crs_facts.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "engine/handle.h"

namespace ptin {
namespace {

/// Reads any text that GDAL understands. False for others.
bool read(const std::string& text, OGRSpatialReference& srs) {
  const char* const options[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
  if (srs.SetFromUserInput(text.c_str(), options) != OGRERR_NONE) {
    return false;
  }
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return true;
}

/// Reads any text that GDAL understands. `role` names it in the error.
OGRSpatialReference parse(const std::string& text, const char* role) {
  const GdalSession session;
  OGRSpatialReference srs;
  if (!read(text, srs)) {
    throw Error(ErrorCode::invalid_argument,
                session.explain(std::string("the ") + role + " '" + text.substr(0, 80) +
                                "' is not one that GDAL understands; give a code such as "
                                "EPSG:32611, WKT or PROJJSON"));
  }
  return srs;
}

std::string or_unknown(const char* name) {
  return name == nullptr || *name == '\0' ? "unknown" : name;
}

/// The unit of heights of a CRS that has a vertical part.
std::string vertical_unit(const OGRSpatialReference& srs) {
  if (srs.IsCompound()) {
    return vertical_unit_of(srs).name;
  }
  double metres = 0.0;
  OGRAxisOrientation orientation = OAO_Other;
  if (srs.GetAxis(nullptr, 2, &orientation, &metres) == nullptr) {
    return "unknown";
  }
  return unit_called("", metres);
}

bool is_horizontal(const OGRSpatialReference& srs) {
  return srs.IsGeographic() || srs.IsProjected() || srs.IsLocal();
}

void check_horizontal(const OGRSpatialReference& srs, const char* role) {
  if (is_horizontal(srs)) {
    return;
  }
  const char* kind = srs.IsVertical() ? "a vertical CRS alone" : "neither geographic nor projected";
  throw Error(ErrorCode::invalid_argument,
              std::string("the ") + role + " '" + or_unknown(srs.GetName()) + "' is " + kind +
                  "; a terrain needs a geographic or projected CRS (a vertical one can be added to "
                  "it)");
}

/// `horizontal` with `vertical_crs` as its vertical part.
OGRSpatialReference with_vertical(OGRSpatialReference horizontal, const std::string& vertical_crs) {
  const OGRSpatialReference vertical = parse(vertical_crs, "vertical CRS");
  if (!vertical.IsVertical() || vertical.IsCompound()) {
    throw Error(ErrorCode::invalid_argument,
                "the vertical CRS '" + vertical_crs +
                    "' is not a vertical CRS; give one such as EPSG:5773 (EGM96 height)");
  }
  if (horizontal.IsCompound()) {
    horizontal.StripVertical();
  }
  if (horizontal.GetAxesCount() == 3) {
    horizontal.DemoteTo2D(nullptr);
  }
  const std::string name =
      or_unknown(horizontal.GetName()) + " + " + or_unknown(vertical.GetName());
  OGRSpatialReference compound;
  if (compound.SetCompoundCS(name.c_str(), &horizontal, &vertical) != OGRERR_NONE) {
    throw Error(ErrorCode::invalid_argument, "the vertical CRS '" + vertical_crs +
                                                 "' cannot be added to '" +
                                                 or_unknown(horizontal.GetName()) + "'");
  }
  return compound;
}

/// Depths grow downwards: taken for heights, the terrain would be upside down.
void require_upwards(const OGRSpatialReference& srs) {
  OGRAxisOrientation orientation = OAO_Other;
  if (srs.GetAxis(srs.IsCompound() != 0 ? "COMPD_CS|VERT_CS" : nullptr,
                  srs.IsCompound() != 0 ? 0 : 2, &orientation) != nullptr &&
      orientation == OAO_Down) {
    throw Error(ErrorCode::invalid_argument,
                "the vertical axis of the CRS '" + or_unknown(srs.GetName()) +
                    "' points down: it counts depths, and a terrain has heights; turn the sign of "
                    "the values, and name a vertical CRS of heights with --vertical-crs");
  }
}

Crs describe(OGRSpatialReference srs) {
  Crs crs;
  if (srs.IsCompound() && is_vertical_unnamed(srs)) {
    // The vertical part states a unit alone. A name that gives the unit's length is enough.
    const LengthUnit unit = vertical_unit_of(srs);
    if (metres_in(unit.name)) {
      crs.vertical_unit = unit.name;
      srs.StripVertical();
    }
  }
  crs.wkt = wkt2_of(srs);
  if (crs.wkt.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "the CRS cannot be written as WKT2:2019; give another one instead");
  }
  crs.geographic = srs.IsGeographic() != 0;
  const char* name = nullptr;
  if (crs.geographic) {
    srs.GetAngularUnits(&name);
    crs.horizontal_unit = or_unknown(name);
  } else {
    const double metres = srs.GetLinearUnits(&name);
    crs.horizontal_unit = unit_called(name == nullptr ? "" : name, metres);
  }
  crs.vertical_known = srs.IsCompound() != 0 || srs.GetAxesCount() == 3;
  if (crs.vertical_known) {
    require_upwards(srs);
    crs.vertical_unit = vertical_unit(srs);
  }
  return crs;
}

/// The beginning of a text, on one line.
std::string in_quotes(const std::string& text) {
  std::string line = text.substr(0, 80);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  return "'" + line.substr(0, line.find_last_not_of(' ') + 1) + "'";
}

/// The CRS that a source declares; parts that are not understood are taken out and warned of.
class OwnCrs {
 public:
  OwnCrs(DeclaredTexts declared, const std::string& file, SourceWarnings& warnings)
      : declared_(std::move(declared)), file_(file), warnings_(warnings) {
    if (is_vertical_crs(declared_.crs)) {
      declared_.vertical_crs = std::exchange(declared_.crs, "");
    }
    warn_of_shift(declared_.crs, file_, warnings_);
    warn_of_shift(declared_.vertical_crs, file_, warnings_);
    drop_unknown(declared_.crs, "CRS", "name it by --a-srs");
    drop_nameless();
    drop_unknown(declared_.vertical_crs, "vertical CRS", "name it by --vertical-crs");
  }

  /// @param vertical_crs  What the caller puts in the place of the vertical part; "" for nothing.
  [[nodiscard]] Crs resolve(const std::string& vertical_crs) {
    if (!vertical_crs.empty() || declared_.vertical_crs.empty() || !declared_.crs.empty()) {
      Crs crs = resolve_crs(declared_.crs, "",
                            vertical_crs.empty() ? declared_.vertical_crs : vertical_crs);
      warn_of_unit(crs);
      return with_unit(std::move(crs));
    }
    // A compound CRS shows what a vertical one is: any other part in plan does.
    const Crs with_any_plane = resolve_crs("EPSG:32631", "", declared_.vertical_crs);
    warn("crs_vertical_alone",
         "it names the vertical CRS " + in_quotes(declared_.vertical_crs) +
             " and no horizontal one; the unit of its heights is kept, and the terrain has no CRS; "
             "name both by --a-srs and --vertical-crs");
    Crs crs;
    crs.vertical_unit = with_any_plane.vertical_unit;
    return with_unit(std::move(crs));
  }

 private:
  void warn(const char* kind, std::string message) {
    warnings_.add({kind, std::move(message), file_});
  }
  void drop_unknown(std::string& text, const std::string& what, const std::string& cure) {
    const GdalSession session;
    OGRSpatialReference srs;
    if (!text.empty() && !read(text, srs)) {
      warn("crs_not_understood", "its " + what + ", " + in_quotes(text) +
                                     ", is not one that GDAL understands; the terrain is without "
                                     "it; " +
                                     cure);
      text.clear();
    }
  }

  /// Programs write a local CRS without a name for one that they do not know.
  void drop_nameless() {
    const GdalSession session;
    OGRSpatialReference srs;
    if (declared_.crs.empty() || !read(declared_.crs, srs) || srs.IsLocal() == 0 ||
        !is_no_name(or_unknown(srs.GetName()))) {
      return;
    }
    const char* name = nullptr;
    const double metres = srs.GetLinearUnits(&name);
    plane_unit_ = unit_called(name == nullptr ? "" : name, metres);
    warn("crs_nameless",
         "its CRS has no name and is no place on Earth, as where a code or a projection is not "
         "known; the terrain is without it, but for its unit, '" +
             plane_unit_ + "'; name the CRS by --a-srs");
    declared_.crs.clear();
  }
  void warn_of_unit(const Crs& crs) {
    if (!crs.wkt.empty() && crs.horizontal_unit == "unknown") {
      warn("crs_unit",
           "its CRS does not tell the unit of its coordinates, which is not known then; name the "
           "CRS by --a-srs");
    }
  }
  [[nodiscard]] Crs with_unit(Crs crs) const {
    if (crs.wkt.empty()) {
      crs.horizontal_unit = plane_unit_;
    }
    return crs;
  }

  DeclaredTexts declared_;
  std::string plane_unit_ = "unknown";  ///< The unit of a CRS that was dropped.
  const std::string& file_;
  SourceWarnings& warnings_;
};

/// True when two texts name the same CRS once `prepare` has seen both. A text that GDAL does not
/// understand is the same as itself alone.
template <class Prepare>
bool are_same(const std::string& wkt_a, const std::string& wkt_b, const Prepare& prepare) {
  if (wkt_a == wkt_b) {
    return true;
  }
  if (wkt_a.empty() || wkt_b.empty()) {
    return false;
  }
  const GdalSession session;
  OGRSpatialReference a, b;
  if (!read(wkt_a, a) || !read(wkt_b, b)) {
    return false;
  }
  prepare(a);
  prepare(b);
  const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                 "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
  return a.IsSame(&b, options) != 0;
}

/// "ETRS89 / UTM zone 32N (EPSG:25832)".
std::string with_code(const std::string& name, const std::string& code) {
  return code.empty() ? name : name + " (" + code + ")";
}

std::string name_in_plan(const DeclaredTexts& declared) {
  if (declared.crs.empty()) {
    return "no CRS";
  }
  if (!is_crs(declared.crs)) {
    return in_quotes(declared.crs);
  }
  const CrsFacts facts = crs_facts(resolve_crs(declared.crs, "", "").wkt);
  return with_code(facts.name, facts.code);
}

std::string name_of_vertical(const DeclaredTexts& declared) {
  const bool is_apart = !declared.vertical_crs.empty();
  if (is_apart ? !is_vertical_crs(declared.vertical_crs) : !is_crs(declared.crs)) {
    return is_apart ? in_quotes(declared.vertical_crs) : "no vertical CRS";
  }
  // A compound CRS shows what a vertical one is: any other part in plan does.
  const Crs crs = is_apart ? resolve_crs("EPSG:32631", "", declared.vertical_crs)
                           : resolve_crs(declared.crs, "", "");
  const CrsFacts facts = crs_facts(crs.wkt);
  return facts.vertical_name.empty() ? "no vertical CRS"
                                     : with_code(facts.vertical_name, facts.vertical_code);
}

/// Warns of axes that point elsewhere than those of a terrain.
void warn_of_axes(const Crs& crs, const std::string& file, SourceWarnings& warnings) {
  const GdalSession session;
  OGRSpatialReference srs;
  if (crs.wkt.empty() || !read(crs.wkt, srs)) {
    return;
  }
  const auto direction = [&](int axis) {
    OGRAxisOrientation found = OAO_Other;
    return srs.GetAxis(nullptr, axis, &found) == nullptr ? OAO_Other : found;
  };
  const OGRAxisOrientation x = direction(0), y = direction(1);
  // Both axes of a polar CRS may point to the south, along two meridians.
  const bool is_south = (x == OAO_South) != (y == OAO_South);
  if (x == OAO_West || y == OAO_West || is_south) {
    warnings.add(
        {"crs_axes",
         "its CRS counts to the west or to the south; x and y are taken as they are, as if "
         "they grew to the east and to the north, so directions (aspect, hillshade, "
         "'northernmost') are of the numbers, not of the ground",
         file});
  }
}

}  // namespace

std::string wkt2_of(const OGRSpatialReference& srs) {
  char* text = nullptr;
  static constexpr const char* kOptions[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  const bool is_written = srs.exportToWkt(&text, kOptions) == OGRERR_NONE && text != nullptr;
  const Handle<char, &VSIFree> kept(text);
  return is_written ? with_plain_datums(text) : "";
}

Crs resolve_source_crs(const DeclaredTexts& declared, const SourceOptions& options,
                       const std::string& file, SourceWarnings& warnings) try {
  Crs crs = options.a_srs.empty() ? OwnCrs(declared, file, warnings).resolve(options.vertical_crs)
                                  : resolve_crs("", options.a_srs, options.vertical_crs);
  warn_of_axes(crs, file, warnings);
  return crs;
} catch (const Error& e) {
  throw Error(e.code(), e.message(), e.context().empty() ? file : e.context());
}

SourceWarnings warnings_that_count(const SourceWarnings& all, const SourceOptions& options,
                                   std::uint64_t lines_before) {
  SourceWarnings some;
  for (SourceWarning w : all.all()) {
    if (options.a_srs.empty() || !w.kind.starts_with("crs_")) {
      w.line += w.line > 0 ? lines_before : 0;
      some.add(std::move(w));
    }
  }
  return some;
}

Crs resolve_crs(const std::string& declared, const std::string& a_srs,
                const std::string& vertical_crs) {
  const std::string& text = a_srs.empty() ? declared : a_srs;
  if (text.empty()) {
    if (!vertical_crs.empty()) {
      throw Error(ErrorCode::invalid_argument,
                  "there is no horizontal CRS to add the vertical CRS '" + vertical_crs +
                      "' to; give that one as well by --a-srs");
    }
    return {};
  }
  const char* role = a_srs.empty() ? "source's CRS" : "CRS";
  OGRSpatialReference srs = parse(text, role);
  const GdalSession session;
  check_horizontal(srs, role);
  return describe(vertical_crs.empty() ? srs : with_vertical(srs, vertical_crs));
}

bool is_crs(const std::string& text) {
  const GdalSession session;
  OGRSpatialReference srs;
  return !text.empty() && read(text, srs) && is_horizontal(srs);
}

bool is_vertical_crs(const std::string& text) {
  const GdalSession session;
  OGRSpatialReference srs;
  return !text.empty() && read(text, srs) && srs.IsVertical() && !srs.IsCompound();
}

bool is_same_crs(const std::string& wkt_a, const std::string& wkt_b) {
  return are_same(wkt_a, wkt_b, [](OGRSpatialReference&) {});
}

bool is_same_in_plan(const std::string& wkt_a, const std::string& wkt_b) {
  return are_same(wkt_a, wkt_b, [](OGRSpatialReference& srs) {
    srs.StripVertical();
    if (srs.GetAxesCount() == 3) {
      srs.DemoteTo2D(nullptr);
    }
  });
}

std::optional<CrsDifference> difference_of(const DeclaredTexts& first,
                                           const DeclaredTexts& second) {
  if (is_same_crs(first.crs, second.crs) && is_same_crs(first.vertical_crs, second.vertical_crs)) {
    return std::nullopt;
  }
  const bool is_in_plan = !is_same_in_plan(first.crs, second.crs);
  CrsDifference names{is_in_plan ? name_in_plan(first) : name_of_vertical(first),
                      is_in_plan ? name_in_plan(second) : name_of_vertical(second)};
  if (names.first == names.second) {
    names.second += " of other parameters";
  }
  return names;
}

void warn_of_no_crs(const TerrainFrame& frame, const std::string& file, SourceWarnings& warnings) {
  const auto& all = warnings.all();
  const bool is_told = std::any_of(all.begin(), all.end(), [](const SourceWarning& w) {
    return w.kind.starts_with("crs_") || w.kind == "degrees_without_crs";
  });
  if (frame.crs_wkt.empty() && !is_told) {
    warnings.add({"crs_none",
                  "no CRS is declared, so the terrain has none and lies nowhere on a map; name it "
                  "by --a-srs",
                  file});
  }
}

void set_crs(TerrainFrame& frame, const Crs& crs) {
  frame.crs_wkt = crs.wkt;
  frame.vertical_crs_known = crs.vertical_known;
  frame.geographic = crs.geographic;
  frame.horizontal_unit = crs.horizontal_unit;
  frame.vertical_unit = crs.vertical_unit;
}

void set_units(TerrainFrame& frame, const DeclaredUnits& units, bool is_own,
               const std::string& context) {
  if (frame.crs_wkt.empty()) {
    if (!units.plane.empty()) {
      frame.horizontal_unit = units.plane;
    }
  } else if (is_own) {
    // The two feet are confused so often, and differ so little, that the CRS is believed.
    constexpr double kAlike = 1e-5;
    const std::optional<double> said = metres_in(units.plane);
    const std::optional<double> meant = metres_in(height_unit_named(frame.horizontal_unit));
    const bool is_alike = said && meant && std::abs(*said / *meant - 1.0) < kAlike;
    if (said && !is_alike && (meant || frame.geographic)) {
      throw Error(ErrorCode::invalid_argument,
                  "the file says that its coordinates are in units of '" + units.plane +
                      "', but the unit of the CRS that it names is '" + frame.horizontal_unit +
                      "'; say with --a-srs in which CRS they are",
                  context);
    }
  }
  if (frame.vertical_unit == "unknown" && !units.heights.empty()) {
    frame.vertical_unit = units.heights;
  }
}

void require_latitudes(const TerrainFrame& frame, std::int64_t rows, const std::string& context) {
  constexpr double kMost = 91.0;  // pixels of global grids reach beyond the poles
  const double south = frame.map.to_map(0.0, 0.0).y;
  const double north = frame.map.to_map(0.0, static_cast<double>(rows)).y;
  if (frame.horizontal_unit != "degree" || (south >= -kMost && north <= kMost)) {
    return;
  }
  char text[240];
  std::snprintf(text, sizeof text,
                "y from %.10g to %.10g are no latitudes, but the CRS has degrees; name the CRS of "
                "these coordinates by --a-srs, or exchange x and y where y is the longitude (text: "
                "--columns)",
                south, north);
  throw Error(ErrorCode::invalid_argument, text, context);
}

void require_longitudes(const TerrainFrame& frame, std::int64_t columns, bool is_split,
                        const std::string& context) {
  if (!frame.geographic || frame.horizontal_unit != "degree") {
    return;
  }
  const double west = frame.map.to_map(0.0, 0.0).x;
  const double east = frame.map.to_map(static_cast<double>(columns), 0.0).x;
  char text[320];
  if (west < -360.0 || east > 540.0) {
    std::snprintf(
        text, sizeof text,
        "x from %.10g to %.10g are no longitudes, but the CRS has degrees; name the CRS of "
        "these coordinates by --a-srs",
        west, east);
    throw Error(ErrorCode::invalid_argument, text, context);
  }
  if (is_split) {
    std::snprintf(
        text, sizeof text,
        "longitudes from %.10g to %.10g, with half of the world empty between them: this "
        "lies on both sides of the 180th meridian, and the terrain would reach around the "
        "world; add 360 to the longitudes below 0",
        west, east);
    throw Error(ErrorCode::invalid_argument, text, context);
  }
}

GroundMetric::GroundMetric(const TerrainFrame& frame) : map_(frame.map) {
  if (!frame.geographic) {
    return;
  }
  const OGRSpatialReference srs = parse(frame.crs_wkt, "terrain's CRS");
  const GdalSession session;
  radians_per_unit_ = srs.GetAngularUnits();
  semi_major_m_ = srs.GetSemiMajor();
  const double inverse_flattening = srs.GetInvFlattening();
  const double flattening = inverse_flattening == 0.0 ? 0.0 : 1.0 / inverse_flattening;
  eccentricity_squared_ = flattening * (2.0 - flattening);
}

GroundStep GroundMetric::at(double grid_y) const noexcept {
  if (is_uniform()) {
    return {map_.step_x, map_.step_y};
  }
  // Radii of curvature of the ellipsoid, along the meridian (m) and across it (n).
  const double latitude = (map_.origin_y + map_.step_y * grid_y) * radians_per_unit_;
  const double sine = std::sin(latitude);
  const double w2 = 1.0 - eccentricity_squared_ * sine * sine;
  const double n = semi_major_m_ / std::sqrt(w2);
  const double m = n * (1.0 - eccentricity_squared_) / w2;
  const double cosine = std::max(0.0, std::cos(latitude));
  return {map_.step_x * radians_per_unit_ * n * cosine, map_.step_y * radians_per_unit_ * m};
}

}  // namespace ptin
