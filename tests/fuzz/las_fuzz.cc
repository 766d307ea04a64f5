// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes of any kind are read as LAS, or refused with an Error that is no fault of ours.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <cpl_vsi.h>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/las_reader.h"
#include "engine/error.h"
#include "tests/fuzz/fuzz_target.h"

PTIN_FUZZ_TARGET(las, data, size) {
  std::vector<GByte> bytes(data, data + size);
  VSIFCloseL(VSIFileFromMemBuffer("/vsimem/fuzz.las", bytes.data(), bytes.size(), FALSE));
  try {
    ptin::LasReader reader("/vsimem/fuzz.las", {});
    std::vector<ptin::SourcePoint> batch;
    std::uint64_t points = reader.left_out().total();
    while (reader.next(batch)) {
      points += batch.size();
    }
    if (points + reader.left_out().total() != reader.header().points) {
      std::abort();
    }
  } catch (const ptin::Error& e) {
    if (e.code() != ptin::ErrorCode::invalid_argument &&
        e.code() != ptin::ErrorCode::unsupported_version) {
      std::abort();
    }
  }
  VSIUnlink("/vsimem/fuzz.las");
  return 0;
}
