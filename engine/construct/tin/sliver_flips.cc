// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/sliver_flips.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

class Flipper {
 public:
  Flipper(std::span<const GridPoint> positions, std::vector<Corners>& triangles,
          std::span<const std::uint8_t> is_complete)
      : positions_(positions), triangles_(triangles), is_complete_(is_complete) {
    sides_.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      add_sides(t);
    }
  }

  SliverFlips run(std::vector<std::uint32_t> open) {
    // A flip makes two triangles, which may be bad again: without a limit this might never end.
    std::uint64_t left = 64 * open.size();
    SliverFlips flips;
    while (!open.empty() && left-- > 0) {
      const std::uint32_t t = open.back();
      open.pop_back();
      if (is_gone(t) || is_good(t)) {
        continue;
      }
      ++flips.mended;
      mend(t, open);
    }
    std::erase_if(triangles_, [](const Corners& c) { return c[0] == kNone; });
    flips.beyond = std::move(beyond_);
    return flips;
  }

 private:
  static std::uint64_t side(VertexId from, VertexId to) { return (std::uint64_t{from} << 32) | to; }
  [[nodiscard]] bool is_gone(std::uint32_t t) const { return triangles_[t][0] == kNone; }
  [[nodiscard]] bool is_good(std::uint32_t t) const {
    const Corners& c = triangles_[t];
    return orient(positions_[c[0]], positions_[c[1]], positions_[c[2]]) > 0;
  }
  [[nodiscard]] std::int64_t length_squared(VertexId a, VertexId b) const {
    const std::int64_t dx = std::int64_t{positions_[a].x} - positions_[b].x;
    const std::int64_t dy = std::int64_t{positions_[a].y} - positions_[b].y;
    return dx * dx + dy * dy;
  }

  void add_sides(std::uint32_t t) {
    const Corners& c = triangles_[t];
    for (std::size_t i = 0; i < 3; ++i) {
      sides_[side(c[i], c[(i + 1) % 3])] = t;
    }
  }
  void remove(std::uint32_t t) {
    const Corners c = triangles_[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = sides_.find(side(c[i], c[(i + 1) % 3]));
      if (found != sides_.end() && found->second == t) {
        sides_.erase(found);
      }
    }
    triangles_[t] = {kNone, kNone, kNone};
  }
  void put(std::uint32_t t, const Corners& corners, std::vector<std::uint32_t>& open) {
    triangles_[t] = corners;
    add_sides(t);
    if (!is_good(t)) {
      open.push_back(t);
    }
  }

  void mend(std::uint32_t t, std::vector<std::uint32_t>& open) {
    Corners c = triangles_[t];
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) {
      remove(t);
      return;
    }
    // Turned so that the longest edge runs from a to b, opposite to the apex.
    std::array<std::int64_t, 3> lengths{};
    for (std::size_t i = 0; i < 3; ++i) {
      lengths[i] = length_squared(c[(i + 1) % 3], c[(i + 2) % 3]);
    }
    std::rotate(c.begin(),
                c.begin() + (std::max_element(lengths.begin(), lengths.end()) - lengths.begin()),
                c.end());
    const VertexId apex = c[0], a = c[1], b = c[2];
    const auto found = sides_.find(side(b, a));
    if (found == sides_.end()) {
      if (is_complete_[a] == 0 && is_complete_[b] == 0) {
        beyond_.insert(beyond_.end(), {a, b});
      }
      remove(t);
      return;
    }
    const std::uint32_t u = found->second;
    const Corners d = triangles_[u];
    const VertexId opposite =
        d[0] != a && d[0] != b ? d[0] : (d[1] != a && d[1] != b ? d[1] : d[2]);
    remove(t);
    remove(u);
    put(t, {apex, a, opposite}, open);
    put(u, {apex, opposite, b}, open);
  }

  std::span<const GridPoint> positions_;
  std::vector<Corners>& triangles_;
  std::span<const std::uint8_t> is_complete_;
  std::vector<VertexId> beyond_;
  std::unordered_map<std::uint64_t, std::uint32_t> sides_;
};

}  // namespace

SliverFlips flip_slivers(std::span<const GridPoint> positions, std::vector<Corners>& triangles,
                         std::vector<std::uint32_t> slivers,
                         std::span<const std::uint8_t> is_complete) {
  return slivers.empty() ? SliverFlips{}
                         : Flipper(positions, triangles, is_complete).run(std::move(slivers));
}

}  // namespace ptin
