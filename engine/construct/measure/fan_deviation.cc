// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/fan_deviation.h"

#include <algorithm>

#include "engine/mesh/collapse.h"

namespace ptin {

namespace {

/// Finds the spokes of a fan that are new to a surface triangle. The first and the last spoke are
/// the link edges at w.
class SpokeFilter {
 public:
  SpokeFilter(const Tile& tile, const StarSamples& s, const FanFrame& fan)
      : tile_(tile), star_(s.star), fan_(fan), site_(collapse_site(s.star, fan.j)) {}

  [[nodiscard]] bool counts(std::size_t spoke) const {
    if (spoke == 0) {
      return is_void(site_.left) && is_surface(0);
    }
    if (spoke == fan_.triangles()) {
      return is_void(site_.right) && is_surface(spoke - 1);
    }
    return is_surface(spoke - 1) || is_surface(spoke);
  }

 private:
  [[nodiscard]] bool is_void(TriangleId t) const {
    return t != kNone && tile_.tin.classes[t] == TriangleClass::kVoid;
  }
  [[nodiscard]] bool is_surface(std::size_t i) const {
    return !is_void(star_.triangles[fan_.star_triangle[i]]);
  }
  const Tile& tile_;
  const Star& star_;
  const FanFrame& fan_;
  CollapseSite site_;
};

/// The largest gap(w, end) over the edges of a fan that are new to a surface triangle.
template <class Gap>
double largest_over_spokes(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                           const GridBox& within, const Gap& gap) {
  const Star& star = s.star;
  const auto end_of = [&](std::size_t link) {
    const VertexId v = star.link[link];
    return EdgeEnd{tile.tin.position(v), tile.units.heights.code(tile.tin.vertices[v].height)};
  };
  const SpokeFilter filter(tile, s, fan);
  const EdgeEnd w = end_of(fan.j);
  double worst = 0.0;
  for (std::size_t i = 0; i <= fan.triangles(); ++i) {
    if (filter.counts(i)) {
      const EdgeEnd end = end_of((fan.j + 1 + i) % star.degree());
      if (meets(united(box_of(w.position), end.position), within)) {
        worst = std::max(worst, gap(w, end));
      }
    }
  }
  return worst;
}

}  // namespace

double fan_deviation(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                     const FullSurface& full, const GridBox& within) {
  return largest_over_spokes(tile, s, fan, within, [&](const EdgeEnd& a, const EdgeEnd& b) {
    return full.largest_gap(a, b);
  });
}

double fan_fixed_gap(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                     const FixedQuestion& question) {
  if (!question.full.has_fixed_edges()) {
    return 0.0;
  }
  double worst = 0.0;
  return largest_over_spokes(
      tile, s, fan, question.within, [&](const EdgeEnd& a, const EdgeEnd& b) {
        if (worst <= question.stop_above) {
          worst = std::max(worst, question.full.fixed_gap(a, b, question.stop_above));
        }
        return worst;
      });
}

}  // namespace ptin
