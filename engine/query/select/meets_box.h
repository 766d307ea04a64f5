// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of work that is done box by box on the grid.
#pragma once

#include "engine/geometry/box.h"
#include "engine/query/select/predicate.h"

namespace ptin {

/// True when `roi` meets a closed box in grid units: monotone, and exact, since both are integers.
/// Threads: const functions may be called at once. Cost: four comparisons; throws nothing.
class MeetsBox final : public AttributePredicate {
 public:
  explicit MeetsBox(const GridBox& box) : box_(box) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return meets(a.roi, box_);
  }
  [[nodiscard]] GridBox reach() const noexcept override { return box_; }

 private:
  GridBox box_;
};

}  // namespace ptin
