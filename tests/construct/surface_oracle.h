// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is promised of a refined TIN, checked at every sample and at every crossing with the full
// one. Each check returns the first fault in words, or an empty string.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "engine/mesh/tin.h"
#include "storage/record.h"
#include "tests/construct/exact_oracle.h"
#include "tests/construct/test_terrain.h"

namespace ptin::oracle {

/// Samples of a terrain by position, for "which lie in this box".
class SampleIndex {
 public:
  explicit SampleIndex(const std::vector<PlainSample>& samples);
  /// Calls visit(index) for each sample in the box. Cost: the rows of the box that hold samples.
  void for_each_in(const GridBox& box, const std::function<void(std::size_t)>& visit) const;

 private:
  const std::vector<PlainSample>* samples_;
  std::vector<std::int32_t> rows_;
  std::vector<std::size_t> first_of_row_;
};

/// Edges by position, for "which can meet this box".
class EdgeIndex {
 public:
  using Edge = std::array<Corner, 2>;
  explicit EdgeIndex(std::vector<Edge> edges);
  /// Calls visit(edge) for each edge whose box meets `box`. Cost: the edges that begin in the rows
  /// of the box, or one longest edge below.
  template <class Visit>
  void for_each_near(const GridBox& box, const Visit& visit) const {
    for (auto e = first_from(std::int64_t{box.min_y} - tallest_);
         e != edges_.end() && lowest(*e) <= box.max_y; ++e) {
      const GridPoint a = (*e)[0].position;
      const GridPoint b = (*e)[1].position;
      if (std::max(a.x, b.x) >= box.min_x && std::min(a.x, b.x) <= box.max_x &&
          std::max(a.y, b.y) >= box.min_y) {
        visit(*e);
      }
    }
  }

 private:
  [[nodiscard]] static std::int32_t lowest(const Edge& e) {
    return std::min(e[0].position.y, e[1].position.y);
  }
  [[nodiscard]] std::vector<Edge>::const_iterator first_from(std::int64_t y) const;
  std::vector<Edge> edges_;
  std::int64_t tallest_ = 0;
};

[[nodiscard]] Corners corners_of(const Tin& tin, TriangleId t, const HeightEncoding& heights);
[[nodiscard]] GridBox box_of_corners(const Corners& t);
[[nodiscard]] bool is_surface(const Tin& tin, TriangleId t);

using RecordPredicate = std::function<bool(const VertexSplit&)>;

/// `coarse` with the records that satisfy the predicate, in falling rank; those of one rank in the
/// order given, or shuffled. Sets `fault` when a split does not fit.
[[nodiscard]] Tin refined(const Tin& coarse, const std::vector<VertexSplit>& records,
                          const RecordPredicate& predicate, std::string& fault,
                          std::mt19937_64* shuffle = nullptr);

/// Alive triangles by their corners' keys, smallest first, with their classes; sorted.
using NamedTriangle = std::tuple<VertexKey, VertexKey, VertexKey, TriangleClass>;
[[nodiscard]] std::vector<NamedTriangle> named_triangles(const Tin& tin);

/// P2: every sample within `tolerance` (height's unit), or in the wrong class and no deeper than
/// tolerance / slope.
[[nodiscard]] std::string check_samples(const TestTerrain& terrain, const Tin& tin,
                                        double tolerance);

/// P2: at every crossing with an edge of the full surface, and at every sample, within `deviation`
/// (height's unit).
[[nodiscard]] std::string check_deviation(const TestTerrain& terrain, const Tin& tin,
                                          double deviation);

/// The same at `count` random points, by locating them in both TINs; with the slack of doubles.
[[nodiscard]] std::string check_random_points(const TestTerrain& terrain, const Tin& tin,
                                              double deviation, int count, std::uint64_t seed);

}  // namespace ptin::oracle
