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
  /// Memory for the comparison of vertex keys. Reading takes some MiB besides.
  std::uint64_t memory_bytes = std::uint64_t{256} << 20;
  /// Verification ends when one fault more than this is found.
  std::size_t max_faults = 100;
};

struct VerifyFault {
  std::string what;   ///< A sentence: what is wrong, what was expected.
  std::string where;  ///< "header", "page 17", "index level 0, node 3", "section \"metadata\"".
};

struct VerifyReport {
  std::vector<VerifyFault> faults;
  bool stopped_early = false;  ///< max_faults was reached.
  std::uint64_t pages = 0;     ///< Pages looked at; records and nodes likewise.
  std::uint64_t records = 0;
  std::uint64_t index_nodes = 0;
  std::uint64_t key_passes = 1;  ///< How often the pages were read to compare vertex keys.

  [[nodiscard]] bool is_sound() const noexcept { return faults.empty(); }
};

/// Called now and then: pages looked at, and pages to look at in all, both over all passes.
using VerifyProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Verifies a store. It compares
/// - all checksums;
/// - gaps and unused places with zero;
/// - the metadata with the grammar of JSON;
/// - T0 with a triangulation of a convex domain (positive orientation, each edge once in each
///   direction, one convex border, areas that add up);
/// - every record with what a record can be;
/// - every page descriptor with the union over its records, and every index entry with the union
///   over what it describes;
/// - the directory, where there is one, with what the index says of the pages;
/// - the heights of a raster, where there are any, with the header and with how they are to be packed;
/// - the number of records, the largest rank, the least and largest height (over the records'
///   intervals too), the flag of voids and the table of errors with the records;
/// - all vertices with each other: no vertex comes twice.
///
/// Bytes, never triangles: whether each split finds its fan, each record is contained in those that it
/// needs, and the full TIN is that of the raster's heights, check_hierarchy() finds out
/// (engine/query/refine/hierarchy_check.h).
///
/// Vertex keys are compared exactly: by one bit for each position of the bounds where that fits the
/// memory, otherwise by sorting, one part of the keys in each pass over the pages.
///
/// Damage is no Error but is reported, as much of it as can be told apart. What lies below a
/// damaged node cannot be looked at.
/// @throws Error not_found, io_error, unsupported_version, invalid_argument (no regular file),
///               cancelled
[[nodiscard]] VerifyReport verify_store(const std::string& path, const VerifyOptions& options = {},
                                        const std::stop_token& stop = {},
                                        const VerifyProgress& progress = {});

}  // namespace ptin
