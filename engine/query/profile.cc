// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/profile.h"

#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/query/detail.h"
#include "engine/query/refinement.h"
#include "engine/query/retrieval.h"
#include "engine/query/spot_path.h"
#include "engine/query/walk.h"

namespace ptin {

namespace {

/// The spots of a line, and the plane distance at which each stands.
struct SpotLine {
  std::uint32_t number = 0;
  std::vector<Spot> spots;
  std::vector<MapPoint> positions;
  std::vector<double> distances;
};

/// "line 3 of 7"; where there is one only, "the line".
std::string name_of_line(std::size_t number, std::size_t count) {
  if (count == 1) return "the line";
  std::string name = "line ";
  return name.append(std::to_string(number + 1)).append(" of ").append(std::to_string(count));
}

std::string no_length(std::size_t count) {
  std::string text = "the line has no length";
  if (count > 1) {
    text = "none of the ";
    text.append(std::to_string(count)).append(" lines has a length");
  }
  return text.append(": expected at least two different points");
}

/// With fewer than two spots when the line has no length.
/// @param count  Of the lines.
SpotLine spot_line(std::span<const MapPoint> line, std::size_t number, std::size_t count,
                   const StoreFacts& facts) {
  const SpotMap map(facts.map, facts.bounds);
  SpotLine made;
  made.number = static_cast<std::uint32_t>(number);
  for (const MapPoint& p : line) {
    const std::optional<Spot> spot = map.spot(p);
    if (!spot) {
      throw Error(ErrorCode::invalid_argument,
                  "a point of " + name_of_line(number, count) +
                      " lies too far from the terrain: give map units of its CRS");
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
  return made;
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
    if (points_.empty() || points_.back().line != line_.number ||
        points_.back().distance != distance) {
      ProfilePoint point;
      point.position =
          share == 1.0 ? b : MapPoint{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
      point.distance = distance;
      points_.push_back(point);
    }
    ProfilePoint& point = points_.back();
    point.state = state;
    point.part = part_;
    point.line = line_.number;
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

/// Walks along the line, in pieces whose records fit the memory.
class Profiling {
 public:
  Profiling(const ProgressiveTin& terrain, const ProfileRequest& request)
      : terrain_(terrain),
        request_(request),
        context_(request.stop, request.memory_limit_bytes, terrain.store().path()),
        detail_({request.tolerance, request.vertices}, {terrain.store(), terrain.index()},
                context_) {}

  ProfileResult run(std::span<const std::span<const MapPoint>> lines) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const SpotLine line = spot_line(lines[i], i, lines.size(), terrain_.store().facts());
      if (line.spots.size() < 2) {
        ++result_.skipped_lines;
        continue;
      }
      walk(line, 0, line.spots.size() - 1);
    }
    if (!lines.empty() && result_.skipped_lines == lines.size()) {
      throw Error(ErrorCode::invalid_argument, no_length(lines.size()));
    }
    terrain_.store().pages().check_unchanged();
    result_.certified_error = detail_.certificate().error;
    result_.certified_deviation = detail_.certificate().deviation;
    result_.exact = detail_.is_exact(terrain_.store().facts());
    result_.cost = context_.cost;
    return std::move(result_);
  }

 private:
  /// The segments from `first` up to `end`.
  void walk(const SpotLine& line, std::size_t first, std::size_t end) {
    const StoreFile& store = terrain_.store();
    const SpotPath path(std::span(line.spots).subspan(first, end - first + 1), detail_.tolerance());
    std::vector<PageId> pages;
    terrain_.index().search(path, pages, context_.cost.io);
    context_.check_stop();
    const std::uint64_t bytes =
        bytes_of(terrain_.t0()) + refinement_bytes(most_records(store, pages)) + held();
    if (bytes > request_.memory_limit_bytes && end - first > 1) {
      const std::size_t middle = first + (end - first) / 2;
      walk(line, first, middle);
      walk(line, middle, end);
      return;
    }
    context_.admit(bytes);
    std::vector<PendingSplit> splits;
    read_pages(store, pages, path, context_, splits);
    detail_.keep(splits);
    Refinement refinement(terrain_.t0());
    refinement.apply(splits, context_);
    SegmentWriter writer(refinement.tin(), store.facts(), line, result_.points);
    TriangleId near = 0;
    for (std::size_t i = first; i < end; ++i) {
      context_.check_stop();
      near = writer.write(static_cast<std::uint32_t>(i), near);
      context_.admit(held());
    }
  }

  [[nodiscard]] std::uint64_t held() const noexcept {
    return result_.points.capacity() * sizeof(ProfilePoint);
  }

  const ProgressiveTin& terrain_;
  const ProfileRequest& request_;
  QueryContext context_;
  Detail detail_;
  ProfileResult result_;
};

ProfileResult profile_of(const ProgressiveTin& terrain,
                         std::span<const std::span<const MapPoint>> lines,
                         const ProfileRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  ProfileResult result = Profiling(terrain, request).run(lines);
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace

ProfileResult profile(const ProgressiveTin& terrain, std::span<const MapPoint> line,
                      const ProfileRequest& request) {
  return profile_of(terrain, std::span(&line, 1), request);
}

ProfileResult profile(const ProgressiveTin& terrain, std::span<const std::vector<MapPoint>> lines,
                      const ProfileRequest& request) {
  const std::vector<std::span<const MapPoint>> all(lines.begin(), lines.end());
  return profile_of(terrain, all, request);
}

}  // namespace ptin
