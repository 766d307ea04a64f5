// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where finished segments go.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "storage/star.h"

namespace ptin {

/// Receives segments, in an order that depends on the tree of tiles alone. Threads: one at a time.
class SegmentOutput {
 public:
  SegmentOutput() = default;
  SegmentOutput(const SegmentOutput&) = delete;
  SegmentOutput& operator=(const SegmentOutput&) = delete;
  virtual ~SegmentOutput() = default;

  /// Takes the final records of one tile with their stars, and may change them in place. Rings of
  /// records of a first pass (construct/collapse/first_pass.h) are empty.
  virtual void add_segment(StarredRecords& records) = 0;
  /// Where the output ends, as JSON for the manifest.
  [[nodiscard]] virtual nlohmann::json position() const = 0;
  /// Makes everything up to position() durable.
  virtual void sync() = 0;
  /// Goes back to a position that was made durable; what lies behind it goes.
  /// @throws Error corruption
  virtual void resume(const nlohmann::json& position) = 0;
};

}  // namespace ptin
