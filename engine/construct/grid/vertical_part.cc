// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/vertical_part.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include "engine/crs/height_unit.h"

namespace ptin {

namespace {

std::string or_empty(const char* text) { return text == nullptr ? "" : text; }

/// The unit as EPSG writes it in names of CRSs.
std::string short_name(const std::string& unit) {
  return unit == "US survey foot" ? "ftUS" : (unit == "foot" ? "ft" : unit);
}

std::string wkt_of(const OGR_SRSNode& node) {
  char* text = nullptr;
  node.exportToWkt(&text);
  std::string wkt = or_empty(text);
  CPLFree(text);
  return wkt;
}

}  // namespace

bool is_no_name(const std::string& name) {
  return name.empty() || name == "unknown" || name == "unnamed";
}

LengthUnit vertical_unit_of(const OGRSpatialReference& srs) {
  const char* name = nullptr;
  const double metres = srs.GetTargetLinearUnits("VERT_CS", &name);
  return {unit_called(or_empty(name), metres), metres};
}

bool is_vertical_unnamed(const OGRSpatialReference& srs) {
  return is_no_name(or_empty(srs.GetAttrValue("VERT_CS"))) &&
         is_no_name(or_empty(srs.GetAttrValue("VERT_DATUM")));
}

std::string vertical_text(const OGRSpatialReference& srs, const LengthUnit& unit) {
  const OGR_SRSNode* const part = srs.GetAttrNode("VERT_CS");
  if (part == nullptr) {
    return "";
  }
  if (std::abs(unit.metres / vertical_unit_of(srs).metres - 1.0) <= 1e-9) {
    const std::string authority = or_empty(srs.GetAuthorityName("VERT_CS"));
    const std::string code = or_empty(srs.GetAuthorityCode("VERT_CS"));
    return authority.empty() || code.empty() ? wkt_of(*part) : authority + ":" + code;
  }
  const std::unique_ptr<OGR_SRSNode> other(part->Clone());
  other->StripNodes("AUTHORITY");
  OGR_SRSNode* const name = other->GetChild(0);
  name->SetValue((or_empty(name->GetValue()) + " (" + short_name(unit.name) + ")").c_str());
  if (OGR_SRSNode* const of_unit = other->GetNode("UNIT"); of_unit != nullptr) {
    char metres[40];
    std::snprintf(metres, sizeof metres, "%.17g", unit.metres);
    of_unit->GetChild(0)->SetValue(unit.name.c_str());
    of_unit->GetChild(1)->SetValue(metres);
  }
  return wkt_of(*other);
}

}  // namespace ptin
