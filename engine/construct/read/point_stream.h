// SPDX-License-Identifier: GPL-3.0-or-later
//
// The points of one file, in any format, read once in batches.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/left_out.h"
#include "engine/construct/grid/point_classes.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/read/point_part.h"

namespace ptin {

struct ExternalMemory;

/// Called for a row of a text that is no point and is passed over: its line, from 1, and what is
/// wrong with it.
using TakeInvalidRow = std::function<void(std::uint64_t line, const std::string& fault)>;

/// What a stream may use. Memory, stop and progress are for opening the vertices of a TIN alone: they
/// are sorted on disk before the first of them comes (tin/tin_vertices.h).
struct StreamResources {
  const ExternalMemory* memory = nullptr;  ///< Not owned; null: the stream chooses.
  std::stop_token stop;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< May be empty.
  /// Text: rows that are no points are passed over, whatever PointChoice says, and reported here;
  /// empty: PointChoice decides.
  TakeInvalidRow invalid_row{};
};

/// One input file as a stream of points. Not thread-safe. The file stays open as long as the stream
/// lives.
class PointStream {
 public:
  PointStream() = default;
  PointStream(const PointStream&) = delete;
  PointStream& operator=(const PointStream&) = delete;
  virtual ~PointStream() = default;

  /// What the file declares; known from the beginning.
  [[nodiscard]] virtual const PointStreamFacts& facts() const noexcept = 0;
  /// The next points, some thousands at a time; false when there is none left.
  /// @param batch  Overwritten.
  /// @throws Error  invalid_argument  the input is not what it says (the context names the place)
  ///                io_error          it cannot be read on
  [[nodiscard]] virtual bool next(std::vector<SourcePoint>& batch) = 0;

  /// Points left out so far: by the PointChoice, or by the file itself, which marks them as
  /// withheld or gives them no height.
  [[nodiscard]] virtual LeftOutPoints left_out() const noexcept { return {}; }
  /// Points so far by class, those of classes that are not wanted too. None from files without classes.
  [[nodiscard]] virtual PointClasses classes() const { return {}; }
  /// What the rows of a part of a text say of whether the text is one of points, once the part has
  /// been read to its end. None from other streams.
  [[nodiscard]] virtual std::optional<RowsOfPart> rows() const { return std::nullopt; }
  /// Warnings so far. Each part of a file reports those of what lies in it, and those that
  /// are about the file as a whole (SourceWarning::count is 0) may come from every part.
  [[nodiscard]] virtual SourceWarnings warnings() const { return {}; }
  /// Progress so far, in a unit of the stream's own: points, features or bytes.
  [[nodiscard]] virtual std::uint64_t done() const noexcept = 0;
  /// The progress at the end, in the unit of done(); 0 where it is unknown.
  [[nodiscard]] virtual std::uint64_t total() const noexcept = 0;
  /// Into how many parts it can be cut at most: that number is held against the file's bytes, which
  /// total() may not be.
  [[nodiscard]] virtual std::uint64_t most_parts() const noexcept { return UINT64_MAX; }
  /// True where points are compressed: reading them is work, more than what becomes of them at once.
  [[nodiscard]] virtual bool is_compressed() const noexcept { return false; }
};

}  // namespace ptin
