// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/profile.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include "engine/error.h"
#include "engine/query/certificate.h"
#include "engine/query/predicate.h"
#include "engine/query/refinement.h"
#include "engine/query/retrieval.h"
#include "engine/query/sight_predicate_internal.h"
#include "engine/query/walk.h"

namespace ptin {

namespace {

constexpr double kNothingAtEnds = std::numeric_limits<double>::infinity();

/// The spots of a line, and the plane distance at which each stands.
struct SpotLine {
  std::vector<Spot> spots;
  std::vector<MapPoint> positions;
  std::vector<double> distances;
};

SpotLine spot_line(std::span<const MapPoint> line, const StoreFacts& facts) {
  const SpotMap map(facts.map, facts.bounds);
  SpotLine made;
  for (const MapPoint& p : line) {
    const std::optional<Spot> spot = map.spot(p);
    if (!spot) {
      throw Error(ErrorCode::invalid_argument,
                  "a point of the line lies too far from the terrain: give map units of its CRS");
    }
    if (!made.spots.empty() && made.spots.back() == *spot) {
      continue;
    }
    double distance = 0.0;
    if (!made.spots.empty()) {
      const double dx = p.x - made.positions.back().x;
      const double dy = p.y - made.positions.back().y;
      distance = made.distances.back() + std::sqrt(dx * dx + dy * dy);
    }
    made.spots.push_back(*spot);
    made.positions.push_back(p);
    made.distances.push_back(distance);
  }
  if (made.spots.size() < 2) {
    throw Error(ErrorCode::invalid_argument,
                "the line has no length: expected at least two different points");
  }
  return made;
}

PredicatePtr meets_line(const SpotLine& line, double tolerance) {
  std::vector<PredicatePtr> parts;
  for (std::size_t i = 0; i + 1 < line.spots.size(); ++i) {
    parts.push_back(std::make_shared<SightPredicate>(
        line.spots[i], line.spots[i + 1],
        std::vector<SightPredicate::Stretch>{
            {0.0, 1.0, -1.0, -std::numeric_limits<double>::infinity()}},
        kNothingAtEnds, tolerance));
  }
  return any_of(std::move(parts));
}

/// Appends the points of one segment. A point that is there already only learns what begins at it.
class SegmentWriter {
 public:
  SegmentWriter(const Tin& tin, const StoreFacts& facts, const SpotLine& line,
                std::vector<ProfilePoint>& points)
      : tin_(tin), facts_(facts), line_(line), points_(points) {}

  TriangleId write(std::uint32_t part, TriangleId near) {
    part_ = part;
    LineWalk walk(tin_, line_.spots[part], line_.spots[part + 1], near);
    double reached = 0.0;
    if (!walk.begins_inside()) {
      put(0.0, nullptr, PointState::kOutside);
    }
    while (walk.next()) {
      const LinePiece& piece = walk.piece();
      const bool surface = piece.is_surface(tin_);
      put(piece.from.share(), surface ? &piece.from : nullptr,
          surface ? PointState::kSurface : PointState::kVoid);
      put(piece.to.share(), surface ? &piece.to : nullptr,
          surface ? PointState::kSurface : PointState::kVoid);
      reached = piece.to.share();
      near = piece.triangle;
    }
    if (walk.ends_inside()) {  // no piece when the line only touches the domain with its end
      put(1.0, touched(walk.entry(), part + 1, near), points_.back().state);
    } else {
      put(reached, nullptr, PointState::kOutside);
      put(1.0, nullptr, PointState::kOutside);
    }
    return near;
  }

 private:
  /// `entry` when it is the line's end on a surface, else nothing.
  [[nodiscard]] const Crossing* touched(const Crossing& entry, std::size_t end,
                                        TriangleId near) const {
    if (entry.share() != 1.0) {
      return nullptr;  // the last piece has told its height
    }
    const Place place = find_spot(tin_, line_.spots[end], near);
    const TriangleId triangle = answering_triangle(tin_, place);
    const bool surface = triangle != kNone && tin_.classes[triangle] == TriangleClass::kSurface;
    return surface ? &entry : nullptr;
  }

  void put(double share, const Crossing* ground, PointState state) {
    const MapPoint& a = line_.positions[part_];
    const MapPoint& b = line_.positions[part_ + 1];
    const double from = line_.distances[part_];
    const double distance = from + share * (line_.distances[part_ + 1] - from);
    if (points_.empty() || points_.back().distance != distance) {
      ProfilePoint point;
      point.position =
          share == 1.0 ? b : MapPoint{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
      point.distance = distance;
      points_.push_back(point);
    }
    ProfilePoint& point = points_.back();
    point.state = state;
    point.part = part_;
    if (ground != nullptr) {
      point.height = facts_.heights.height_of_code(code_at(tin_, facts_.heights, ground->footing));
    }
  }

  const Tin& tin_;
  const StoreFacts& facts_;
  const SpotLine& line_;
  std::vector<ProfilePoint>& points_;
  std::uint32_t part_ = 0;
};

}  // namespace

ProfileResult profile(const ProgressiveTin& terrain, std::span<const MapPoint> line,
                      const ProfileRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  if (request.tolerance && !(*request.tolerance >= 0)) {
    throw Error(ErrorCode::invalid_argument,
                "the tolerance is negative or not a number: expected a value >= 0 in the height's "
                "unit");
  }
  const StoreFile& store = terrain.store();
  const SpotLine spots = spot_line(line, store.facts());
  const double tolerance = request.tolerance.value_or(-1.0);
  QueryContext context(request.stop, request.memory_limit_bytes, store.path());
  Refinement refinement(terrain.t0());
  refinement.apply(retrieve({store, terrain.index()}, *meets_line(spots, tolerance), 0, context),
                   context);

  ProfileResult result;
  SegmentWriter writer(refinement.tin(), store.facts(), spots, result.points);
  TriangleId near = 0;
  for (std::uint32_t i = 0; i + 1 < spots.spots.size(); ++i) {
    context.check_stop();
    near = writer.write(i, near);
  }
  store.pages().check_unchanged();
  const Certificate certificate = certify_below(store, tolerance);
  result.certified_error = certificate.error;
  result.certified_deviation = certificate.deviation;
  result.exact = certificate.complete && store.facts().base_error == 0;
  result.cost = context.cost;
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace ptin
