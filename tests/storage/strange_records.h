// SPDX-License-Identifier: GPL-3.0-or-later
//
// Single pages in memory, and records at the ends of what one can hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <string>
#include <vector>

#include "storage/layout.h"
#include "storage/short_float.h"
#include "storage/star.h"
#include "tests/support/widest_entry.h"

namespace ptin::test {

/// A finished page.
struct PackedPage {
  std::vector<std::byte> bytes;
  layout::NodeEntry entry;
  std::size_t records;
};

/// The name under which pages in memory are complained of.
inline const std::string kPageName = "page test";

/// One page of the first records; of all of them when they fit.
[[nodiscard]] PackedPage packed_page(const StarredRecords& records, const HeightEncoding& heights,
                                     std::uint32_t page_bytes = 4096);
[[nodiscard]] StarredRecords decoded_page(const PackedPage& page, const HeightEncoding& heights);

/// Records at the ends of what a page can hold, by chance.
class StrangeRecords {
 public:
  StrangeRecords(std::uint64_t seed, HeightType type);
  [[nodiscard]] HeightEncoding heights() const { return {type_, 1.0, 0.0}; }

  void add_to(StarredRecords& records);

 private:
  bool chance(unsigned one_in) { return random_() % one_in == 0; }
  template <class T>
  T one_of(std::initializer_list<T> choices) {
    return choices.begin()[random_() % choices.size()];
  }
  std::int32_t inner() {
    return box_.min_x + 1 +
           static_cast<std::int32_t>(random_() %
                                     static_cast<unsigned>(box_.max_x - box_.min_x - 1));
  }
  float error();
  HeightBits height();
  /// Voids, and vertices without a height in the middle of them.
  void fill_classes(VertexSplit& r, std::vector<RingCorner>& ring);

  std::mt19937_64 random_;
  HeightType type_;
  GridBox box_;
  std::size_t least_degree_;
};

}  // namespace ptin::test
