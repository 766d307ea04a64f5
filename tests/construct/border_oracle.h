// SPDX-License-Identifier: GPL-3.0-or-later
//
// The border between surface and void, measured by looking at all of it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/mesh/tin.h"
#include "tests/construct/test_terrain.h"

namespace ptin::oracle {

struct PlanPoint {
  double x, y;
};

/// The sides of surface triangles with a void triangle beyond.
class Border {
 public:
  explicit Border(const Tin& tin);
  /// Distance in grid steps; infinite where there is no border. Cost: all sides.
  [[nodiscard]] double distance(PlanPoint p) const;
  [[nodiscard]] const std::vector<std::array<PlanPoint, 2>>& sides() const { return sides_; }
  [[nodiscard]] double length() const;

 private:
  std::vector<std::array<PlanPoint, 2>> sides_;
};

/// Sets the depth of every sample.
void measure_depths(TestTerrain& terrain);

/// At tolerance E no point of the border is farther than E / slope from that of the full TIN, none of
/// the full TIN's farther from it, and nothing deeper than that has changed its class; regions of
/// surface that are farther apart are neither joined nor lost. Points are looked at along the borders
/// and within all triangles of the full TIN.
[[nodiscard]] std::string check_border(const TestTerrain& terrain, const Tin& tin,
                                       double tolerance);

}  // namespace ptin::oracle
