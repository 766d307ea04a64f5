// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/sample_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/geometry/morton.h"

namespace ptin {

namespace {

std::uint64_t quadtree_order(GridPoint p) noexcept {
  return morton_position(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y));
}

/// A block is charged its largest reach: members whose reaches are farther apart stay alone.
constexpr float kAlikeReaches = 1.25F;

bool is_alike(const Sample& a, const Sample& b) noexcept {
  const float larger = std::max(std::abs(a.reach), std::abs(b.reach));
  const float smaller = std::min(std::abs(a.reach), std::abs(b.reach));
  return a.side_log == b.side_log && std::signbit(a.reach) == std::signbit(b.reach) &&
         larger <= kAlikeReaches * smaller && (std::signbit(a.reach) || a.height == b.height);
}

/// True when the last four of `joined` are the four quarters of one block.
bool ends_with_siblings(const std::vector<std::pair<std::uint64_t, Sample>>& joined) noexcept {
  const std::size_t n = joined.size();
  if (n < 4) {
    return false;
  }
  const auto& [first, sample] = joined[n - 4];
  const std::uint64_t quarter = std::uint64_t{1} << (2 * sample.side_log);
  if (first % (4 * quarter) != 0) {
    return false;
  }
  for (std::size_t i = 1; i < 4; ++i) {
    const auto& [order, other] = joined[n - 4 + i];
    if (order != first + i * quarter || !is_alike(sample, other)) {
      return false;
    }
  }
  return true;
}

bool is_mostly_alike(const std::vector<Sample>& samples) noexcept {
  std::size_t alike = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    alike += samples[k].height == samples[k - 1].height ? 1 : 0;
  }
  return alike > samples.size() / 2;
}

float farther(float a, float b) noexcept { return std::abs(a) >= std::abs(b) ? a : b; }

}  // namespace

void join_into_blocks(std::vector<Sample>& samples) {
  std::vector<std::pair<std::uint64_t, Sample>> sorted;
  sorted.reserve(samples.size());
  std::vector<Sample> directed;
  for (const Sample& s : samples) {
    if (s.direction != kNoDirection) {
      directed.push_back(s);
      continue;
    }
    sorted.emplace_back(quadtree_order(s.position), s);
  }
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::pair<std::uint64_t, Sample>> joined;
  for (const auto& element : sorted) {
    joined.push_back(element);
    while (ends_with_siblings(joined)) {
      float reach = joined.back().second.reach;
      for (int i = 0; i < 3; ++i) {
        joined.pop_back();
        reach = farther(reach, joined.back().second.reach);
      }
      joined.back().second.reach = reach;
      ++joined.back().second.side_log;
    }
  }
  samples.clear();
  for (const auto& [order, sample] : joined) {
    samples.push_back(sample);
  }
  samples.insert(samples.end(), directed.begin(), directed.end());
}

void join_where_alike(std::vector<Sample>& samples, double length) {
  if (static_cast<double>(samples.size()) > 2.0 * length + 64.0 && is_mostly_alike(samples)) {
    join_into_blocks(samples);
  }
}

double straddling_residual(const StarSamples& s, const FanFrame& fan) noexcept {
  double worst = 0.0;
  for (const SampleBlock& b : s.blocks) {
    const double x0 = b.x0 - fan.w_x;
    const double x1 = b.x1 - fan.w_x;
    const double y0 = b.y0 - fan.w_y;
    const double y1 = b.y1 - fan.w_y;
    const double z = b.z - fan.w_z;
    for (std::size_t i = 1; i < fan.triangles(); ++i) {
      // Between which fractions the spoke, from w (0) to the link (1), is in the box (Liang and
      // Barsky).
      double enter = 0.0;
      double leave = 1.0;
      const auto clip = [&](double direction, double low, double high) {
        if (direction == 0.0) {
          leave = low > 0.0 || high < 0.0 ? -1.0 : leave;
          return;
        }
        const double a = low / direction;
        const double c = high / direction;
        enter = std::max(enter, std::min(a, c));
        leave = std::min(leave, std::max(a, c));
      };
      clip(fan.spoke_x[i], x0, x1);
      clip(fan.spoke_y[i], y0, y1);
      if (enter <= leave) {
        worst = std::max(
            {worst, std::abs(fan.spoke_z[i] * enter - z), std::abs(fan.spoke_z[i] * leave - z)});
      }
    }
  }
  // Fractions are off by 2^-52 at most, heights by that times the spoke's rise, which is at most 2
  // Z. A spoke that touches a corner alone may be missed by rounding: the corner is measured as a
  // sample.
  return worst == 0.0 ? 0.0 : worst + 0x1p-48 * s.largest_z;
}

std::size_t triangle_of_box(const FanFrame& fan, double x0, double y0, double x1,
                            double y1) noexcept {
  const double corner_x[4] = {x0 - fan.w_x, x1 - fan.w_x, x1 - fan.w_x, x0 - fan.w_x};
  const double corner_y[4] = {y0 - fan.w_y, y0 - fan.w_y, y1 - fan.w_y, y1 - fan.w_y};
  const auto side = [&](std::size_t spoke, int c) {
    return cross_exact(fan.spoke_x[spoke], fan.spoke_y[spoke], corner_x[c], corner_y[c]);
  };
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    bool inside = true;
    for (int c = 0; c < 4 && inside; ++c) {
      inside = side(i, c) >= 0 && side(i + 1, c) <= 0;
    }
    if (inside) {
      return i;
    }
  }
  return fan.triangles();
}

}  // namespace ptin
