// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_faults.h"

#include <cstdio>
#include <utility>

#include "engine/error.h"

namespace ptin {

namespace {

class FaultReport {
 public:
  FaultReport(const AffineMap& map, std::string path) : map_(map), path_(std::move(path)) {}

  void add(const TinFault& fault, const char* one, const char* many) {
    if (fault.count == 0) {
      return;
    }
    const MapPoint at = map_.to_map(fault.first.x, fault.first.y);
    char place[80];
    std::snprintf(place, sizeof place, " (%s at %.15g %.15g)", fault.count > 1 ? "first" : "it is",
                  at.x, at.y);
    text_ += (text_.empty() ? "" : "; ") + std::to_string(fault.count) + " " +
             (fault.count == 1 ? one : many) + place;
  }
  /// @param turned_in_source  As in TinFaults. They show where a surface is folded.
  void throw_if_any(std::uint64_t turned_in_source) {
    if (!text_.empty()) {
      if (turned_in_source > 0) {
        text_ += "; " + std::to_string(turned_in_source) +
                 (turned_in_source == 1 ? " triangle is" : " triangles are") +
                 " turned over beside the others";
      }
      throw Error(ErrorCode::invalid_argument,
                  "these triangles are no terrain: " + text_ +
                      "; mend the file, or let --repair triangulate its points anew",
                  path_);
    }
  }

 private:
  AffineMap map_;
  std::string path_;
  std::string text_;
};

}  // namespace

void TinFaults::refuse(const AffineMap& map, const std::string& path) const {
  FaultReport report(map, path);
  report.add(no_area, "triangle has no area", "triangles have no area");
  report.add(turned_over, "triangle is turned over", "triangles are turned over");
  report.add(heights, "position has several heights", "positions have several heights");
  report.add(shared_edges, "edge has two triangles on one side",
             "edges have two triangles on one side");
  report.add(t_junctions, "vertex lies inside of an edge (T-junction)",
             "vertices lie inside of an edge (T-junctions)");
  report.add(crossings, "pair of border edges crosses", "pairs of border edges cross");
  report.add(covered, "piece is covered more than once", "pieces are covered more than once");
  report.throw_if_any(turned_in_source);
}

}  // namespace ptin
