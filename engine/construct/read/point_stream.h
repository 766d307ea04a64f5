// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as they come: one file of points of any kind, read once, in batches.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_point.h"

namespace ptin {

struct ExternalMemory;

/// What a source may take that is sorted before its first point comes.
struct StreamResources {
  const ExternalMemory* memory = nullptr;  ///< While the stream is opened; null: its own choice.
  std::stop_token stop;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< May be empty.
};

/// One input file as a stream. Not thread-safe; files stay open as long as it lives.
class PointStream {
 public:
  PointStream() = default;
  PointStream(const PointStream&) = delete;
  PointStream& operator=(const PointStream&) = delete;
  virtual ~PointStream() = default;

  [[nodiscard]] virtual const PointStreamFacts& facts() const noexcept = 0;
  /// The next points, some thousands at a time; false when there is none left.
  /// @param batch  Overwritten.
  /// @throws Error  invalid_argument  the input is not what it says (the context names the place)
  ///                io_error          it cannot be read on
  [[nodiscard]] virtual bool next(std::vector<SourcePoint>& batch) = 0;

  /// Points so far that the choice, or the source itself (withheld; no height), leaves out.
  [[nodiscard]] virtual std::uint64_t left_out() const noexcept { return 0; }
  /// How far dropping digits has moved a point so far, CRS units.
  [[nodiscard]] virtual double largest_shift() const noexcept { return 0.0; }
  /// Progress in units of its own; total 0 when that is unknown.
  [[nodiscard]] virtual std::uint64_t done() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t total() const noexcept = 0;
};

}  // namespace ptin
