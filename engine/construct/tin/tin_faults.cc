// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_faults.h"

#include <cstdio>
#include <utility>

#include "engine/error.h"

namespace ptin {

namespace {

/// Adds a kind of fault to a report, if there is any.
void tell(const TinFault& fault, const char* one, const char* many, const AffineMap& map,
          std::string& report) {
  if (fault.count == 0) {
    return;
  }
  const MapPoint at = map.to_map(fault.first.x, fault.first.y);
  char place[80];
  std::snprintf(place, sizeof place, " (%s at %.15g %.15g)", fault.count > 1 ? "first" : "it is",
                at.x, at.y);
  report += (report.empty() ? "" : "; ") + std::to_string(fault.count) + " " +
            (fault.count == 1 ? one : many) + place;
}

}  // namespace

void TinFaults::refuse(const AffineMap& map, const std::string& path) const {
  std::string report;
  const auto add = [&](const TinFault& fault, const char* one, const char* many) {
    tell(fault, one, many, map, report);
  };
  add(no_area, "triangle has no area", "triangles have no area");
  add(turned_over, "triangle is turned over", "triangles are turned over");
  add(heights, "position has several heights", "positions have several heights");
  add(shared_edges, "edge has two triangles on one side", "edges have two triangles on one side");
  add(t_junctions, "vertex lies inside of an edge (T-junction)",
      "vertices lie inside of an edge (T-junctions)");
  add(crossings, "pair of border edges crosses", "pairs of border edges cross");
  add(covered, "piece is covered more than once", "pieces are covered more than once");
  if (report.empty()) {
    return;
  }
  if (turned_in_source > 0) {  // they show where a surface is folded
    report += "; " + std::to_string(turned_in_source) +
              (turned_in_source == 1 ? " triangle is" : " triangles are") +
              " turned over beside the others";
  }
  throw Error(ErrorCode::invalid_argument,
              "these triangles are no terrain: " + report +
                  "; mend the file, or let --repair triangulate its points anew",
              path);
}

}  // namespace ptin
