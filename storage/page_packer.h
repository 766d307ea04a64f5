// SPDX-License-Identifier: GPL-3.0-or-later
//
// Packs records and their stars into the bytes of a page (storage/FORMAT.md, "Pages").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/descriptor.h"
#include "storage/page_columns.h"
#include "storage/ring_check.h"
#include "storage/star.h"

namespace ptin {

/// Takes records as long as a page holds them. The bytes of a page depend on its records, their
/// order and the size of the page alone.
class PagePacker {
 public:
  enum class Packing : std::uint8_t {
    kNew,    ///< add() looks at what it REQUIRES, and ends a local page before it grows by much.
    kAgain,  ///< The records of a page that a reader has accepted.
  };
  PagePacker(std::uint32_t page_bytes, const HeightEncoding& heights, const PageForm& form,
             Packing packing = Packing::kNew);

  /// Adds a record, unless the page would not hold it: then nothing changes, and the answer is
  /// false. An empty page holds any record.
  /// REQUIRES: `ring` is as storage/star.h says (is_star(), and w, vl, vr and the two classes agree
  /// with it), with 3 to layout::kMostDegree corners; the roi lies on the grid and holds u, the
  /// interval of heights holds u's; errors, deviations and deaths are short numbers
  /// (storage/short_float.h).
  /// @throws Error internal  the record is not so
  [[nodiscard]] bool add(const VertexSplit& r, std::span<const RingCorner> ring);
  [[nodiscard]] bool empty() const noexcept { return items_.empty(); }

  /// Ends the page. The bytes are valid until the next call.
  /// REQUIRES: not empty.
  /// @param entry  Receives the descriptor.
  [[nodiscard]] std::span<const std::byte> finish(layout::NodeEntry& entry);

 private:
  using Numbers = std::array<std::uint32_t, kPageColumns>;
  struct Item {
    Numbers numbers;  ///< For each column.
    std::size_t first_corner;
  };
  /// The short numbers of a page that have a base, and whether others are there.
  struct ShortRange {
    ShortBits least = kShortInfinity, most = 0;
    bool has_infinity = false;
    void add(ShortBits bits) noexcept;
    [[nodiscard]] ShortBits base() const noexcept { return most == 0 ? ShortBits{0} : least; }
    [[nodiscard]] std::uint32_t most_stored() const noexcept;
  };
  /// What a page takes: extremes of its columns, and sums over its rings.
  struct Frame {
    Numbers least, most;
    ShortRange error, deviation;
    bool has_void = false, has_no_height = false;
    std::size_t own_bits = 0;     ///< Bits of all corners: offsets and deaths.
    std::size_t height_bits = 0;  ///< And heights.
    std::size_t corners = 0;
    GridBox vertices;
    bool is_local = false;
  };
  /// A page as its header says, and what it takes.
  struct Plan {
    layout::PageHeader header{};
    std::size_t place_bits = 0;  ///< Of errors that descend.
    std::size_t bytes = 0;       ///< At most.
  };

  [[nodiscard]] Item item_of(const VertexSplit& r, std::span<const RingCorner> ring);
  [[nodiscard]] VertexSplit as_kept(const VertexSplit& r, const Item& item) const;
  void widen(Frame& frame, const Item& item) const;
  [[nodiscard]] Frame empty_frame() const;
  [[nodiscard]] layout::PageHeader header_of(const Frame& frame, std::size_t records) const;
  void put_errors(const Frame& frame, Plan& plan) const;
  [[nodiscard]] Plan plan_of(const Frame& frame, std::size_t records) const;
  [[nodiscard]] bool fits(const Frame& frame, std::size_t records) const;
  [[nodiscard]] bool may_join(const Frame& wider) const;
  [[nodiscard]] std::uint32_t stored(std::size_t column, std::size_t item,
                                     const layout::PageHeader& header) const;
  [[nodiscard]] std::size_t write_columns(const layout::PageHeader& header);
  [[nodiscard]] std::size_t write_errors(const Plan& plan, std::size_t begin);
  void write_rings(layout::PageHeader& header, std::size_t runs, std::size_t rings);

  void check(const VertexSplit& r, std::span<const RingCorner> ring) const;

  std::vector<std::byte> page_;
  HeightEncoding heights_;
  PageForm form_;
  Packing packing_;
  Descriptor descriptor_;
  Frame frame_;
  std::vector<Item> items_;
  std::vector<RelativeCorner> corners_;
};

}  // namespace ptin
