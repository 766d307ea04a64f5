// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive transmission, the sender: T0, then splits, most important first, in frames. Any first
// few of the frames give a valid TIN with a known certified error (paper, sections 1 and 5.2).
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

/// One serving that a receiver has had. It is the first `splits`, in the total order, of the
/// records for which `predicate` is true and which no earlier serving in the list brought. So
/// servings are listed in the order in which they were received.
struct StreamHeld {
  PredicatePtr predicate;  ///< Null: everything.
  /// Fewer than there are: the serving was cut there.
  std::uint64_t splits = std::numeric_limits<std::uint64_t>::max();
};

struct StreamRequest {
  /// Monotone: what the receiver shall have. Null: everything.
  PredicatePtr wanted;
  /// The tolerance that is part of `wanted`, if there is one: certificates count what it leaves
  /// out.
  std::optional<double> tolerance;
  /// What the receiver has, serving by serving; empty: nothing, not even T0.
  std::vector<StreamHeld> held;
  /// Most splits to send; the most important ones are sent.
  std::uint64_t most_splits = std::numeric_limits<std::uint64_t>::max();
  /// Where `most_splits` take more than the memory, as many are sent as it holds, but these at least;
  /// none: all of them. Without a folder for temporary files alone.
  std::optional<std::uint64_t> fewest_splits;
  /// Most bytes: the stream is cut behind the last frame that ends within them, and has no end. T0
  /// and one frame of splits are sent whatever they take, so that every stream brings something.
  std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max();
  /// Text for the receiver (JSON: CRS, units, what was asked); at most 1 MiB.
  std::string metadata;
  /// Folder for what does not fit the memory, up to 55 bytes a split, in files without a name; empty: all
  /// has to fit.
  std::string temporary_folder;
  /// Threads that work on what does not fit; the bytes are the same for any number.
  int threads = 1;
  /// A part of the terrain takes at most so many bytes where it can be cut, and all of it where it is
  /// one part: for tests, and to find what is fastest.
  std::uint64_t most_part_bytes = std::numeric_limits<std::uint64_t>::max();
  QueryLimits limits;
};

struct StreamSummary {
  std::uint64_t base_vertices = 0;  ///< Vertices of T0, or of the mesh that the receiver has.
  std::uint64_t splits = 0;         ///< Sent.
  std::uint64_t frames = 0;
  std::uint64_t bytes = 0;
  bool is_cut = false;            ///< At StreamRequest::most_bytes.
  std::uint64_t split_bytes = 0;  ///< Bytes of frames of splits, heads included.
  Certificate certificate;        ///< Once all is received, in the region asked for.
  QueryCost cost;
};

/// Takes bytes, in order.
using ByteSink = std::function<void(std::span<const std::byte>)>;

/// Sends what `request` asks for and the receiver does not have. A frame of splits holds an eighth
/// as many splits as the mesh has vertices by then, but 256 to 2^20 of them: so at most about a
/// ninth of what has arrived waits in a frame that is not whole. The certificate of a frame is that
/// of a refinement by `wanted` that is cut there. It holds in the region asked for; everywhere when
/// `wanted` is everything or a tolerance alone.
/// @throws Error invalid_argument, resource_exhausted (before anything is sent), corruption,
/// io_error, cancelled; what `sink` throws
/// Cost: O(|T0| + h + k log k) time for k splits sent and h held; memory for two meshes of h + k
/// vertices, some 300 bytes a vertex, known beforehand: where servings state their splits, from what
/// the request says alone. With `most_splits`, and of servings that were cut, pages are read about as
/// far down in errors as their splits are (first_records(), select/total_order.h). Where that is more
/// than the limit and there is a folder, the terrain is worked on in parts (stream_frames.h): each page
/// is read once for the order of all records and then for every part that its records meet, and a
/// frame of 2^20 splits is what has to fit, some 130 MB.
StreamSummary write_stream(const OpenedTerrain& terrain, const StreamRequest& request,
                           const ByteSink& sink);

/// The most vertices that a receiver may have for a piece of `splits` more to fit so much memory, where
/// there is no folder for temporary files: for those who tell it before they are asked. Cost: none.
[[nodiscard]] std::uint64_t most_held_within(std::uint64_t memory_bytes,
                                             std::uint64_t splits) noexcept;

}  // namespace ptin
