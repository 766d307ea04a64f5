// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where finished segments go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/hierarchy/segment.h"
#include "engine/construct/scratch/array_file.h"
#include "storage/packed_segment.h"
#include "storage/star.h"

namespace ptin {

/// A segment that is ready for the output, and what the output must know of what was left out of it.
struct PreparedSegment : PackedSegment {
  RecordBounds left_out;           ///< The largest of records that were left out.
  std::uint64_t void_records = 0;  ///< That make a void triangle or vertex; those left out too.
};

/// All of a segment but its pages.
template <class File, MaybeConst<PreparedSegment> Segment>
void serialize(File& file, Segment& s) {
  file.values(s.descriptors, s.errors, s.max_rank, s.left_out, s.void_records);
}

/// The part of an output that workers do: any number of threads at once, in any process that sees
/// the output's folder.
class SegmentPacker {
 public:
  SegmentPacker() = default;
  SegmentPacker(const SegmentPacker&) = delete;
  SegmentPacker& operator=(const SegmentPacker&) = delete;
  virtual ~SegmentPacker() = default;

  /// Packs the final records of one tile, with their stars. May change the records in place. Rings
  /// of records of a first pass (construct/collapse/first_pass.h) are empty.
  [[nodiscard]] virtual PreparedSegment prepare(StarredRecords& records) const = 0;
  /// Puts pages to their place.
  /// @param offset  In bytes, from the first page of the output.
  /// @throws Error io_error, resource_exhausted
  virtual void place(std::span<const std::byte> pages, std::uint64_t offset) const = 0;
};

/// Receives segments, in an order that depends on the tree of tiles alone. Threads: one at a time.
class SegmentOutput {
 public:
  SegmentOutput() = default;
  SegmentOutput(const SegmentOutput&) = delete;
  SegmentOutput& operator=(const SegmentOutput&) = delete;
  virtual ~SegmentOutput() = default;

  /// What workers of this process use. Lives as long as the output.
  [[nodiscard]] virtual const SegmentPacker& packer() const = 0;
  /// Takes the next segment, whose pages are in their place, and not looked at here.
  virtual void add(const PreparedSegment& segment) = 0;
  /// Bytes of the pages of all segments that were added.
  [[nodiscard]] virtual std::uint64_t page_bytes() const = 0;
  /// Where the output ends, as JSON for the manifest.
  [[nodiscard]] virtual nlohmann::json position() const = 0;
  /// Makes everything up to position() durable.
  virtual void sync() = 0;
  /// Goes back to a position that was made durable; what lies behind it goes.
  /// @throws Error corruption
  virtual void resume(const nlohmann::json& position) = 0;
};

}  // namespace ptin
