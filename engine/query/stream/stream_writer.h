// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive transmission, the sender: T0, then splits, most important first, in frames of which
// any first few are a valid TIN with a known certified error (paper, sections 1 and 5.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/query_limits.h"
#include "storage/store_file.h"

namespace ptin {

/// Something that a receiver was served before: of the records for which `predicate` is true and
/// which no serving before this one in the list brought, the first `splits` of the total order. So
/// servings are listed in the order in which they were received.
struct StreamHeld {
  PredicatePtr predicate;                                            ///< Null: everything.
  std::uint64_t splits = std::numeric_limits<std::uint64_t>::max();  ///< Fewer: it was cut there.
};

struct StreamRequest {
  /// What the receiver shall have. Null: everything.
  PredicatePtr wanted;
  /// The tolerance that is part of `wanted`, if there is one: certificates say so at the end.
  std::optional<double> tolerance;
  /// In the order received; empty: nothing, not even T0.
  std::vector<StreamHeld> held;
  /// At most so many splits, the most important ones.
  std::uint64_t most_splits = std::numeric_limits<std::uint64_t>::max();
  /// Text for the receiver (JSON: CRS, units, what was asked); at most 1 MiB.
  std::string metadata;
  QueryLimits limits;
};

struct StreamSummary {
  std::uint64_t base_vertices = 0;  ///< Of T0, or of the mesh that the receiver has.
  std::uint64_t splits = 0;         ///< Sent.
  std::uint64_t frames = 0;
  std::uint64_t bytes = 0;
  std::uint64_t split_bytes = 0;  ///< Of these, frames of splits with their heads.
  Certificate certificate;        ///< Once all is received; where it was asked for.
  QueryCost cost;
};

/// Takes bytes, in order.
using ByteSink = std::function<void(std::span<const std::byte>)>;

/// Sends what `request` asks and the receiver does not have. A frame of splits holds an eighth as
/// many as the mesh has vertices by then, at least 256: so of what arrived at most a ninth waits.
/// Certificates are those of a refinement by `wanted` that is cut there: true where it was asked
/// for (everywhere when it is all or a tolerance alone).
/// @throws Error invalid_argument, resource_exhausted (before a page is read), corruption,
///               io_error, cancelled; what `sink` throws
/// Cost: k splits sent, h held: O(|T0| + h + k log k) time;
/// memory for two meshes of h + k vertices, known beforehand.
StreamSummary write_stream(const OpenedTerrain& terrain, const StreamRequest& request,
                           const ByteSink& sink);

}  // namespace ptin
