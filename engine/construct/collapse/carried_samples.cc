// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/carried_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// A sample as a candidate. The heaviest of each corner and side is taken first.
struct Candidate {
  [[nodiscard]] std::size_t place() const {
    return static_cast<std::size_t>(2 * corner + (above ? 1 : 0));
  }
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

bool is_heavier(const Candidate& a, const Candidate& b) {
  if (a.weight != b.weight) {
    return a.weight > b.weight;
  }
  const VertexKey of_a = key_of(a.sample.position), of_b = key_of(b.sample.position);
  return of_a != of_b ? of_a < of_b : a.sample.direction < b.sample.direction;
}

/// Moves the heaviest of each corner and sign to the front. Returns the end of these.
std::vector<Candidate>::iterator heaviest_of_places(std::vector<Candidate>& candidates) {
  std::array<std::size_t, 6> heaviest{};
  heaviest.fill(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::size_t& best = heaviest[candidates[i].place()];
    if (best == candidates.size() || is_heavier(candidates[i], candidates[best])) {
      best = i;
    }
  }
  std::sort(heaviest.begin(), heaviest.end());  // so that no swap moves one that is still to come
  auto end = candidates.begin();
  for (const std::size_t i : heaviest) {
    if (i < candidates.size()) {
      std::swap(*end++, candidates[i]);
    }
  }
  return end;
}

}  // namespace

void choose_carried_samples(const Tile& tile, TriangleId t, std::vector<Sample>& samples,
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
  // First the heaviest of each corner and sign, then the heaviest of the rest.
  const auto rest = heaviest_of_places(candidates);
  const auto taken = static_cast<std::size_t>(rest - candidates.begin());
  const auto end = rest + static_cast<std::ptrdiff_t>(std::min(candidates.size(), most) - taken);
  std::nth_element(rest, end, candidates.end(), is_heavier);  // cheaper than to sort them all
  std::sort(candidates.begin(), rest, is_heavier);
  std::sort(rest, end, is_heavier);
  samples.clear();
  std::transform(candidates.begin(), end, std::back_inserter(samples),
                 [](const Candidate& c) { return c.sample; });
}

}  // namespace ptin
