// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ties of a level that is a number of vertices: triangles of which their deaths do not tell.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/query/living/living_triangle.h"
#include "engine/query/select/detail.h"

namespace ptin {

/// Asks for the stars that a level of detail needs.
inline void set_level(const Detail& detail, StarFilter& filter) noexcept {
  filter.level = detail.level();
  filter.with_ties = !detail.is_by_error();
}

/// Sets triangles aside that die at the error E of the last record that a level keeps. Such a
/// triangle is gone exactly when it stands in the fan of a record of error E that the level keeps,
/// which the star of that record tells. The star's box holds the triangle, and its heights those of
/// the triangle: so a search that has read all that may hold the triangle has read the star.
/// A level of error sets nothing aside. Threads: one owner.
class LivingTies {
 public:
  /// @param detail  Borrowed.
  explicit LivingTies(const Detail& detail) : detail_(&detail) {}

  void clear() noexcept {
    undecided_.clear();
    fans_.clear();
  }
  /// Notes the fans of tied stars whose records are kept, and lets no triangle live of those whose
  /// records are not. The filter of the stars is that of set_level().
  void note_fans(LivingStars& living);
  /// True for a triangle that is set aside until settle().
  [[nodiscard]] bool set_aside(const LivingTriangle& t) {
    if (!t.is_tied || detail_->is_by_error()) {
      return false;
    }
    undecided_.push_back(t);
    return true;
  }
  [[nodiscard]] std::size_t count() const noexcept { return undecided_.size(); }
  /// Bytes that are held until settle().
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return undecided_.capacity() * sizeof(LivingTriangle) + fans_.capacity() * sizeof(Keys);
  }
  /// Calls visit(const LivingTriangle&) for each triangle set aside that lives, and forgets all.
  template <class Visit>
  void settle(const Visit& visit) {
    std::sort(fans_.begin(), fans_.end());
    for (const LivingTriangle& t : undecided_) {
      if (!std::binary_search(fans_.begin(), fans_.end(), keys_of(t))) {
        visit(t);
      }
    }
    clear();
  }
  /// Calls visit(const LivingTriangle&) for each triangle set aside, and forgets all: for a search
  /// that did not come to its end.
  template <class Visit>
  void abandon(const Visit& visit) {
    for (const LivingTriangle& t : undecided_) {
      visit(t);
    }
    clear();
  }

 private:
  using Keys = std::array<VertexKey, 3>;  ///< Ascending.
  [[nodiscard]] static Keys keys_of(const LivingTriangle& t);

  const Detail* detail_;
  std::vector<LivingTriangle> undecided_;
  std::vector<Keys> fans_;
};

}  // namespace ptin
