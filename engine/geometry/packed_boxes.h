// SPDX-License-Identifier: GPL-3.0-or-later
//
// Boxes in memory, found by a condition on boxes: a packed tree without pointers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/point.h"

namespace ptin {

/// A static tree over boxes, in the order in which they are given. Sixteen boxes that follow one
/// another share a node, so neighbours in that order should be neighbours in the plane.
class PackedBoxes {
 public:
  PackedBoxes() = default;
  explicit PackedBoxes(std::vector<GridBox> boxes) {
    while (boxes.size() > 1) {
      std::vector<GridBox> above((boxes.size() + kFanOut - 1) / kFanOut);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        above[i / kFanOut] = united(above[i / kFanOut], boxes[i]);
      }
      levels_.push_back(std::move(boxes));
      boxes = std::move(above);
    }
    if (!boxes.empty()) {
      levels_.push_back(std::move(boxes));
    }
  }

  [[nodiscard]] std::span<const GridBox> boxes() const noexcept {
    return levels_.empty() ? std::span<const GridBox>() : levels_.front();
  }

  /// Calls visit(number), numbers ascending, for each box for which `meets(box)` is true.
  /// REQUIRES: where `meets` is true for a box, it is true for every box that contains that box.
  template <class Meets, class Visit>
  void visit(const Meets& meets, const Visit& visit) const {
    if (!levels_.empty()) {
      descend(levels_.size() - 1, 0, meets, visit);
    }
  }

  /// As visit() above, but the boxes nearest to `from` come first, and the first visit(number) that
  /// returns false is the last.
  template <class Meets, class Visit>
  void visit_nearest(GridPoint from, const Meets& meets, const Visit& visit) const;

 private:
  static constexpr std::size_t kFanOut = 16;

  template <class Meets, class Visit>
  void descend(std::size_t level, std::size_t i, const Meets& meets, const Visit& visit) const {
    if (!meets(levels_[level][i])) {
      return;
    }
    if (level == 0) {
      visit(i);
      return;
    }
    const std::size_t end = std::min((i + 1) * kFanOut, levels_[level - 1].size());
    for (std::size_t child = i * kFanOut; child < end; ++child) {
      descend(level - 1, child, meets, visit);
    }
  }

  /// levels_[0] holds the boxes, each further level the union of every 16 boxes of the level
  /// before.
  std::vector<std::vector<GridBox>> levels_;
};

template <class Meets, class Visit>
void PackedBoxes::visit_nearest(GridPoint from, const Meets& meets, const Visit& visit) const {
  struct Entry {
    std::int64_t distance;
    std::size_t level;
    std::size_t number;
    bool operator<(const Entry& other) const noexcept {  // a queue takes the largest first
      return distance != other.distance ? distance > other.distance
             : level != other.level     ? level > other.level
                                        : number > other.number;
    }
  };
  std::priority_queue<Entry> queue;
  const auto push = [&](std::size_t level, std::size_t number) {
    const GridBox& b = levels_[level][number];
    if (meets(b)) {
      const std::int64_t dx = std::max(
          {std::int64_t{b.min_x} - from.x, std::int64_t{from.x} - b.max_x, std::int64_t{0}});
      const std::int64_t dy = std::max(
          {std::int64_t{b.min_y} - from.y, std::int64_t{from.y} - b.max_y, std::int64_t{0}});
      queue.push({dx * dx + dy * dy, level, number});
    }
  };
  if (!levels_.empty()) {
    push(levels_.size() - 1, 0);
  }
  while (!queue.empty()) {
    const Entry top = queue.top();
    queue.pop();
    if (top.level == 0) {
      if (!visit(top.number)) {
        return;
      }
      continue;
    }
    const std::size_t end = std::min((top.number + 1) * kFanOut, levels_[top.level - 1].size());
    for (std::size_t child = top.number * kFanOut; child < end; ++child) {
      push(top.level - 1, child);
    }
  }
}

}  // namespace ptin
