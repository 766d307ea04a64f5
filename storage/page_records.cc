// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/page_records.h"

#include <cmath>
#include <cstring>

#include "engine/error.h"

namespace ptin {

DescribedPage::DescribedPage(const std::string& path, PageId id,
                             const layout::NodeEntry& descriptor, const HeightEncoding& heights,
                             std::uint32_t page_bytes)
    : path_(path), id_(id), descriptor_(descriptor), heights_(heights), page_bytes_(page_bytes) {
  const bool known =
      (descriptor.kind_and_count & ~(layout::kWidePage | (layout::kWidePage - 1))) == 0;
  if (!known || records() == 0 || records() > page_bytes / record_bytes(kind()) ||
      !is_sound(descriptor, heights)) [[unlikely]] {
    throw Error(ErrorCode::corruption,
                "the descriptor of the page holds values that no program wrote",
                path + ", page " + std::to_string(index_of(id)));
  }
}

void DescribedPage::report(std::uint32_t record) const {
  throw Error(ErrorCode::corruption,
              "record " + std::to_string(record) +
                  " holds values that no program wrote, or that its page's descriptor excludes",
              path_ + ", page " + std::to_string(index_of(id_)));
}

bool DescribedPage::decode_one(const std::byte* in, RecordKind kind, const Interval& page_heights,
                               VertexSplit& r) const {
  if (!decode_record({in, record_bytes(kind)}, kind, r)) {
    return false;
  }
  const Interval heights{heights_.code(r.height_lo), heights_.code(r.height_hi)};
  return covers(descriptor_, page_heights, r, heights) && !std::isnan(heights.lo) &&
         !std::isnan(heights.hi) && !std::isnan(heights_.code(r.height));
}

void DescribedPage::decode(std::span<const std::byte> bytes, std::vector<VertexSplit>& out) const {
  const Interval page_heights{heights_.code(descriptor_.height_lo),
                              heights_.code(descriptor_.height_hi)};
  const RecordKind record_kind = kind();
  const std::size_t step = record_bytes(record_kind);
  const std::size_t before = out.size();
  const std::uint32_t count = records();
  out.resize(before + count);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!decode_one(bytes.data() + i * step, record_kind, page_heights, out[before + i]))
        [[unlikely]] {
      out.resize(before);
      report(i);
    }
  }
}

void DescribedPage::decode_matching(std::span<const std::byte> bytes,
                                    const AttributePredicate& predicate,
                                    std::vector<VertexSplit>& out) const {
  const Interval page_heights{heights_.code(descriptor_.height_lo),
                              heights_.code(descriptor_.height_hi)};
  const RecordKind record_kind = kind();
  const std::size_t step = record_bytes(record_kind);
  const std::size_t before = out.size();
  const std::uint32_t count = records();
  for (std::uint32_t i = 0; i < count; ++i) {
    layout::RecordHead head;
    std::memcpy(&head, bytes.data() + i * step, sizeof head);
    const Attributes attributes{{head.min_x, head.min_y, head.max_x, head.max_y},
                                {heights_.code(head.height_lo), heights_.code(head.height_hi)},
                                layout::to_float(head.error),
                                layout::to_float(head.deviation)};
    if (!predicate.holds(attributes)) {
      continue;
    }
    VertexSplit& r = out.emplace_back();
    if (!decode_one(bytes.data() + i * step, record_kind, page_heights, r)) [[unlikely]] {
      out.resize(before);
      report(i);
    }
  }
}

}  // namespace ptin
