// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/packed_segment.h"

#include <algorithm>

#include "engine/check.h"
#include "storage/error_table.h"
#include "storage/page_packer.h"
#include "storage/record_order.h"

namespace ptin {

PackedSegment pack_segment(const StarredRecords& records, const HeightEncoding& heights,
                           const PageForm& form, std::uint32_t page_bytes) {
  PackedSegment packed;
  PagePacker page(page_bytes, heights, form);
  ErrorTable errors;
  const auto finish = [&] {
    layout::NodeEntry descriptor;
    const std::span<const std::byte> bytes = page.finish(descriptor);
    packed.pages.insert(packed.pages.end(), bytes.begin(), bytes.end());
    packed.descriptors.push_back(descriptor);
  };
  for (const std::uint32_t i : order_of_segment(records)) {
    if (!page.add(records.splits[i], records.ring(i))) {
      finish();
      PTIN_CHECK(page.add(records.splits[i], records.ring(i)));
    }
    errors.add(records.splits[i]);
    packed.max_rank = std::max(packed.max_rank, records.splits[i].rank);
  }
  // A page of two segments would have the box of both, so a segment ends its last page.
  if (!page.empty()) {
    finish();
  }
  packed.errors = errors.bins();
  return packed;
}

}  // namespace ptin
