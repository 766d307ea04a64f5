// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/record_order.h"

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include "engine/geometry/hilbert.h"
#include "storage/layout.h"

namespace ptin {

namespace {

struct Place {
  std::uint32_t group;  // ascending: coarse first, wide before narrow
  std::uint64_t curve;
  VertexKey key;
  std::size_t record;

  friend bool operator<(const Place& a, const Place& b) {
    return std::tie(a.group, a.curve, a.key, a.record) <
           std::tie(b.group, b.curve, b.key, b.record);
  }
};

Place place_of(const VertexSplit& r, std::size_t index) {
  const std::uint32_t octave = layout::to_bits(r.error) >> 23;  // 255 for +infinity, 0 for 0
  const std::uint32_t narrow = kind_of(r) == RecordKind::kNarrow ? 1 : 0;
  // Twice the centre, which is a whole number.
  const std::uint32_t x =
      static_cast<std::uint32_t>(r.roi.min_x) + static_cast<std::uint32_t>(r.roi.max_x);
  const std::uint32_t y =
      static_cast<std::uint32_t>(r.roi.min_y) + static_cast<std::uint32_t>(r.roi.max_y);
  return {(255U - octave) * 2 + narrow, hilbert_position(x, y), key_of(r.u), index};
}

}  // namespace

void order_segment(std::span<VertexSplit> records) {
  std::vector<Place> places;
  places.reserve(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    places.push_back(place_of(records[i], i));
  }
  std::sort(places.begin(), places.end());
  std::vector<VertexSplit> ordered;
  ordered.reserve(records.size());
  for (const Place& p : places) {
    ordered.push_back(records[p.record]);
  }
  std::copy(ordered.begin(), ordered.end(), records.begin());
}

}  // namespace ptin
