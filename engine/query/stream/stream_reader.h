// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive transmission, the receiver: bytes in as they come, a valid TIN at any time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/stream/stream_format.h"
#include "storage/store_facts.h"

namespace ptin {

class SplitDecoder;
struct LocalSplit;

struct StreamReaderOptions {
  /// The memory is for a frame that is not whole yet and for the mesh; the limit is checked before
  /// either grows.
  QueryLimits limits;
};

/// Follows a stream, and after its end the streams that go on from it. Threads: one owner.
class StreamReader {
 public:
  /// @param name  Name of the stream, in errors.
  explicit StreamReader(std::string name, StreamReaderOptions options = {});
  StreamReader(StreamReader&&) noexcept;
  StreamReader& operator=(StreamReader&&) noexcept;
  ~StreamReader();

  /// Takes the next bytes, however they were cut, and applies every frame that is whole by now.
  /// @return Number of bytes taken: all, unless the stream ends before. Bytes behind the end of a
  /// stream belong to another stream, which goes on from there: feed them again.
  /// @throws Error invalid_argument     a store, not a stream
  ///               corruption           bytes that no program wrote (storage/FORMAT.md, "A reader
  ///                                    of streams must reject"), a stream that does not go on from
  ///                                    this mesh; names frame and byte. The mesh stays valid, its
  ///                                    certificate that of the last whole frame; nothing more can
  ///                                    be fed.
  ///               unsupported_version
  ///               resource_exhausted   what comes would exceed the memory limit
  ///               cancelled
  /// Cost: linear in the bytes and, where stars are of bounded degree, in the splits. A stream that
  /// goes on from another costs O(n log n) on a mesh of n vertices, however few splits it brings;
  /// so a caller who does not trust the sender limits how many there are. A frame that is not whole
  /// waits in memory, and nothing is reserved before its bytes came.
  std::size_t feed(std::span<const std::byte> bytes) { return feed(bytes, false); }

  /// As feed(), but takes nothing behind the first head or frame that `bytes` complete: for callers
  /// that look at the mesh after each frame.
  std::size_t feed_frame(std::span<const std::byte> bytes) { return feed(bytes, true); }

  /// Gives up the rest of a stream that was cut. The bytes fed next are those of another stream,
  /// from its head on.
  void begin_next();

  /// False until T0 has arrived. Before that the mesh and its certificate mean nothing.
  [[nodiscard]] bool has_mesh() const noexcept { return !tin_.triangles.empty(); }
  /// The mesh. Every vertex and triangle is alive, and keeps its id until another stream begins.
  [[nodiscard]] const Tin& tin() const noexcept { return tin_; }
  /// A number that changes when vertices and triangles get other ids: when T0 arrives, and when a
  /// stream that goes on from another begins.
  [[nodiscard]] std::uint64_t numbering() const noexcept { return numbering_; }
  /// What the mesh is certified for in the region that the stream was asked for; at least
  /// base_error.
  [[nodiscard]] const Certificate& certificate() const noexcept { return certificate_; }
  /// Facts of the file from which the stream came, as far as a stream has them: map, heights,
  /// bounds, base.
  [[nodiscard]] const StoreFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] const std::string& metadata() const noexcept { return metadata_; }
  [[nodiscard]] std::uint64_t t0_vertices() const noexcept { return t0_vertices_; }

  /// Splits of the current stream that are applied, and all that it has.
  [[nodiscard]] std::uint64_t splits() const noexcept { return splits_; }
  [[nodiscard]] std::uint64_t splits_in_all() const noexcept { return splits_in_all_; }
  /// True once the end of the current stream arrived.
  [[nodiscard]] bool is_complete() const noexcept { return complete_; }
  /// Bytes fed that belong to whole frames.
  [[nodiscard]] std::uint64_t bytes_used() const noexcept { return offset_; }

 private:
  enum class Expects { kHead, kStart, kT0, kSplits, kNothing };

  /// Bytes of what comes next, as far as is known.
  [[nodiscard]] std::size_t wanted() const;
  std::size_t feed(std::span<const std::byte> bytes, bool one_frame);
  void take(std::span<const std::byte> bytes);
  void check_magic() const;
  void take_head(std::span<const std::byte> bytes);
  void take_frame(const stream::FrameHead& head, std::span<const std::byte> payload);
  void take_start(std::span<const std::byte> payload);
  void take_t0(std::span<const std::byte> payload);
  void take_splits(std::span<const std::byte> payload);
  void take_end(std::span<const std::byte> payload);
  void apply(const LocalSplit& split);
  [[nodiscard]] std::string place() const;
  void check_stop() const;
  /// @throws Error resource_exhausted when `bytes` exceed the limit
  void admit(std::uint64_t bytes) const;
  [[noreturn]] void reject(const std::string& why) const;

  std::string name_;
  StreamReaderOptions options_;
  std::vector<std::byte> waiting_;  ///< Bytes of a frame that is not whole.
  std::uint64_t offset_ = 0;
  std::uint32_t sequence_ = 0;
  Expects expects_ = Expects::kHead;
  bool complete_ = false;

  std::uint64_t fingerprint_ = 0;
  StoreFacts facts_;
  std::string metadata_;
  std::uint64_t base_vertices_ = 0, base_digest_ = 0;
  std::uint64_t t0_vertices_ = 0;
  std::uint64_t numbering_ = 0;
  std::uint64_t splits_ = 0, splits_in_all_ = 0;
  std::uint64_t digest_ = 0;  ///< Digest of the mesh.
  Certificate certificate_;
  Tin tin_;
  std::unique_ptr<SplitDecoder> code_;
};

}  // namespace ptin
