// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/las_crs.h"

#include <optional>
#include <string>
#include <utility>

#include "engine/construct/grid/crs.h"

namespace ptin {

namespace {

/// The last text that is understood; else the last one, as it is.
DeclaredCrs crs_of_texts(const LasRecords& records) {
  DeclaredCrs declared;
  std::string& found = declared.crs;
  for (const std::string& text : records.wkt) {
    if (found.empty() || is_crs(text)) {
      if (is_crs(found) && !is_same_crs(found, text)) {
        declared.warnings.push_back(
            {"crs_contradiction",
             "it holds several texts (WKT) of its CRS, which are not the same; the last one is "
             "taken",
             ""});
      }
      found = text;
    }
  }
  if (is_vertical_crs(found)) {
    std::swap(declared.crs, declared.vertical_crs);
  }
  return declared;
}

bool says_nothing(const DeclaredCrs& d) {
  return d.crs.empty() && d.vertical_crs.empty() && d.units == DeclaredUnits{};
}

bool is_understood(const DeclaredCrs& d) {
  return !says_nothing(d) && (d.crs.empty() || is_crs(d.crs));
}

/// Adds what `other` says of heights where `declared` is silent; both are about the same plane.
/// @return  Both say something, and it is not the same.
bool complete_heights(DeclaredCrs& declared, const DeclaredCrs& other) {
  const Crs crs = resolve_crs(declared.crs, "", declared.vertical_crs);
  const Crs of_other = resolve_crs(other.crs, "", other.vertical_crs);
  const auto unit_of = [](const Crs& c, const DeclaredCrs& d) {
    return c.vertical_unit == "unknown" && !d.units.heights.empty() ? d.units.heights
                                                                    : c.vertical_unit;
  };
  const std::string unit = unit_of(crs, declared), unit_of_other = unit_of(of_other, other);
  if (!crs.vertical_known && unit == "unknown") {
    declared.crs = of_other.wkt;
    declared.vertical_crs.clear();
    declared.units.heights = other.units.heights;
    return false;
  }
  return unit_of_other != "unknown" && unit_of_other != unit;
}

}  // namespace

DeclaredCrs crs_of_records(const LasRecords& records, bool is_wkt) {
  DeclaredCrs text = crs_of_texts(records);
  if (records.keys.directory.empty()) {
    return text;
  }
  DeclaredCrs keys = crs_of_keys(records.keys);
  if (says_nothing(text)) {
    return keys;
  }
  DeclaredCrs& first = is_wkt ? text : keys;
  DeclaredCrs& second = is_wkt ? keys : text;
  const std::string name = is_wkt ? "WKT" : "GeoTIFF keys";
  const std::string other = is_wkt ? "GeoTIFF keys" : "WKT";
  if (!is_understood(first)) {
    if (!is_understood(second)) {
      return text;
    }
    second.warnings.push_back(
        {"crs_contradiction",
         "its CRS as " + name + ", which its header says is the one, is not understood; that as " +
             other + " is taken",
         ""});
    return second;
  }
  if (!is_understood(second) || first.crs.empty() || second.crs.empty()) {
    return first;
  }
  if (!is_same_in_plan(first.crs, second.crs) || complete_heights(first, second)) {
    first.warnings.push_back({"crs_contradiction",
                              "its CRS is one as WKT and another one as GeoTIFF keys; the " + name +
                                  " is taken, as its header says",
                              ""});
  }
  return first;
}

}  // namespace ptin
