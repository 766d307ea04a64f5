// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part of a record that applying its split needs.
#pragma once

#include <cstdint>

#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "storage/page_store.h"
#include "storage/record.h"

namespace ptin {

/// What is kept of a record between reading and applying it: 64 bytes.
struct PendingSplit {
  VertexKey u, w, vl, vr;
  HeightBits height;
  std::uint16_t rank;
  std::uint16_t flags;  ///< VertexSplit::Flag.
  float error;
  GridBox roi;         ///< Contained in the roi of each record that it needs.
  std::uint32_t page;  ///< Index of its page, for errors and pictures; modulo 2^32.
};
static_assert(sizeof(PendingSplit) == 64);

/// The part of a record that applying needs.
[[nodiscard]] inline PendingSplit pending_of(const VertexSplit& r, PageId page) noexcept {
  return {key_of(r.u),  key_of(r.w),
          key_of(r.vl), key_of(r.vr),
          r.height,     r.rank,
          r.flags,      r.error,
          r.roi,        static_cast<std::uint32_t>(index_of(page))};
}

}  // namespace ptin
