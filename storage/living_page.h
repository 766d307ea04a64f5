// SPDX-License-Identifier: GPL-3.0-or-later
//
// The living triangles of a page, taken out of its bytes run by run of records.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "storage/attributes.h"
#include "storage/descriptor.h"
#include "storage/layout.h"
#include "storage/living_stars.h"
#include "storage/record_page.h"

namespace ptin {

/// Takes out of a page what a filter asks for. A star's numbers are unpacked only when one of its
/// triangles lives, and a corner only when it is one of such a triangle's; both are checked, so any
/// bytes are safe. What else a whole ring must be is not looked at (is_star()).
class LivingPage {
 public:
  /// @param page        Sound. Borrowed, as the others.
  /// @param descriptor  Of the page, sound.
  LivingPage(const RecordPage& page, const layout::NodeEntry& descriptor,
             const HeightEncoding& heights, const StarFilter& filter) noexcept;

  /// Appends the triangles that live at the filter's level and whose box meets the filter's, of the
  /// stars that are asked for. Returns records(), or the first record that cannot be what was
  /// written, or that the descriptor excludes: then what was appended is not to be used.
  [[nodiscard]] std::uint32_t take(LivingStars& out) const;

 private:
  static constexpr std::uint32_t kRun = RecordPage::kRun;
  struct Shapes;
  struct Heads;
  struct Corner;
  struct Star;
  class Corners;

  void read_shapes(std::uint32_t first, std::uint32_t count, std::uint64_t wanted,
                   Shapes& out) const noexcept;
  [[nodiscard]] std::uint64_t find_living(std::uint32_t first, std::uint64_t wanted,
                                          Shapes& shapes) const noexcept;
  [[nodiscard]] bool lives(std::uint32_t death, std::uint32_t error) const noexcept;
  void read_heads(std::uint32_t first, std::uint32_t count, std::uint64_t wanted,
                  Heads& out) const noexcept;
  [[nodiscard]] bool read_star(const Heads& heads, std::uint32_t k, Star& out) const noexcept;
  [[nodiscard]] bool take_star(const Shapes& shapes, const Star& star, std::uint32_t k,
                               LivingStars& out) const;
  [[nodiscard]] bool is_plain(const Shapes& shapes, const Star& star,
                              std::uint32_t k) const noexcept;
  [[nodiscard]] bool take_plain(const Shapes& shapes, const Star& star, std::uint32_t k,
                                LivingStars& out) const;
  [[nodiscard]] bool take_any(const Shapes& shapes, const Star& star, std::uint32_t k,
                              LivingStars& out) const;
  [[nodiscard]] bool has_step(const Star& star, std::size_t begin,
                              const LivingStars& out) const noexcept;
  [[nodiscard]] bool add(const Star& star, std::size_t begin, LivingStars& out) const;

  const RecordPage& page_;
  const layout::NodeEntry& descriptor_;
  const HeightEncoding& heights_;
  const StarFilter& filter_;
  std::int32_t level_;
  bool is_within_;                                  ///< All stars lie in the filter's box.
  std::int64_t low_, high_, star_low_, star_high_;  ///< Heights of the descriptor, ordered.
  HeightInterval no_heights_;
  std::span<const std::uint64_t> steps_;  ///< Those of the filter that lie within the page.
};

}  // namespace ptin
