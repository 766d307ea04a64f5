// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "engine/geometry/infinity.h"
#include "engine/query/heights/ground_stretches.h"
#include "engine/query/heights/profile_points.h"
#include "engine/query/heights/stations.h"
#include "engine/query/living/living_place.h"
#include "engine/query/select/detail.h"
#include "engine/query/shape/tiler.h"
#include "engine/query/walk/spot_path.h"

namespace ptin {

namespace {

std::string no_length(std::size_t count) {
  std::string text = "the line has no length";
  if (count > 1) {
    text = "none of the ";
    text.append(std::to_string(count)).append(" lines has a length");
  }
  return text.append(": expected at least two different points");
}

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

/// Whether parts can be divided: a segment cannot.
bool may_divide(std::span<const LinePart> parts) {
  return parts.size() > 1 || parts.front().end - parts.front().first > 1;
}

/// The halves of parts of lines; those of a single one by its segments. REQUIRES: may_divide()
std::array<std::vector<LinePart>, 2> divided(const std::vector<LinePart>& parts) {
  if (parts.size() > 1) {
    const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
    return {std::vector(parts.begin(), middle), std::vector(middle, parts.end())};
  }
  const auto& [line, first, end] = parts.front();
  const std::size_t middle = first + (end - first) / 2;
  return {std::vector{LinePart{line, first, middle}}, std::vector{LinePart{line, middle, end}}};
}

/// Walks along lines, in groups whose stretches fit the memory.
class Profiling {
 public:
  Profiling(const OpenedTerrain& terrain, const ProfileRequest& request)
      : terrain_(terrain),
        request_(request),
        context_(request.limits, terrain.store().path()),
        detail_(request.detail, terrain.record_source(), context_),
        reader_(terrain, detail_) {}

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
  /// Segments looked up together at most: their boxes stay in the processor's caches.
  static constexpr std::size_t kGroupSegments = 8192;
  static constexpr std::uint64_t kGroupBytes = std::uint64_t{64} << 20;

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
      refuse(no_length(lines.size()));
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
    if (parts.empty()) return;
    work_in_parts(parts, [&](const std::vector<LinePart>& some) { return walk(some); });
  }

  /// Walks along parts of lines, unless they do not fit the memory together and can be divided.
  [[nodiscard]] bool walk(std::span<const LinePart> parts) {
    std::vector<SpotSegment> segments;
    for (const LinePart& part : parts) {
      for (std::size_t i = part.first; i < part.end; ++i) {
        segments.push_back({part.line->spots[i], part.line->spots[i + 1]});
      }
    }
    const SpotPath path(std::move(segments));
    LivingPlace place;
    place.box = path.bounds();
    place.stars = &path;
    place.asks_each_star = true;
    const std::uint64_t left = context_.left_beside(held());
    GroundStretches stretches(path, facts().heights,
                              may_divide(parts) ? std::min(left, kGroupBytes) : left);
    const bool fits = reader_.read(place, context_, stretches);
    stretches.sort();
    if (fits && write(parts, stretches)) return true;
    if (!may_divide(parts)) context_.admit(held() + stretches.bytes());
    return false;
  }

  /// Writes the points of the parts. Returns false, and has written nothing, when stretches and
  /// points do not fit together but halves may.
  [[nodiscard]] bool write(std::span<const LinePart> parts, const GroundStretches& stretches) {
    const std::size_t before = result_.points.size();
    std::size_t segment = 0;
    for (const LinePart& part : parts) {
      if (part.first == 0) {
        begins_[part.line->number] = result_.points.size();
      }
      SegmentWriter writer(facts(), *part.line, result_.points);
      for (std::size_t i = part.first; i < part.end; ++i) {
        context_.check_stop();
        make_room();
        writer.write(static_cast<std::uint32_t>(i), stretches.of(segment++));
        const std::uint64_t bytes = stretches.bytes() + held();
        if (bytes > request_.limits.memory_bytes && may_divide(parts)) {
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
  LivingReader reader_;
  std::vector<std::size_t>
      begins_;  ///< First point of each line of the request, once it is walked.
  std::uint64_t station_bytes_ = 0;  ///< What the points of all stations take.
  ProfileResult result_;
};

ProfileResult profile_of(const OpenedTerrain& terrain,
                         std::span<const std::span<const MapPoint>> lines,
                         const ProfileRequest& request) {
  return timed([&] { return Profiling(terrain, request).run(lines); });
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
