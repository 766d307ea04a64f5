// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/crs_facts.h"

#include <atomic>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <ogr_spatialref.h>

#include "engine/crs/height_unit.h"

namespace ptin {

namespace {

std::atomic<std::uint64_t> texts_read{0};

std::string text_or_empty(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

/// "AUTHORITY:CODE" of a node of the CRS, null for the root; empty when the node has no code.
std::string code_of(const OGRSpatialReference& srs, const char* node) {
  const char* authority = srs.GetAuthorityName(node);
  const char* code = srs.GetAuthorityCode(node);
  if (authority == nullptr || code == nullptr) return {};
  return std::string(authority).append(":").append(code);
}

void add_compound(const OGRSpatialReference& srs, CrsFacts& facts) {
  facts.vertical_name = text_or_empty(srs.GetAttrValue("VERT_CS"));
  facts.vertical_code = code_of(srs, "VERT_CS");
  const char* unit = nullptr;
  const double metres = srs.GetTargetLinearUnits("VERT_CS", &unit);
  facts.vertical_unit = unit_called(text_or_empty(unit), metres);
  facts.ground.metres_per_height = metres;
}

/// Sets the facts of a CRS whose third axis counts heights.
void add_third_axis(const OGRSpatialReference& srs, CrsFacts& facts) {
  facts.has_third_axis = true;
  facts.vertical_name = srs.IsLocal() != 0 ? facts.name : "ellipsoidal height";
  facts.vertical_code = facts.code;
  double metres = 0.0;
  if (srs.GetAxis(nullptr, 2, nullptr, &metres) != nullptr)
    facts.vertical_unit = unit_called("", metres);
}

/// Sets the ellipsoid, the size of the map unit, and the order of the axes.
void add_ground(const OGRSpatialReference& srs, CrsFacts& facts) {
  GroundFacts& ground = facts.ground;
  ground.geographic = facts.geographic;
  ground.semi_major = srs.GetSemiMajor();
  ground.inverse_flattening = srs.GetInvFlattening();
  if (facts.geographic) {
    ground.radians_per_map_unit = srs.GetAngularUnits();
  } else {
    ground.metres_per_map_unit = srs.GetLinearUnits();
  }
  facts.north_first = srs.EPSGTreatsAsLatLong() != 0 || srs.EPSGTreatsAsNorthingEasting() != 0;
}

}  // namespace

std::uint64_t crs_texts_read() noexcept { return texts_read; }

CrsFacts crs_facts(const std::string& wkt) {
  CrsFacts facts;
  facts.wkt = wkt;
  if (wkt.empty()) return facts;
  ++texts_read;
  const CPLErrorHandlerPusher silent(CPLQuietErrorHandler);
  OGRSpatialReference srs;
  if (srs.importFromWkt(wkt.c_str()) != OGRERR_NONE) return facts;
  facts.is_understood = true;
  facts.geographic = srs.IsGeographic() != 0;
  add_ground(srs, facts);
  const bool is_compound = srs.IsCompound() != 0;
  const char* node = srs.IsProjected() != 0 ? "PROJCS" : (facts.geographic ? "GEOGCS" : "LOCAL_CS");
  facts.name = text_or_empty(srs.GetAttrValue(node));
  if (facts.name.empty() && !is_compound) facts.name = text_or_empty(srs.GetName());
  facts.code = code_of(srs, is_compound ? node : nullptr);
  const char* unit = nullptr;
  const double size = facts.geographic ? srs.GetAngularUnits(&unit) : srs.GetLinearUnits(&unit);
  if (unit != nullptr) facts.horizontal_unit = facts.geographic ? unit : unit_called(unit, size);
  if (is_compound) {
    add_compound(srs, facts);
  } else if (srs.GetAxesCount() == 3) {
    add_third_axis(srs, facts);
  }
  return facts;
}

bool is_same_plane(const CrsFacts& a, const CrsFacts& b) {
  if (a.is_understood && a.wkt == b.wkt) return true;
  const CPLErrorHandlerPusher silent(CPLQuietErrorHandler);
  OGRSpatialReference of_a, of_b;
  const bool is_known = !a.wkt.empty() && !b.wkt.empty() &&
                        of_a.importFromWkt(a.wkt.c_str()) == OGRERR_NONE &&
                        of_b.importFromWkt(b.wkt.c_str()) == OGRERR_NONE;
  if (!is_known) {
    return a.horizontal_unit == b.horizontal_unit || a.horizontal_unit == "unknown" ||
           b.horizontal_unit == "unknown";
  }
  for (OGRSpatialReference* srs : {&of_a, &of_b}) {
    srs->StripVertical();
    if (srs->GetAxesCount() == 3) srs->DemoteTo2D(nullptr);
  }
  const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                 "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
  return of_a.IsSame(&of_b, options) != 0;
}

}  // namespace ptin
