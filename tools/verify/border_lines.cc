// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/border_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "engine/geometry/point.h"

namespace ptin::tools {

GroundSteps ground_steps(const AffineMap& map, const Ground& ground, double grid_y) {
  if (!ground.geographic) return {map.step_x, map.step_y};
  const MapPoint unit = ground.per_map_unit({map.origin_x, map.origin_y + map.step_y * grid_y});
  return {map.step_x * unit.x * ground.metres_per_height,
          map.step_y * unit.y * ground.metres_per_height};
}

std::vector<BorderLine> border_of_mask(const SampleWindow& window) {
  const GridBox& b = window.box;
  const auto has = [&](std::int64_t x, std::int64_t y) {
    return sample_at(window, x, y).is_void ? 0 : 1;
  };
  // How many corners of a cell have heights; -1 outside of the window.
  const auto heights = [&](std::int64_t x, std::int64_t y) {
    return x < b.min_x || y < b.min_y || x >= b.max_x || y >= b.max_y
               ? -1
               : has(x, y) + has(x + 1, y) + has(x, y + 1) + has(x + 1, y + 1);
  };
  std::vector<BorderLine> lines;
  const auto add = [&](std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by) {
    lines.push_back({GridPoint{static_cast<std::int32_t>(ax), static_cast<std::int32_t>(ay)},
                     GridPoint{static_cast<std::int32_t>(bx), static_cast<std::int32_t>(by)}});
  };
  const auto differ = [](int here, int there) {
    return here >= 0 && there >= 0 && (here >= 3) != (there >= 3);
  };
  for (std::int64_t y = b.min_y; y <= b.max_y; ++y) {
    for (std::int64_t x = b.min_x; x <= b.max_x; ++x) {
      const int cell = heights(x, y);
      // A side whose two ends have heights is of the surface part of a cell that has such a part.
      if (x < b.max_x && has(x, y) == 1 && has(x + 1, y) == 1 && differ(cell, heights(x, y - 1)))
        add(x, y, x + 1, y);
      if (y < b.max_y && has(x, y) == 1 && has(x, y + 1) == 1 && differ(cell, heights(x - 1, y)))
        add(x, y, x, y + 1);
      if (cell != 3) continue;
      if (has(x, y) == 0 || has(x + 1, y + 1) == 0) {
        add(x + 1, y, x, y + 1);
      } else {
        add(x, y, x + 1, y + 1);
      }
    }
  }
  return lines;
}

std::vector<BorderLine> border_of_tin(const Tin& tin) {
  std::map<std::pair<VertexId, VertexId>, TriangleClass> first;
  std::vector<BorderLine> lines;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (std::size_t i = 0; tin.is_alive(t) && i < 3; ++i) {
      const VertexId a = tin.triangles[t].v[i];
      const VertexId b = tin.triangles[t].v[(i + 1) % 3];
      const auto [other, is_new] =
          first.emplace(std::pair(std::min(a, b), std::max(a, b)), tin.classes[t]);
      if (!is_new && other->second != tin.classes[t])
        lines.push_back({tin.position(a), tin.position(b)});
    }
  }
  return lines;
}

BorderLines::BorderLines(std::vector<BorderLine> lines, const GroundSteps& steps)
    : lines_(std::move(lines)), steps_(steps) {
  if (lines_.empty()) return;
  double high_x = -std::numeric_limits<double>::infinity();
  double high_y = high_x;
  low_x_ = low_y_ = -high_x;
  for (const BorderLine& line : lines_) {
    for (const GridPoint p : line) {
      low_x_ = std::min(low_x_, p.x * steps.x);
      low_y_ = std::min(low_y_, p.y * steps.y);
      high_x = std::max(high_x, p.x * steps.x);
      high_y = std::max(high_y, p.y * steps.y);
    }
  }
  const double longest = std::max(high_x - low_x_, high_y - low_y_);
  const double across = std::clamp(std::sqrt(static_cast<double>(lines_.size())), 1.0, 512.0);
  side_ = longest > 0.0 ? longest / across : 1.0;
  columns_ = static_cast<std::int64_t>((high_x - low_x_) / side_) + 1;
  rows_ = static_cast<std::int64_t>((high_y - low_y_) / side_) + 1;
  buckets_.resize(static_cast<std::size_t>(columns_ * rows_));
  for (std::uint32_t i = 0; i < lines_.size(); ++i) {
    const auto& [p, q] = lines_[i];
    const auto column = [&](std::int32_t x) {
      return static_cast<std::int64_t>((x * steps_.x - low_x_) / side_);
    };
    const auto row = [&](std::int32_t y) {
      return static_cast<std::int64_t>((y * steps_.y - low_y_) / side_);
    };
    for (std::int64_t r = row(std::min(p.y, q.y)); r <= row(std::max(p.y, q.y)); ++r) {
      for (std::int64_t c = column(std::min(p.x, q.x)); c <= column(std::max(p.x, q.x)); ++c)
        buckets_[static_cast<std::size_t>(r * columns_ + c)].push_back(i);
    }
  }
}

double BorderLines::distance_to(const BorderLine& line, double x, double y) const {
  const double ux = (static_cast<double>(line[1].x) - line[0].x) * steps_.x;
  const double uy = (static_cast<double>(line[1].y) - line[0].y) * steps_.y;
  const double vx = (x - line[0].x) * steps_.x;
  const double vy = (y - line[0].y) * steps_.y;
  const double t = std::clamp((ux * vx + uy * vy) / (ux * ux + uy * uy), 0.0, 1.0);
  return std::hypot(vx - t * ux, vy - t * uy);
}

double BorderLines::distance(double x, double y, double limit) const {
  double nearest = std::numeric_limits<double>::infinity();
  if (lines_.empty()) return nearest;
  const auto column = static_cast<std::int64_t>(std::floor((x * steps_.x - low_x_) / side_));
  const auto row = static_cast<std::int64_t>(std::floor((y * steps_.y - low_y_) / side_));
  const std::int64_t most = columns_ + rows_ + std::abs(column) + std::abs(row);
  // Looks around squares of growing radius, until no bucket further out can hold a nearer line.
  for (std::int64_t r = 0; r <= most; ++r) {
    if (static_cast<double>(r - 1) * side_ > std::min(limit, nearest)) break;
    const std::int64_t last = std::min(rows_ - 1, row + r);
    for (std::int64_t j = std::max<std::int64_t>(0, row - r); j <= last; ++j) {
      const bool is_whole_row = j == row - r || j == row + r;
      const std::int64_t stride = is_whole_row || r == 0 ? 1 : 2 * r;
      for (std::int64_t i = column - r; i <= column + r; i += stride) {
        if (i < 0 || i >= columns_) continue;
        for (const std::uint32_t line : buckets_[static_cast<std::size_t>(j * columns_ + i)])
          nearest = std::min(nearest, distance_to(lines_[line], x, y));
      }
    }
  }
  return nearest <= limit ? nearest : std::numeric_limits<double>::infinity();
}

void drop_lone_samples(SampleWindow& window) {
  const GridBox& b = window.box;
  const auto is_surface_cell = [&](std::int64_t x, std::int64_t y) {
    if (x < b.min_x || y < b.min_y || x >= b.max_x || y >= b.max_y) return false;
    return int{sample_at(window, x, y).is_void} + int{sample_at(window, x + 1, y).is_void} +
               int{sample_at(window, x, y + 1).is_void} +
               int{sample_at(window, x + 1, y + 1).is_void} <=
           1;
  };
  std::vector<std::size_t> lone;
  for (std::size_t i = 0; i < window.samples.size(); ++i) {
    const SourceSample& s = window.samples[i];
    if (s.is_void || is_surface_cell(s.x, s.y) || is_surface_cell(s.x - 1, s.y) ||
        is_surface_cell(s.x, s.y - 1) || is_surface_cell(s.x - 1, s.y - 1)) {
      continue;
    }
    lone.push_back(i);
  }
  for (const std::size_t i : lone) window.samples[i].is_void = window.samples[i].is_lone = true;
}

}  // namespace ptin::tools
