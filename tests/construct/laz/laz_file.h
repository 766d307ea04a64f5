// SPDX-License-Identifier: GPL-3.0-or-later
//
// LAZ files made for tests: the writing half of what engine/construct/laz reads, by its own models.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ptin {

/// How a LAS file is compressed.
struct LazOptions {
  int compressor =
      2;  ///< 1: point-wise without chunks, 2: point-wise, 3: layered (formats 6 to 10).
  std::uint32_t chunk_records = 50000;
  /// Points of each chunk, where that varies; empty: it does not.
  std::vector<std::uint32_t> chunks;
  bool table_place_at_end = false;  ///< As of a writer that cannot go back.
  /// Layered: bytes of each layer that is not read. Point-wise attributes are compressed in full.
  std::size_t bytes_of_others = 0;
};

/// The same points, compressed. Layered: coordinates, numbers of returns, flags, class and channel;
/// the time counts as changed where its bytes are others than in the point before of the channel.
/// REQUIRES: `las` is a whole LAS file, and no record lies behind its points.
[[nodiscard]] std::string laz_of(const std::string& las, const LazOptions& options = {});

}  // namespace ptin
