// SPDX-License-Identifier: GPL-3.0-or-later
//
// The directory: which pages have stars at a place (storage/FORMAT.md, "Directory"). Here is how the
// domain is cut into cells, and what the node of a cell holds; both writing and verifying use it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/point.h"
#include "storage/layout.h"
#include "storage/short_float.h"

namespace ptin {

/// The domain cut in two, and its parts again, down to cells, which are numbered from the lowest
/// part on. Cells [a, b) are cut into [a, m) and [m, b), m = (a + b) / 2, along line m: what lies
/// below it belongs to the first, what lies on it or above to the second. So each place belongs to
/// one cell.
class DirectoryCells {
 public:
  DirectoryCells() = default;
  /// @param lines  One a cell: the coordinate, with kLineOfEqualY or without. Number 0 is not used.
  DirectoryCells(const GridBox& bounds, std::vector<std::uint32_t> lines)
      : bounds_(bounds), lines_(std::move(lines)) {}

  [[nodiscard]] std::uint32_t count() const noexcept {
    return static_cast<std::uint32_t>(lines_.size());
  }
  [[nodiscard]] std::span<const std::uint32_t> lines() const noexcept { return lines_; }
  /// Whether line 0 is 0, and each other line meets what it cuts. Then no cell has an empty box.
  [[nodiscard]] bool is_sound() const;

  struct Cell {
    std::uint32_t number = 0;
    GridBox box;  ///< Closed: with the lines around it.
  };
  /// The cell to which the positions of [x, x + 1) x [y, y + 1) belong. REQUIRES: is_sound().
  [[nodiscard]] Cell cell_of(GridPoint p) const noexcept;
  /// Calls visit(const Cell&), by ascending number, for the cells to which a position of a closed box
  /// belongs.
  template <class Visit>
  void for_each(const GridBox& box, const Visit& visit) const {
    for_each_of({0, count(), bounds_}, box, visit);
  }

 private:
  /// Cells [begin, end), and their box.
  struct Part {
    std::uint32_t begin, end;
    GridBox box;
  };
  struct Halves {
    Part low, high;
    bool is_of_y;
    std::int32_t line;
  };
  [[nodiscard]] Halves halves_of(const Part& part) const noexcept;
  [[nodiscard]] bool is_sound(const Part& part) const;
  template <class Visit>
  void for_each_of(const Part& part, const GridBox& box, const Visit& visit) const {
    if (part.end - part.begin == 1) {
      visit(Cell{part.begin, part.box});
      return;
    }
    const Halves h = halves_of(part);
    if ((h.is_of_y ? box.min_y : box.min_x) < h.line) {
      for_each_of(h.low, box, visit);
    }
    if ((h.is_of_y ? box.max_y : box.max_x) >= h.line) {
      for_each_of(h.high, box, visit);
    }
  }

  GridBox bounds_;
  std::vector<std::uint32_t> lines_;
};

/// Cuts the bounds into cells that hold about equally many of these points.
/// REQUIRES: count > 0. The points are put in another order. Cost: O(points log count).
[[nodiscard]] DirectoryCells make_cells(const GridBox& bounds, std::uint32_t count,
                                        std::span<GridPoint> points);

/// A box within that of a cell in a byte a side, rounded outwards: the cell's width is 255. What lies
/// outside of the cell is left out.
[[nodiscard]] std::array<std::uint8_t, 4> box_in_cell(const GridBox& box,
                                                      const GridBox& cell) noexcept;
/// The box that these bytes stand for; box_in_cell() makes bytes of one that holds what it was given.
[[nodiscard]] GridBox box_of_bytes(const std::array<std::uint8_t, 4>& bytes,
                                   const GridBox& cell) noexcept;

/// Errors and deaths in a byte: 0 is error 0, and 1 to 254 are the short numbers from `least` on, a step
/// apart; 255 is infinity.
struct DirectoryScale {
  ShortBits least = 0;
  std::uint16_t step_shift = 0;

  static constexpr std::uint32_t kLastStep = 254;
  /// So that the errors from `least` to `most` have bytes. REQUIRES: least <= most.
  [[nodiscard]] static constexpr DirectoryScale of(ShortBits least, ShortBits most) noexcept {
    DirectoryScale s{least, 0};
    while (s.error_of(kLastStep) < most) {
      ++s.step_shift;
    }
    return s;
  }
  [[nodiscard]] constexpr bool is_sound() const noexcept {
    return least <= kShortInfinity && step_shift < 16;
  }
  /// The error of a byte.
  [[nodiscard]] constexpr ShortBits error_of(std::uint32_t byte) const noexcept {
    if (byte == 0 || byte > kLastStep) {
      return byte == 0 ? ShortBits{0} : kShortInfinity;
    }
    return static_cast<ShortBits>(
        std::min<std::uint32_t>(least + ((byte - 1) << step_shift), kShortInfinity));
  }
  /// The least byte whose error is not below this one.
  [[nodiscard]] constexpr std::uint8_t byte_of_error(ShortBits error) const noexcept {
    if (error == 0) {
      return 0;
    }
    const std::uint32_t above = error > least ? std::uint32_t{error} - least : 0U;
    const std::uint32_t steps = (above + (1U << step_shift) - 1) >> step_shift;
    return static_cast<std::uint8_t>(std::min(1 + steps, kLastStep + 1));
  }
  /// The death of a byte, as death_bits(): 0 for a triangle that lives on, n > 0 for one at the error
  /// of byte n - 1.
  [[nodiscard]] constexpr ShortBits death_of(std::uint32_t byte) const noexcept {
    return byte == 0 ? ShortBits{0} : static_cast<ShortBits>(error_of(byte - 1) + 1);
  }
  /// The largest byte whose death does not exceed this one, before bytes are cut to infinity.
  [[nodiscard]] constexpr std::uint8_t byte_of_death(ShortBits death) const noexcept {
    if (death == 0 || death - 1 < least || death == 1) {
      return death == 0 ? std::uint8_t{0} : std::uint8_t{1};
    }
    const std::uint32_t steps = (std::uint32_t{death} - 1 - least) >> step_shift;
    return static_cast<std::uint8_t>(2 + std::min(steps, kLastStep - 1));
  }
};

/// Calls its argument for each page, in order, with what its descriptor says.
using PageVisitor = std::function<void(std::uint64_t page, const layout::NodeEntry& descriptor)>;
using PageWalk = std::function<void(const PageVisitor&)>;

/// How many entries each cell has: the pages with a box of stars that has a place in it.
[[nodiscard]] std::vector<std::uint64_t> count_entries(const DirectoryCells& cells,
                                                       const PageWalk& walk);

/// The cells are taken in runs, so that the nodes of a run take no more memory than this.
inline constexpr std::uint64_t kDirectoryRunBytes = std::uint64_t{16} << 20;
/// Makes the nodes of all cells, some at a time, and hands each to `take`, by ascending number.
/// @param entries  count_entries().
/// Memory: kDirectoryRunBytes, or one node. Cost: a walk for each run.
void make_directory_nodes(
    const DirectoryCells& cells, std::span<const std::uint64_t> entries,
    const DirectoryScale& scale, const PageWalk& walk,
    const std::function<void(std::uint32_t cell, std::span<const std::byte> node)>& take);

/// The columns of a node.
class DirectoryNode {
 public:
  /// @param bytes  A multiple of kDirectoryEntryBytes; borrowed.
  explicit DirectoryNode(std::span<const std::byte> bytes)
      : bytes_(bytes), count_(bytes.size() / layout::kDirectoryEntryBytes) {}
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] layout::DirectoryEntry entry(std::size_t i) const noexcept;

 private:
  std::span<const std::byte> bytes_;
  std::size_t count_;
};

}  // namespace ptin
