// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes of any kind are read as LAZ, or refused with an Error that is no fault of ours.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <cpl_vsi.h>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/las_reader.h"
#include "engine/error.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

/// A few bytes can stand for any number of points; so many are read.
constexpr std::uint64_t kMostPoints = 20'000;

}  // namespace

PTIN_FUZZ_TARGET(laz, data, size) {
  std::vector<GByte> bytes(data, data + size);
  VSIFCloseL(VSIFileFromMemBuffer("/vsimem/fuzz.laz", bytes.data(), bytes.size(), FALSE));
  try {
    for (const ptin::PointPart& part : {ptin::PointPart{}, ptin::PointPart{7, 40}}) {
      ptin::LasReader reader("/vsimem/fuzz.laz", {}, part);
      std::vector<ptin::SourcePoint> batch;
      while (reader.done() < kMostPoints && reader.next(batch)) {
      }
      if (reader.done() < kMostPoints && reader.done() != reader.total()) {
        std::abort();
      }
    }
  } catch (const ptin::Error& e) {
    if (e.code() != ptin::ErrorCode::invalid_argument &&
        e.code() != ptin::ErrorCode::unsupported_version) {
      std::abort();
    }
  }
  VSIUnlink("/vsimem/fuzz.laz");
  return 0;
}
