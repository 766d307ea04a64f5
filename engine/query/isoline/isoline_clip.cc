// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_clip.h"

#include <tuple>

namespace ptin {

namespace {

bool is_inside(MapPoint p, const Window& w) noexcept {
  return w.min_x <= p.x && p.x <= w.max_x && w.min_y <= p.y && p.y <= w.max_y;
}

/// Where a segment meets the line x == at, or y == at when coordinates are exchanged.
double meet(double au, double av, double bu, double bv, double at) noexcept {
  if (au == at) {
    return av;
  }
  if (bu == at) {
    return bv;
  }
  if (std::tie(bu, bv) < std::tie(au, av)) {
    std::swap(au, bu), std::swap(av, bv);
  }
  return av + (at - au) / (bu - au) * (bv - av);
}

/// The first point of a -> b in the window. A point outside lies beyond one or two sides of the
/// window, and where the segment comes in it crosses one of these sides.
std::optional<MapPoint> entry(MapPoint a, MapPoint b, const Window& w) noexcept {
  if (is_inside(a, w)) {
    return a;
  }
  for (const double side : {w.min_x, w.max_x}) {
    const bool crosses = side == w.min_x ? a.x < side && side <= b.x : b.x <= side && side < a.x;
    if (crosses) {
      const MapPoint p{side, meet(a.x, a.y, b.x, b.y, side)};
      if (is_inside(p, w)) {
        return p;
      }
    }
  }
  for (const double side : {w.min_y, w.max_y}) {
    const bool crosses = side == w.min_y ? a.y < side && side <= b.y : b.y <= side && side < a.y;
    if (crosses) {
      const MapPoint p{meet(a.y, a.x, b.y, b.x, side), side};
      if (is_inside(p, w)) {
        return p;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::pair<MapPoint, MapPoint>> clip_segment(MapPoint a, MapPoint b,
                                                          const Window& window) {
  const std::optional<MapPoint> first = entry(a, b, window);
  const std::optional<MapPoint> last = first ? entry(b, a, window) : std::nullopt;
  if (!first || !last || *first == *last) {
    return std::nullopt;
  }
  return std::pair{*first, *last};
}

ClippedParts clip_line(std::span<const MapPoint> line, const Window& window) {
  ClippedParts clipped;
  clipped.whole = true;
  bool open = false;  // the last part ends where the line is now
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const auto part = clip_segment(line[i], line[i + 1], window);
    if (!part) {
      open = clipped.whole = false;
      continue;
    }
    if (!open || part->first != line[i]) {
      clipped.parts.push_back({part->first});
    }
    clipped.parts.back().push_back(part->second);
    open = part->second == line[i + 1];
    clipped.whole = clipped.whole && open && part->first == line[i];
  }
  auto& parts = clipped.parts;
  const bool ring = line.size() > 2 && line.front() == line.back();
  if (ring && !clipped.whole && parts.size() > 1 && parts.front().front() == line.front() &&
      parts.back().back() == line.back() && open) {
    parts.back().insert(parts.back().end(), parts.front().begin() + 1, parts.front().end());
    parts.front() = std::move(parts.back());
    parts.pop_back();
  }
  return clipped;
}

}  // namespace ptin
