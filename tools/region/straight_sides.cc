// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/straight_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <ogr_spatialref.h>

#include "engine/error.h"
#include "tools/formats/number_text.h"

namespace ptin::tools {

namespace {

constexpr double kHalfTurn = 180, kTurn = 360;  // degrees
/// Places at which a piece of a side is looked at, at equal distances between its ends.
constexpr std::size_t kLooks = 3;
/// A piece is this share of its side at least: what is bent or broken in a smaller one is a break.
constexpr double kSmallestPiece = 1.0 / (1 << 26);
/// A break as long as this share of its side is drawn straight: operations between CRSs may change
/// by a few metres where the area of one ends.
constexpr double kSmallBreak = 1e-3;
/// Sides longer than so many bends are looked at in quarters at least.
constexpr double kLongInBends = 1e4;

/// The multiple of a turn that brings an x nearest to another one.
double turns_towards(double x, double other, double turn = kTurn) {
  return turn * std::round((other - x) / turn);
}

double distance(MapPoint a, MapPoint b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// The distance from p to the segment from a to b.
double distance_to_segment(MapPoint p, MapPoint a, MapPoint b) {
  const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
  if (square == 0) return distance(p, a);
  const double t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0);
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

bool comes_first(MapPoint a, MapPoint b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }

std::string text_of(MapPoint p) {
  std::string text;
  append_number(text, p.x);
  append_number(text += ' ', p.y);
  return text;
}

bool is_nowhere(MapPoint p) { return !std::isfinite(p.x) || !std::isfinite(p.y); }

/// A part of a side, between two places that are known in the other CRS.
struct Piece {
  std::size_t side;
  double from, to;  ///< Shares of the side, from the end that comes first.
  MapPoint a, b;    ///< Its ends in the other CRS.
};

/// A place that is added to a side.
struct Added {
  std::size_t side;
  double at;  ///< The share of the side.
  MapPoint place;
};

class Bender {
 public:
  Bender(std::span<const MapPoint> path, const PlaceTransform& transform, const SideTarget& target)
      : path_(path), transform_(transform), target_(target), corners_(path.begin(), path.end()) {
    transform_(corners_);
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (is_nowhere(corners_[i])) refuse_place(path[i]);
    }
  }

  /// Adds places to the sides until none is bent more than the target allows.
  void bend() {
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i + 1 < path_.size(); ++i) {
      const auto [low, high] = ends_of(i);
      pieces.push_back({i, 0.0, 1.0, corners_[low], corners_[high]});
    }
    while (!pieces.empty()) pieces = halved(pieces);
  }

  [[nodiscard]] std::vector<MapPoint> joined() {
    std::sort(added_.begin(), added_.end(), [&](const Added& a, const Added& b) {
      if (a.side != b.side) return a.side < b.side;
      return is_turned_over(a.side) ? a.at > b.at : a.at < b.at;
    });
    std::vector<MapPoint> points;
    points.reserve(corners_.size() + added_.size());
    auto next = added_.begin();
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      points.push_back(corners_[i]);
      for (; next != added_.end() && next->side == i; ++next) points.push_back(next->place);
    }
    return points;
  }

 private:
  [[noreturn]] static void refuse_place(MapPoint p) {
    throw Error(ErrorCode::invalid_argument,
                "the place " + text_of(p) + " is nowhere in the terrain's CRS");
  }

  [[nodiscard]] bool is_turned_over(std::size_t side) const {
    return comes_first(path_[side + 1], path_[side]);
  }
  /// The numbers of the side's corners, first the one that comes first.
  [[nodiscard]] std::pair<std::size_t, std::size_t> ends_of(std::size_t side) const {
    return is_turned_over(side) ? std::pair{side + 1, side} : std::pair{side, side + 1};
  }
  /// A place of the side, in the CRS that it is straight in.
  [[nodiscard]] MapPoint straight(std::size_t side, double at) const {
    const auto [low, high] = ends_of(side);
    return {std::lerp(path_[low].x, path_[high].x, at), std::lerp(path_[low].y, path_[high].y, at)};
  }

  /// Whether a piece is drawn as its chord.
  [[nodiscard]] bool is_straight(const Piece& piece, std::span<const MapPoint> looks) const {
    std::array<MapPoint, kLooks + 2> way{piece.a};
    std::copy(looks.begin(), looks.end(), way.begin() + 1);
    way.back() = piece.b;
    double bend = 0.0, length = 0.0, longest = 0.0;
    for (std::size_t i = 1; i < way.size(); ++i) {
      if (target_.turn > 0) way[i].x += turns_towards(way[i].x, way[i - 1].x, target_.turn);
      const double step = distance(way[i - 1], way[i]);
      length += step;
      longest = std::max(longest, step);
    }
    for (std::size_t i = 1; i + 1 < way.size(); ++i) {
      bend = std::max(bend, distance_to_segment(way[i], way.front(), way.back()));
    }
    if (length <= target_.most_bend) return true;
    const double share = piece.to - piece.from;
    if (share <= kSmallestPiece) {
      const auto [low, high] = ends_of(piece.side);
      if (length <=
          std::max(kSmallBreak * distance(corners_[low], corners_[high]), target_.most_bend)) {
        return true;
      }
      throw Error(ErrorCode::invalid_argument, "the side from " + text_of(path_[piece.side]) +
                                                   " to " + text_of(path_[piece.side + 1]) +
                                                   " breaks in the terrain's CRS, at " +
                                                   text_of(straight(piece.side, piece.from)));
    }
    if (share > 0.25 && length > kLongInBends * target_.most_bend) return false;
    // A fifth is left for what lies between the looks; a piece whose parts differ much in length
    // hides a break, or is bent where nobody looked.
    return bend <= 0.8 * target_.most_bend && longest <= 0.5 * length;
  }

  /// The halves of those pieces that are not straight.
  [[nodiscard]] std::vector<Piece> halved(const std::vector<Piece>& pieces) {
    std::vector<MapPoint> looks;
    looks.reserve(pieces.size() * kLooks);
    const auto share = [](const Piece& p, std::size_t look) {
      return p.from + (p.to - p.from) * static_cast<double>(look + 1) / (kLooks + 1);
    };
    for (const Piece& p : pieces) {
      for (std::size_t i = 0; i < kLooks; ++i) looks.push_back(straight(p.side, share(p, i)));
    }
    transform_(looks);
    std::vector<Piece> halves;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const Piece& p = pieces[k];
      const std::span<const MapPoint> here = std::span(looks).subspan(k * kLooks, kLooks);
      for (std::size_t i = 0; i < kLooks; ++i) {
        if (is_nowhere(here[i])) refuse_place(straight(p.side, share(p, i)));
      }
      if (is_straight(p, here)) continue;
      const double middle = share(p, kLooks / 2);
      const MapPoint place = here[kLooks / 2];
      added_.push_back({p.side, middle, place});
      halves.push_back({p.side, p.from, middle, p.a, place});
      halves.push_back({p.side, middle, p.to, place, p.b});
    }
    if (corners_.size() + added_.size() > target_.most_points) {
      throw Error(ErrorCode::resource_exhausted,
                  "its sides are bent in the terrain's CRS, where they take more than " +
                      std::to_string(target_.most_points) + " points");
    }
    return halves;
  }

  std::span<const MapPoint> path_;
  const PlaceTransform& transform_;
  const SideTarget& target_;
  std::vector<MapPoint> corners_;  ///< Corners in the other CRS.
  std::vector<Added> added_;
};

/// Whether longitudes lie between -180 and 180, as they do where nobody says otherwise.
bool is_plain(double from, double to) { return from >= -kHalfTurn && to <= kHalfTurn; }

/// Takes out the jumps at the antimeridian, and brings the path into the turn of the circle that the
/// bounds lie in.
void turn(std::vector<MapPoint>& points, const SideTarget& target) {
  const std::optional<Window>& bounds = target.bounds;
  double low = points.front().x, high = low;
  for (std::size_t i = 1; i < points.size(); ++i) {
    points[i].x += turns_towards(points[i].x, points[i - 1].x, target.turn);
    low = std::min(low, points[i].x);
    high = std::max(high, points[i].x);
  }
  if (!bounds) return;
  if (is_plain(low, high) && is_plain(bounds->min_x, bounds->max_x)) return;
  const double off = turns_towards((low + high) / 2, (bounds->min_x + bounds->max_x) / 2);
  for (MapPoint& p : points) p.x += off;
}

}  // namespace

PlaceTransform places_by(OGRCoordinateTransformation& way) {
  return [&way](std::span<MapPoint> places) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    constexpr std::size_t kAtOnce = 4096;
    std::vector<double> xs, ys;
    std::vector<int> succeeded;
    for (std::size_t begin = 0; begin < places.size(); begin += kAtOnce) {
      const std::span<MapPoint> some =
          places.subspan(begin, std::min(kAtOnce, places.size() - begin));
      xs.clear();
      ys.clear();
      for (const MapPoint& p : some) {
        xs.push_back(p.x);
        ys.push_back(p.y);
      }
      succeeded.assign(some.size(), 0);
      way.Transform(static_cast<int>(some.size()), xs.data(), ys.data(), nullptr, succeeded.data());
      for (std::size_t i = 0; i < some.size(); ++i) {
        some[i] = succeeded[i] != 0 ? MapPoint{xs[i], ys[i]} : MapPoint{kNone, kNone};
      }
    }
  };
}

bool has_degrees(const OGRSpatialReference& crs) {
  constexpr double kDegree = 3.14159265358979323846 / 180, kSame = 1e-12;
  return crs.IsGeographic() != 0 && std::abs(crs.GetAngularUnits() - kDegree) < kSame;
}

SideTarget side_target(const StoreFacts& facts, double turn) {
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  const double step = std::min(facts.map.step_x, facts.map.step_y);
  // Points stand much farther from each other than the steps of their grid.
  const double samples = std::max(1.0, static_cast<double>(facts.source_samples));
  const double apart =
      facts.source_samples == 0
          ? step
          : std::max(step, std::sqrt((high.x - low.x) * (high.y - low.y) / samples));
  // Transformations are no more exact than this.
  const double rounding =
      1e-10 * std::max({std::abs(low.x), std::abs(low.y), std::abs(high.x), std::abs(high.y)});
  SideTarget target;
  target.most_bend = std::max(apart / 100, rounding);
  target.turn = turn;
  if (turn > 0) target.bounds = Window{low.x, low.y, high.x, high.y};
  return target;
}

void turn_to_bounds(std::span<MapPoint> places, const SideTarget& target) {
  const std::optional<Window>& bounds = target.bounds;
  if (!bounds) return;
  const bool are_bounds_plain = is_plain(bounds->min_x, bounds->max_x);
  for (MapPoint& p : places) {
    if (are_bounds_plain && is_plain(p.x, p.x)) continue;
    p.x += turns_towards(p.x, (bounds->min_x + bounds->max_x) / 2);
  }
}

std::vector<MapPoint> transformed_sides(std::span<const MapPoint> path,
                                        const PlaceTransform& transform, const SideTarget& target) {
  if (path.empty()) return {};
  std::vector<MapPoint> shorter(path.begin(), path.end());
  for (std::size_t i = 1; i < shorter.size() && target.source_turns; ++i) {
    shorter[i].x += turns_towards(shorter[i].x, shorter[i - 1].x);
  }
  Bender bender(shorter, transform, target);
  if (std::isfinite(target.most_bend)) bender.bend();
  std::vector<MapPoint> points = bender.joined();
  if (target.turn == 0) return points;
  turn(points, target);
  const bool is_ring = path.size() > 1 && path.front() == path.back();
  if (is_ring && std::abs(points.back().x - points.front().x) > target.turn / 2) {
    throw Error(ErrorCode::invalid_argument,
                "a ring goes around a pole, where the terrain's longitudes have no inside");
  }
  if (is_ring) points.back() = points.front();
  return points;
}

}  // namespace ptin::tools
