// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/profile.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "engine/query/heights/stations.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/walk/spot_path.h"
#include "engine/query/walk/walk.h"

namespace ptin {

namespace {

/// The spots of a line, and the distance at which each stands.
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

double distance_between(const MapPoint& a, const MapPoint& b, const ProfileRequest& request) {
  if (request.ground_distance) {
    return request.ground_distance(a, b);
  }
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  return std::sqrt(dx * dx + dy * dy);
}

/// A line as spots, repetitions left out; fewer than two spots when the line has no length.
/// @param number, count  Which line of how many, for errors.
SpotLine spot_line(std::span<const MapPoint> line, std::size_t number, std::size_t count,
                   const StoreFacts& facts, const ProfileRequest& request) {
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
      distance = made.distances.back() + distance_between(made.positions.back(), p, request);
    }
    made.spots.push_back(*spot);
    made.positions.push_back(p);
    made.distances.push_back(distance);
  }
  return made;
}

/// Appends the points of one segment. Where a point of the same line and distance is there already,
/// it is brought up to date instead.
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
      const PointState state = piece.is_surface(tin_) ? PointState::kSurface : PointState::kVoid;
      put(piece.from.share(), ground_at(piece, piece.from), state);
      put(piece.to.share(), ground_at(piece, piece.to), state);
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
  /// `end`, which is an end of `piece`, when there is ground at it: the piece is surface, or `end`
  /// is a vertex that touches surface. Else null.
  [[nodiscard]] const Crossing* ground_at(const LinePiece& piece, const Crossing& end) const {
    const Footing& f = end.footing;
    const bool surface = piece.is_surface(tin_) ||
                         (f.lies() == Lies::kOnVertex && touches_surface(tin_, f.vertex[0]));
    return surface ? &end : nullptr;
  }

  /// `entry` when the segment only touches the domain with its end, and that end stands on surface.
  /// Else null.
  [[nodiscard]] const Crossing* touched(const Crossing& entry, std::size_t end,
                                        TriangleId near) const {
    if (entry.share() != 1.0) {
      return nullptr;  // the last piece has told the height of the end
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

/// A line on its way along the Hilbert curve.
struct OrderedLine {
  std::uint64_t along;  ///< Position of the middle of its first segment.
  std::size_t index;    ///< In the request.
};

/// The segments of a line from `first` up to, not including, `end`.
struct LinePart {
  const SpotLine* line;
  std::size_t first, end;
};

/// Walks along lines, in groups whose records fit the memory.
class Profiling {
 public:
  Profiling(const OpenedTerrain& terrain, const ProfileRequest& request)
      : terrain_(terrain),
        request_(request),
        context_(request.limits, terrain.store().path()),
        detail_(request.detail, terrain.record_source(), context_),
        refinement_(terrain.t0()) {}

  ProfileResult run(std::span<const std::span<const MapPoint>> lines) {
    const std::vector<OrderedLine> order = order_of(lines);
    begins_.resize(lines.size() + 1);
    std::vector<SpotLine> group;
    std::size_t segments = 0;
    for (const OrderedLine& next : order) {
      SpotLine line = spot_line(lines[next.index], next.index, lines.size(), facts(), request_);
      const std::size_t own = line.spots.size() - 1;
      if (!group.empty() && segments + own > kGroupSegments) {
        walk_group(group);
        group.clear();
        segments = 0;
      }
      segments += own;
      group.push_back(std::move(line));
    }
    walk_group(group);
    put_in_order(order, lines.size());
    put_stations();
    terrain_.store().pages().check_unchanged();
    result_.certified_error = detail_.certificate().error;
    result_.certified_deviation = detail_.certificate().deviation;
    result_.exact = detail_.is_exact(facts());
    result_.cost = context_.cost;
    return std::move(result_);
  }

 private:
  /// Segments refined together at most: their boxes stay in the processor's caches.
  static constexpr std::size_t kGroupSegments = 8192;
  static constexpr std::uint64_t kGroupRecords = std::uint64_t{1} << 18;

  [[nodiscard]] const StoreFacts& facts() const noexcept { return terrain_.store().facts(); }

  /// The lines that have a length; counts the others.
  std::vector<OrderedLine> order_of(std::span<const std::span<const MapPoint>> lines) {
    std::vector<OrderedLine> order;
    StationCount stations(request_.station_step);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      context_.check_stop();
      const SpotLine line = spot_line(lines[i], i, lines.size(), facts(), request_);
      if (line.spots.size() < 2) {
        ++result_.skipped_lines;
        continue;
      }
      stations.add(line.distances.back());
      const GridBox& b = facts().bounds;
      const MapPoint p = grid_of(line.spots[0]);
      const MapPoint q = grid_of(line.spots[1]);
      const double x = std::clamp<double>((p.x + q.x) / 2, b.min_x, b.max_x);
      const double y = std::clamp<double>((p.y + q.y) / 2, b.min_y, b.max_y);
      order.push_back(
          {hilbert_position(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)), i});
    }
    if (!lines.empty() && order.empty()) {
      throw Error(ErrorCode::invalid_argument, no_length(lines.size()));
    }
    station_bytes_ = stations.bytes_within(request_.limits.memory_bytes);
    std::sort(order.begin(), order.end(), [](const OrderedLine& a, const OrderedLine& b) {
      return a.along != b.along ? a.along < b.along : a.index < b.index;
    });
    return order;
  }

  void walk_group(std::span<const SpotLine> lines) {
    std::vector<LinePart> parts;
    for (const SpotLine& line : lines) {
      parts.push_back({&line, 0, line.spots.size() - 1});
    }
    if (!parts.empty()) {
      walk(parts);
    }
  }

  /// Walks along parts of lines. Parts that do not fit the memory together are halved; a single one
  /// is halved by its segments.
  void walk(std::span<const LinePart> parts) {
    std::vector<SpotSegment> segments;
    for (const LinePart& part : parts) {
      for (std::size_t i = part.first; i < part.end; ++i) {
        segments.push_back({part.line->spots[i], part.line->spots[i + 1]});
      }
    }
    const SpotPath path(std::move(segments), detail_.tolerance());
    std::vector<PageId> pages;
    terrain_.index().search(path, pages, context_.cost.io);
    context_.check_stop();
    const std::uint64_t records = most_records(terrain_.store(), pages);
    const std::uint64_t bytes = bytes_of(terrain_.t0()) + refinement_bytes(records) + held();
    const bool fits = bytes <= request_.limits.memory_bytes && records <= kGroupRecords;
    if (!fits && may_halve(parts, bytes)) {
      walk_halves(parts);
      return;
    }
    context_.admit(bytes);
    refine(path, pages);
    if (!write(parts)) {
      walk_halves(parts);
    }
  }

  /// A single line is halved for its memory alone, and a segment never.
  [[nodiscard]] bool may_halve(std::span<const LinePart> parts, std::uint64_t bytes) const {
    return parts.size() > 1 ||
           (parts.front().end - parts.front().first > 1 && bytes > request_.limits.memory_bytes);
  }

  void walk_halves(std::span<const LinePart> parts) {
    if (parts.size() > 1) {
      walk(parts.first(parts.size() / 2));
      walk(parts.subspan(parts.size() / 2));
      return;
    }
    const auto& [line, first, end] = parts.front();
    const std::size_t middle = first + (end - first) / 2;
    const LinePart halves[] = {{line, first, middle}, {line, middle, end}};
    walk({&halves[0], 1});
    walk({&halves[1], 1});
  }

  void refine(const SpotPath& path, std::span<const PageId> pages) {
    std::vector<PendingSplit> splits;
    read_pages(terrain_.store(), pages, path, context_, splits);
    detail_.keep(splits);
    refinement_.restart(terrain_.t0());
    refinement_.apply(splits, context_);
  }

  /// Writes the points of the parts. Returns false, and has written nothing, when mesh and points
  /// do not fit together but halves may.
  [[nodiscard]] bool write(std::span<const LinePart> parts) {
    const std::size_t before = result_.points.size();
    TriangleId near = 0;
    for (const LinePart& part : parts) {
      if (part.first == 0) {
        begins_[part.line->number] = result_.points.size();
      }
      SegmentWriter writer(refinement_.tin(), facts(), *part.line, result_.points);
      for (std::size_t i = part.first; i < part.end; ++i) {
        context_.check_stop();
        make_room();
        near = writer.write(static_cast<std::uint32_t>(i), near);
        const std::uint64_t bytes = bytes_of(refinement_.tin()) + held();
        if (bytes > request_.limits.memory_bytes && may_halve(parts, bytes)) {
          result_.points.resize(before);
          return false;
        }
        context_.admit(bytes);
      }
    }
    return true;
  }

  /// Grows the room for points by a quarter: doubling would take memory for points that never come.
  void make_room() {
    std::vector<ProfilePoint>& points = result_.points;
    if (points.capacity() - points.size() < points.size() / 8) {
      points.reserve(points.size() + points.size() / 4);
    }
  }

  /// Puts the points of the lines from the order along the curve into that of the request.
  void put_in_order(std::span<const OrderedLine> order, std::size_t lines) {
    if (std::is_sorted(order.begin(), order.end(),
                       [](const auto& a, const auto& b) { return a.index < b.index; })) {
      return;
    }
    context_.admit(held() + result_.points.size() * sizeof(ProfilePoint));
    std::vector<std::size_t> ends(lines);
    for (std::size_t i = 0; i < order.size(); ++i) {
      ends[order[i].index] =
          i + 1 < order.size() ? begins_[order[i + 1].index] : result_.points.size();
    }
    std::vector<ProfilePoint> points;
    points.reserve(result_.points.size());
    for (std::size_t line = 0; line < lines; ++line) {
      if (ends[line] > 0) {  // a line that is not skipped has points
        points.insert(points.end(),
                      result_.points.begin() + static_cast<std::ptrdiff_t>(begins_[line]),
                      result_.points.begin() + static_cast<std::ptrdiff_t>(ends[line]));
      }
    }
    result_.points = std::move(points);
  }

  void put_stations() {
    if (request_.station_step == 0) return;
    context_.admit(held() + held() + station_bytes_);
    result_.points = with_stations(result_.points, request_.station_step);
  }

  [[nodiscard]] std::uint64_t held() const noexcept {
    return result_.points.capacity() * sizeof(ProfilePoint);
  }

  const OpenedTerrain& terrain_;
  const ProfileRequest& request_;
  QueryContext context_;
  Detail detail_;
  Refinement refinement_;  ///< Of the group at hand.
  std::vector<std::size_t>
      begins_;  ///< First point of each line of the request, once it is walked.
  std::uint64_t station_bytes_ = 0;  ///< What the points of all stations take.
  ProfileResult result_;
};

ProfileResult profile_of(const OpenedTerrain& terrain,
                         std::span<const std::span<const MapPoint>> lines,
                         const ProfileRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  ProfileResult result = Profiling(terrain, request).run(lines);
  result.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace

ProfileResult profile(const OpenedTerrain& terrain, std::span<const MapPoint> line,
                      const ProfileRequest& request) {
  return profile_of(terrain, std::span(&line, 1), request);
}

ProfileResult profile(const OpenedTerrain& terrain, std::span<const std::vector<MapPoint>> lines,
                      const ProfileRequest& request) {
  const std::vector<std::span<const MapPoint>> all(lines.begin(), lines.end());
  return profile_of(terrain, all, request);
}

}  // namespace ptin
