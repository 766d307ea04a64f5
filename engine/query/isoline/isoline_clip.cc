// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_clip.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/query/shape/clip.h"

namespace ptin {

namespace {

/// Joins the parts of a line's segments.
class JoinedParts {
 public:
  explicit JoinedParts(std::span<const MapPoint> line) : line_(line) {}

  /// The next part of segment `i`: between points of it, in its direction.
  void add(std::size_t i, MapPoint first, MapPoint last) {
    auto& parts = clipped_.parts;
    const bool goes_on = reached_ == i && !parts.empty() && first == line_[i];
    if (!goes_on) parts.push_back({first});
    parts.back().push_back(last);
    const bool is_to_end = last == line_[i + 1];
    reached_ = is_to_end ? i + 1 : 0;
    if (is_to_end && first == line_[i]) ++whole_segments_;
  }

  ClippedParts finish() {
    auto& parts = clipped_.parts;
    clipped_.whole = whole_segments_ + 1 == line_.size();
    const bool is_ring = line_.size() > 2 && line_.front() == line_.back();
    const bool is_open = reached_ + 1 == line_.size();
    if (is_ring && is_open && !clipped_.whole && parts.size() > 1 &&
        parts.front().front() == line_.front()) {
      parts.back().insert(parts.back().end(), parts.front().begin() + 1, parts.front().end());
      parts.front() = std::move(parts.back());
      parts.pop_back();
    }
    return std::move(clipped_);
  }

 private:
  std::span<const MapPoint> line_;
  ClippedParts clipped_;
  std::size_t reached_ = 0;  ///< The point at which the last part ends; 0: at none.
  std::size_t whole_segments_ = 0;
};

bool is_inside(MapPoint p, const Window& w) noexcept {
  return w.min_x <= p.x && p.x <= w.max_x && w.min_y <= p.y && p.y <= w.max_y;
}

/// Whether a coordinate that goes from `a` to `b` comes in over a side of the window.
bool comes_in(double a, double b, double side, bool is_low_side) noexcept {
  return is_low_side ? a < side && side <= b : b <= side && side < a;
}

/// The first point of a -> b in the window. A point outside lies beyond one or two sides of the
/// window, and where the segment comes in it crosses one of these sides.
std::optional<MapPoint> entry(MapPoint a, MapPoint b, const Window& w) noexcept {
  if (is_inside(a, w)) return a;
  for (const double side : {w.min_x, w.max_x}) {
    if (!comes_in(a.x, b.x, side, side == w.min_x)) continue;
    const MapPoint p{side, meet(a.x, a.y, b.x, b.y, side)};
    if (is_inside(p, w)) return p;
  }
  for (const double side : {w.min_y, w.max_y}) {
    if (!comes_in(a.y, b.y, side, side == w.min_y)) continue;
    const MapPoint p{meet(a.y, a.x, b.y, b.x, side), side};
    if (is_inside(p, w)) return p;
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
  JoinedParts parts(line);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    if (const auto part = clip_segment(line[i], line[i + 1], window)) {
      parts.add(i, part->first, part->second);
    }
  }
  return parts.finish();
}

/// One segment beside the sides of a polygon.
class PolygonClip::OfSegment {
 public:
  OfSegment(MapPoint a, MapPoint b, const PolygonSides& sides)
      : a_(a), b_(b), all_(sides), slack_(sides.slack()) {
    const auto [min_x, max_x] = std::minmax(a.x, b.x);
    const auto [min_y, max_y] = std::minmax(a.y, b.y);
    sides.visit_near({min_x, min_y, max_x, max_y},
                     [&](const PolygonSides::Side& side) { near_.push_back(&side); });
  }
  [[nodiscard]] bool is_near_sides() const noexcept { return !near_.empty(); }

  /// Calls add(first, last) for each part in the polygon, in the direction of the segment.
  template <class Add>
  void visit_parts(const Add& add) {
    for (const PolygonSides::Side* side : near_) cut_at(*side);
    cuts_.push_back(b_);
    std::sort(cuts_.begin(), cuts_.end(),
              [&](MapPoint p, MapPoint q) { return along(p) < along(q); });
    MapPoint from = a_;
    MapPoint begun{};  // where the part at hand begins
    bool is_open = false;
    for (const MapPoint to : cuts_) {
      if (from == to) continue;
      const bool is_in = is_inside({(from.x + to.x) / 2, (from.y + to.y) / 2});
      if (is_in && !is_open) begun = from;
      if (!is_in && is_open) put(begun, from, add);
      is_open = is_in;
      from = to;
    }
    if (is_open) put(begun, b_, add);
  }

 private:
  /// A part that is as short as rounding is a touch, but for a whole segment, which joins others.
  template <class Add>
  void put(MapPoint first, MapPoint last, const Add& add) const {
    const bool is_whole = first == a_ && last == b_;
    if (is_whole || std::hypot(last.x - first.x, last.y - first.y) > slack_) add(first, last);
  }

  [[nodiscard]] double along(MapPoint p) const {
    return (p.x - a_.x) * (b_.x - a_.x) + (p.y - a_.y) * (b_.y - a_.y);
  }
  /// On which side of the line from o to d a place lies: 0 within the slack of it.
  [[nodiscard]] int side_of(MapPoint o, MapPoint d, MapPoint p) const {
    const double value = cross(o, d, p);
    if (std::abs(value) <= slack_ * std::hypot(d.x - o.x, d.y - o.y)) return 0;
    return value > 0 ? 1 : -1;
  }

  void cut_at(const PolygonSides::Side& s) {
    const int low = side_of(a_, b_, s.low), high = side_of(a_, b_, s.high);
    for (const auto& [side, end] : {std::pair{low, s.low}, std::pair{high, s.high}}) {
      if (side == 0 && along(end) > 0 && along(end) < along(b_)) cuts_.push_back(end);
    }
    if (low * high < 0 && side_of(s.low, s.high, a_) * side_of(s.low, s.high, b_) < 0) {
      cuts_.push_back(crossing(s));
    }
  }

  /// REQUIRES: the segment and the side cross within both.
  [[nodiscard]] MapPoint crossing(const PolygonSides::Side& s) const {
    if (s.low.x == s.high.x) return {s.low.x, meet(a_.x, a_.y, b_.x, b_.y, s.low.x)};
    if (s.low.y == s.high.y) return {meet(a_.y, a_.x, b_.y, b_.x, s.low.y), s.low.y};
    MapPoint a = a_, b = b_;
    if (std::tie(b.x, b.y) < std::tie(a.x, a.y)) std::swap(a, b);
    const double from = cross(s.low, s.high, a), to = cross(s.low, s.high, b);
    const double share = from / (from - to);
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
  }

  [[nodiscard]] bool is_inside(MapPoint p) const {
    const auto lies_on = [&](const PolygonSides::Side* s) {
      if (side_of(s->low, s->high, p) != 0) return false;
      const auto [min_y, max_y] = std::minmax(s->low.y, s->high.y);
      return s->low.x - slack_ <= p.x && p.x <= s->high.x + slack_ && min_y - slack_ <= p.y &&
             p.y <= max_y + slack_;
    };
    return std::any_of(near_.begin(), near_.end(), lies_on) || all_.surround(p);
  }

  MapPoint a_, b_;
  const PolygonSides& all_;
  double slack_;
  std::vector<const PolygonSides::Side*> near_;
  std::vector<MapPoint> cuts_;
};

ClippedParts PolygonClip::clip(std::span<const MapPoint> line) const {
  JoinedParts parts(line);
  // Whether the point at hand lies within stays known until a side comes near.
  bool is_in = false;
  bool is_known = false;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    OfSegment segment(line[i], line[i + 1], sides_);
    if (segment.is_near_sides()) {
      is_known = false;
      segment.visit_parts([&](MapPoint first, MapPoint last) { parts.add(i, first, last); });
      continue;
    }
    if (!is_known) is_in = sides_.surround(line[i]);
    is_known = true;
    if (is_in) parts.add(i, line[i], line[i + 1]);
  }
  return parts.finish();
}

}  // namespace ptin
