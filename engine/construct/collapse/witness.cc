// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/witness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// A sample as a candidate. The heaviest of each corner and side is taken first.
struct Candidate {
  Sample sample;
  int corner = 0;       ///< The corner of its largest barycentric coordinate.
  bool above = false;   ///< Above the triangle; where there is no residual: it has a height.
  double weight = 0.0;  ///< |residual| or charge, height codes.
};

class Judge {
 public:
  Judge(const Tile& tile, TriangleId t) : tile_(tile), triangle_(tile.tin.triangles[t]) {
    is_void_ = tile.tin.classes[t] == TriangleClass::kVoid;
    for (int i = 0; i < 3; ++i) {
      corner_[i] = tile.tin.position(triangle_.v[i]);
      code_[i] = tile.units.heights.code(tile.tin.vertices[triangle_.v[i]].height);
    }
    inverse_ = 1.0 / static_cast<double>(orient(corner_[0], corner_[1], corner_[2]));
  }

  [[nodiscard]] Candidate judge(const Sample& s) const {
    std::array<double, 3> part{};
    for (int i = 0; i < 3; ++i) {
      part[i] = static_cast<double>(
                    orient(s.position, corner_[next_corner(i)], corner_[previous_corner(i)])) *
                inverse_;
    }
    Candidate c{s, 0, false, 0.0};
    c.corner = static_cast<int>(std::max_element(part.begin(), part.end()) - part.begin());
    const bool has_height = !(s.reach < 0.0F);
    if (has_height && !is_void_) {
      const double residual = tile_.units.heights.code(s.height) -
                              (part[0] * code_[0] + part[1] * code_[1] + part[2] * code_[2]);
      c.above = residual > 0.0;
      c.weight = std::abs(residual);
    } else {
      c.above = has_height;
      c.weight = tile_.units.charge(s.reach);
    }
    return c;
  }

 private:
  const Tile& tile_;
  const Triangle& triangle_;
  bool is_void_ = false;
  std::array<GridPoint, 3> corner_{};
  std::array<double, 3> code_{};
  double inverse_ = 0.0;
};

}  // namespace

void choose_witnesses(const Tile& tile, TriangleId t, std::vector<Sample>& samples,
                      std::size_t most) {
  for (Sample& s : samples) {
    s.side_log = 0;
  }
  if (samples.size() <= most) {
    return;
  }
  const Judge judge(tile, t);
  std::vector<Candidate> candidates;
  candidates.reserve(samples.size());
  for (const Sample& s : samples) {
    candidates.push_back(judge.judge(s));
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.weight != b.weight ? a.weight > b.weight
                                : key_of(a.sample.position) < key_of(b.sample.position);
  });
  // First the heaviest of each corner and sign, then the heaviest of the rest.
  samples.clear();
  std::array<bool, 6> taken{};
  std::vector<Sample> rest;
  for (const Candidate& c : candidates) {
    bool& place = taken[static_cast<std::size_t>(2 * c.corner + (c.above ? 1 : 0))];
    (place ? rest : samples).push_back(c.sample);
    place = true;
  }
  rest.resize(std::min(rest.size(), most - samples.size()));
  samples.insert(samples.end(), rest.begin(), rest.end());
}

}  // namespace ptin
