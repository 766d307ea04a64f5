// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/packed_segment.h"

#include <algorithm>

#include "engine/check.h"
#include "engine/error.h"
#include "storage/error_table.h"
#include "storage/page_packer.h"
#include "storage/record_order.h"
#include "storage/record_page.h"

namespace ptin {

PackedSegment pack_segment(const StarredRecords& records, const HeightEncoding& heights,
                           std::uint32_t page_bytes) {
  PackedSegment packed;
  PagePacker page(page_bytes, heights);
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
  }
  // A page of two segments would have the box of both, so a segment ends its last page.
  if (!page.empty()) {
    finish();
  }
  return packed;
}

std::optional<PageCounts> count_pages(std::span<const std::byte> pages,
                                      std::span<const layout::NodeEntry> descriptors,
                                      const HeightEncoding& heights) {
  if (descriptors.empty() || pages.size() % descriptors.size() != 0) {
    return pages.empty() && descriptors.empty() ? std::optional<PageCounts>(PageCounts{})
                                                : std::nullopt;
  }
  const std::size_t page_bytes = pages.size() / descriptors.size();
  PageCounts counts;
  ErrorTable errors;
  VertexSplit r;
  const std::string path = "the segment";
  try {
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      const RecordPage page(path, PageId{i}, descriptors[i], heights,
                            pages.subspan(i * page_bytes, page_bytes));
      for (PageRun run(page); run.next();) {
        run.take_all();
        for (std::uint32_t k = 0; k < run.count(); ++k) {
          if (!page.head(run, k, r)) {
            return std::nullopt;
          }
          errors.add(r);
          counts.max_rank = std::max(counts.max_rank, r.rank);
        }
      }
      counts.records += page.records();
    }
  } catch (const Error&) {  // a page of which nothing can be told
    return std::nullopt;
  }
  counts.bins = errors.bins();
  return counts;
}

}  // namespace ptin
