// SPDX-License-Identifier: GPL-3.0-or-later
//
// Looks at every byte of a store: all checksums, and all structural rules of FORMAT.md.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace ptin {

struct VerifyOptions {
  /// For the comparison of vertex keys; some MiB more are used for reading.
  std::uint64_t memory_bytes = std::uint64_t{256} << 20;
  /// Looking ends when so many faults are found.
  std::size_t max_faults = 100;
};

struct VerifyFault {
  std::string what;   ///< A sentence: what is wrong, what was expected.
  std::string where;  ///< "header", "page 17", "index level 0, node 3", "section \"metadata\"".
};

struct VerifyReport {
  std::vector<VerifyFault> faults;
  bool stopped_early = false;  ///< max_faults was reached.
  std::uint64_t pages = 0;     ///< Looked at.
  std::uint64_t records = 0;
  std::uint64_t index_nodes = 0;
  std::uint64_t key_passes = 1;  ///< How often the pages were read to compare vertex keys.

  [[nodiscard]] bool is_sound() const noexcept { return faults.empty(); }
};

/// Pages looked at, and how many there are to look at (over all passes).
using VerifyProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Verifies a store. Compares: all checksums; gaps and unused places with zero; the metadata with
/// the grammar of JSON; T0 with a triangulation of a convex domain (positive orientation, each edge
/// once in each direction, one convex border, areas that add up); every record with what a record
/// can be; every page descriptor with the union over its records, every index entry with the union
/// over what it describes; the number of records, the largest rank and the table of errors with the
/// records; and that no vertex comes twice. Does not apply the splits: whether each finds its fan
/// is known to a refinement of everything alone.
///
/// Vertex keys are compared exactly: by one bit for each position of the bounds where that fits
/// into the memory, otherwise by sorting, one part of the keys in each pass over the pages.
///
/// Damage is reported, as much of it as can be told apart; below a damaged node nothing can be.
/// @throws Error not_found, io_error, unsupported_version, invalid_argument (no regular file),
/// cancelled
[[nodiscard]] VerifyReport verify_store(const std::string& path, const VerifyOptions& options = {},
                                        const std::stop_token& stop = {},
                                        const VerifyProgress& progress = {});

}  // namespace ptin
