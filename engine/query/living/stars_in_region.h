// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pages of stars that meet a region.
#pragma once

#include "engine/query/select/region.h"
#include "storage/attributes.h"

namespace ptin {

/// Asks for stars whose box meets a region, as the triangles that meet it do.
class StarsInRegion final : public StarPredicate {
 public:
  /// @param region  Borrowed. Null: nothing may be asked.
  explicit StarsInRegion(const GridRegion* region) : region_(region) {}
  [[nodiscard]] bool may_hold(const StarAttributes& a) const noexcept override {
    return region_->meets(a.box);
  }
  /// A box that meets an edge but for its widening has a part of which that is true only where the part
  /// is grown by as much.
  [[nodiscard]] GridBox reach() const noexcept override {
    return region_->widening() <= 1.0 ? region_->bounds() : StarPredicate::reach();
  }

 private:
  const GridRegion* region_;
};

}  // namespace ptin
