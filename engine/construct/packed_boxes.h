// SPDX-License-Identifier: GPL-3.0-or-later
//
// Boxes in memory, found by what they meet: a packed tree without pointers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/geometry/box.h"

namespace ptin {

/// A tree over boxes in a given order; neighbours in it should be neighbours in the plane.
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

  /// Calls visit(number) in ascending order for each box that pleases `meets`, which must hold for
  /// every box around one for which it holds.
  template <class Meets, class Visit>
  void visit(const Meets& meets, const Visit& visit) const {
    if (!levels_.empty()) {
      descend(levels_.size() - 1, 0, meets, visit);
    }
  }

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

  std::vector<std::vector<GridBox>> levels_;  ///< The boxes, those of 16 of them, and so on.
};

}  // namespace ptin
