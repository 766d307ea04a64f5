// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/split_decoder.h"

#include <algorithm>
#include <cstddef>

#include "engine/geometry/hilbert.h"

namespace ptin {

void SplitDecoder::begin_block(const Tin& tin) {
  last_w_ = 0;
  // Vertices keep their ids, and new ones come behind: those on the curve need not be sorted again.
  const auto before = static_cast<std::ptrdiff_t>(curve_.size());
  for (auto v = static_cast<VertexId>(before); v < tin.vertices.size(); ++v) {
    const GridPoint p = tin.position(v);
    curve_.push_back(
        {hilbert_position(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y)), v});
  }
  // No two vertices share a place, so the order needs no tie rule on which both sides would agree.
  std::sort(curve_.begin() + before, curve_.end());
  std::inplace_merge(curve_.begin(), curve_.begin() + before, curve_.end());
}

const char* SplitDecoder::decode(RangeDecoder& coder, const Tin& tin, LocalSplit& split) {
  if (models_.begins_level(coder, false)) last_w_ = 0;
  // Within a level ranks of w rise, so gaps are small. A decoded gap is below 2^40, and the sum
  // does not wrap, whatever a damaged code says.
  const std::uint64_t w = last_w_ + models_.gap(coder, 0);
  if (w >= tin.vertices.size()) return "names a w that is not there";
  last_w_ = w;
  split.w = vertex_at(w);
  DecodedSymbols symbols(models_, coder);
  return code_.decode(symbols, tin, split);
}

}  // namespace ptin
