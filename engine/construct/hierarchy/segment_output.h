// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where finished segments go.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "storage/star.h"

namespace ptin {

/// Receives segments, in an order that depends on the tree of tiles alone. Threads: prepare() from
/// any number at once, even while another function runs; everything else one at a time.
class SegmentOutput {
 public:
  SegmentOutput() = default;
  SegmentOutput(const SegmentOutput&) = delete;
  SegmentOutput& operator=(const SegmentOutput&) = delete;
  virtual ~SegmentOutput() = default;

  /// Makes of the final records of one tile, with their stars, what add() takes: bytes that only this
  /// class reads, and that may wait in a file. May change the records in place. Rings of records of a
  /// first pass (construct/collapse/first_pass.h) are empty.
  [[nodiscard]] virtual std::vector<std::byte> prepare(StarredRecords& records) const = 0;
  /// Takes the next segment, as prepare() made it.
  virtual void add(std::span<const std::byte> prepared) = 0;
  /// Both at once.
  void add_segment(StarredRecords& records) { add(prepare(records)); }
  /// Where the output ends, as JSON for the manifest.
  [[nodiscard]] virtual nlohmann::json position() const = 0;
  /// Makes everything up to position() durable.
  virtual void sync() = 0;
  /// Goes back to a position that was made durable; what lies behind it goes.
  /// @throws Error corruption
  virtual void resume(const nlohmann::json& position) = 0;
};

}  // namespace ptin
