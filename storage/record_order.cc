// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page is read for a point when its box holds the point, and for a tolerance when its largest
// error is above the tolerance. So records are cut into pages as builders of bounding volume
// hierarchies cut (surface area heuristic, in bins: Wald 2007). The cost of a cut is what its pages
// come to: the share of the area that they cover, and the octaves of error that they reach up to. A
// cut goes along one of four axes: both coordinates, size and error. Costs are integers, and the
// records that decide are drawn by a hash of their vertex: so every machine makes the same cuts.
#include "storage/record_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "storage/box_lanes.h"
#include "storage/layout.h"

namespace ptin {

namespace {

constexpr std::size_t kAxes = 4;
constexpr int kBinBits = 5;
constexpr std::size_t kBins = std::size_t{1} << kBinBits;
// Parts are cut down to so many records. A page holds several such parts, and begins with any.
constexpr std::size_t kPart = 32;
constexpr std::size_t kSample = 1024;  // About how many records decide on a cut.
constexpr std::uint32_t kOctave = 64;  // Steps of error in an octave.
// An octave of a page's largest error costs as much as this many times the area that each page has
// when all pages have the same.
constexpr std::uint64_t kPagesAnOctave = 8;

// Each part of a cut has at least one page in this many, so that a segment does not take as many
// cuts as it has pages.
constexpr std::size_t kMostUneven = 64;

using lanes::Int4;

/// What decides on the place of a record.
struct Item {
  Int4 box;  ///< The star's box as min x, min y, -max x, -max y: a union is four minima.
  VertexKey key;
  std::uint32_t error;  ///< Steps above the least that is not 0; 0 is an octave below.
  std::uint32_t record;
};

std::uint32_t hash_of(VertexKey key) {
  constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;  // 2^64 / phi, odd
  return static_cast<std::uint32_t>(((key ^ (key >> 27)) * kGoldenRatio) >> 32);
}

/// The place of a record on an axis: 0 and 1 are x and y of the middle of its box, 2 is its size, 3
/// its error. Large and coarse records have small numbers.
std::uint32_t along(const Item& item, std::size_t axis) {
  const Int4& b = item.box;
  switch (axis) {
    case 0:
      return static_cast<std::uint32_t>(b[0]) - static_cast<std::uint32_t>(b[2]);
    case 1:
      return static_cast<std::uint32_t>(b[1]) - static_cast<std::uint32_t>(b[3]);
    case 2: {
      const std::int64_t size = -(std::int64_t{b[0]} + b[1] + b[2] + b[3]) + 1;
      return layout::kInfinityBits - layout::to_bits(static_cast<float>(size));
    }
    default:
      return std::numeric_limits<std::uint32_t>::max() - item.error;
  }
}

/// The union of some records.
struct Cover {
  Int4 box{INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX};
  std::uint32_t error = 0;
  std::uint32_t records = 0;

  void add(Int4 other, std::uint32_t most_error, std::uint32_t count) {
    box = other < box ? other : box;
    error = std::max(error, most_error);
    records += count;
  }
  void add(const Cover& other) { add(other.box, other.error, other.records); }
  [[nodiscard]] std::uint64_t area() const {
    return static_cast<std::uint64_t>(1 - std::int64_t{box[0]} - box[2]) *
           static_cast<std::uint64_t>(1 - std::int64_t{box[1]} - box[3]);
  }
};

class Cutter {
 public:
  explicit Cutter(std::span<Item> items) : items_(items) {
    if (items.empty()) {
      return;
    }
    Cover all;
    for (const Item& item : items) {
      all.add(item.box, item.error, 1);
    }
    an_area_ = static_cast<double>(kUnit) / static_cast<double>(all.area());
    const std::uint64_t pages = items.size() / kPart + 1;
    error_step_ = std::max<std::uint64_t>((kUnit / pages) * kPagesAnOctave / kOctave, 1);
  }
  void run() { cut(0, items_.size()); }

 private:
  static constexpr std::uint64_t kUnit = std::uint64_t{1} << 32;  // The area of all.

  struct Choice {
    std::size_t axis = 0;
    std::uint64_t before = 0, of = 0;  // `before` of the `of` records drawn go first.
    bool is_made = false;
  };

  void cut(std::size_t begin, std::size_t end);
  [[nodiscard]] Choice choose(std::size_t begin, std::size_t end);
  void part(std::size_t begin, std::size_t middle, std::size_t end, std::size_t axis);

  /// The cost of the pages that hold the records of `c`, each of which stands for `weight` records.
  [[nodiscard]] std::uint64_t cost(const Cover& c, std::uint64_t weight) const {
    const auto area = static_cast<std::uint64_t>(static_cast<double>(c.area()) * an_area_);
    const std::uint64_t pages = (c.records * weight + kPart - 1) / kPart;
    return pages * (area + c.error * error_step_);
  }

  std::span<Item> items_;
  std::vector<Item> drawn_;
  double an_area_ = 1.0;
  std::uint64_t error_step_ = 1;
};

void Cutter::cut(std::size_t begin, std::size_t end) {
  while (end - begin > kPart) {
    const Choice choice = choose(begin, end);
    const std::size_t pages = (end - begin - 1) / kPart + 1;
    std::size_t first = pages / 2;
    if (choice.is_made) {
      const std::size_t wanted = (end - begin) * choice.before / choice.of;
      const std::size_t least = std::max<std::size_t>(pages / kMostUneven, 1);
      first = std::clamp((wanted + kPart / 2) / kPart, least, pages - least);
    }
    const std::size_t middle = begin + first * kPart;
    part(begin, middle, end, choice.axis);
    // The call is for the smaller part, so that calls nest log n deep.
    if (middle - begin <= end - middle) {
      cut(begin, middle);
      begin = middle;
    } else {
      cut(middle, end);
      end = middle;
    }
  }
  std::sort(items_.begin() + static_cast<std::ptrdiff_t>(begin),
            items_.begin() + static_cast<std::ptrdiff_t>(end), [](const Item& a, const Item& b) {
              return a.error != b.error ? a.error > b.error : a.key < b.key;
            });
}

/// The cut between two bins of an axis that costs least.
Cutter::Choice Cutter::choose(std::size_t begin, std::size_t end) {
  int shift = 32;
  while (((end - begin) >> (32 - shift)) > kSample) {
    --shift;
  }
  const std::uint64_t weight = std::uint64_t{1} << (32 - shift);
  drawn_.clear();
  std::array<std::uint32_t, kAxes> low;
  std::array<std::uint32_t, kAxes> high;
  low.fill(std::numeric_limits<std::uint32_t>::max());
  high.fill(0);
  for (const Item& item : items_.subspan(begin, end - begin)) {
    if (shift == 32 || (hash_of(item.key) >> shift) == 0) {
      drawn_.push_back(item);
      for (std::size_t axis = 0; axis < kAxes; ++axis) {
        low[axis] = std::min(low[axis], along(item, axis));
        high[axis] = std::max(high[axis], along(item, axis));
      }
    }
  }
  Choice best;
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (low[axis] >= high[axis]) {
      continue;
    }
    std::array<Cover, kBins> bins{};
    const int fine =
        std::max(static_cast<int>(std::bit_width(high[axis] - low[axis])) - kBinBits, 0);
    for (const Item& item : drawn_) {
      bins[(along(item, axis) - low[axis]) >> fine].add(item.box, item.error, 1);
    }
    std::array<Cover, kBins> behind;  // behind[i]: the records of bin i and of all bins behind it.
    Cover sum;
    for (std::size_t i = kBins; i-- > 0;) {
      sum.add(bins[i]);
      behind[i] = sum;
    }
    sum = {};
    for (std::size_t i = 1; i < kBins; ++i) {
      sum.add(bins[i - 1]);
      if (bins[i - 1].records == 0 || behind[i].records == 0) {
        continue;
      }
      const std::uint64_t both = cost(sum, weight) + cost(behind[i], weight);
      if (both < least) {
        least = both;
        best = {axis, sum.records, drawn_.size(), true};
      }
    }
  }
  return best;
}

/// Puts the `middle - begin` records with the smallest numbers on an axis first; ties by the
/// vertex.
void Cutter::part(std::size_t begin, std::size_t middle, std::size_t end, std::size_t axis) {
  const auto at = [this](std::size_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](const Item& a, const Item& b) {
    const std::uint32_t of_a = along(a, axis);
    const std::uint32_t of_b = along(b, axis);
    return of_a != of_b ? of_a < of_b : a.key < b.key;
  });
}

/// Errors as whole steps of their logarithm, which the bits of a float are nearly: 0 for error 0,
/// and from kOctave on above it.
class ErrorSteps {
 public:
  explicit ErrorSteps(std::span<const VertexSplit> records) {
    for (const VertexSplit& r : records) {
      const std::uint32_t bits = layout::to_bits(r.error);
      if (bits != 0) {
        least_ = std::min(least_, bits);
      }
    }
  }
  [[nodiscard]] std::uint32_t of(float error) const {
    constexpr std::uint32_t kShift = 23 - std::bit_width(kOctave) + 1;
    const std::uint32_t bits = layout::to_bits(error);
    return bits == 0 ? 0 : ((bits - least_) >> kShift) + kOctave;
  }

 private:
  std::uint32_t least_ = layout::kInfinityBits;
};

}  // namespace

std::vector<std::uint32_t> order_of_segment(const StarredRecords& records) {
  std::vector<Item> items;
  items.reserve(records.size());
  const ErrorSteps steps(records.splits);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const VertexSplit& r = records.splits[i];
    GridBox box = box_of(r.u);
    for (const RingCorner& c : records.ring(i)) {
      box = united(box, c.position);
    }
    items.push_back({Int4{box.min_x, box.min_y, -box.max_x, -box.max_y}, key_of(r.u),
                     steps.of(r.error), static_cast<std::uint32_t>(i)});
  }
  Cutter(items).run();
  std::vector<std::uint32_t> order;
  order.reserve(items.size());
  for (const Item& item : items) {
    order.push_back(item.record);
  }
  return order;
}

}  // namespace ptin
