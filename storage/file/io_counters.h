// SPDX-License-Identifier: GPL-3.0-or-later
//
// What reading costs (promise P9): plain counters, in the context of one query.
#pragma once

#include <cstdint>

namespace ptin {

struct IoCounters {
  std::uint64_t index_nodes = 0;       ///< Nodes of the index whose entries were examined.
  std::uint64_t pages = 0;             ///< Record pages read.
  std::uint64_t bytes_read = 0;        ///< Bytes of record pages and index nodes examined.
  std::uint64_t pages_verified = 0;    ///< Pages whose checksum was computed in this query.
  std::uint64_t ranges_announced = 0;  ///< Coalesced ranges given to the kernel ahead of reading.
  // Counts for a file that lies elsewhere; 0 for others.
  std::uint64_t remote_rounds = 0;    ///< Times that the question waited for the server.
  std::uint64_t remote_requests = 0;  ///< Ranges asked for.
  std::uint64_t remote_bytes = 0;     ///< That these held.
};

}  // namespace ptin
