// SPDX-License-Identifier: GPL-3.0-or-later
//
// One vertex split as a few symbols: everything in it is told relative to the mesh that both sides
// have. storage/FORMAT.md, "Streams", has it step by step.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "engine/mesh/star.h"
#include "engine/mesh/tin.h"
#include "engine/query/stream/split_symbols.h"

namespace ptin {

/// A split in a mesh's own numbering. `flags` are VertexSplit::Flag.
struct LocalSplit {
  VertexId w = 0, vl = 0, vr = 0;
  GridPoint u;
  HeightBits height = 0;
  std::uint16_t flags = 0;
};

/// Tells splits by symbols, all but which w it is. Threads: one owner.
class SplitCode {
 public:
  explicit SplitCode(HeightType type) : type_(type) {}

  /// Writes down `split`, which comes next on `tin`. Cost: the degree of w.
  /// @return null; or what does not fit, as a sentence's predicate ("does not find its fan"). Then
  /// `split` is no split of this mesh, and some of its symbols are written.
  [[nodiscard]] const char* record(RecordedSymbols& symbols, const Tin& tin, LocalSplit split) {
    return code(symbols, tin, split);
  }
  /// Decodes the split of `split.w`, a vertex of `tin`, that comes next. Any input is safe. What is
  /// decoded has its vl and vr in order around w, u on the grid, and heights and classes that fit;
  /// split() finds out whether it is a split. REQUIRES: every vertex of `tin` is alive, the mesh
  /// valid.
  /// @return null; or why there is no split, as record() says it.
  [[nodiscard]] const char* decode(DecodedSymbols& symbols, const Tin& tin, LocalSplit& split) {
    return code(symbols, tin, split);
  }

 private:
  enum class Side : std::uint8_t { kInner, kNoLeft, kNoRight };

  template <class Symbols>
  const char* code(Symbols& symbols, const Tin& tin, LocalSplit& s);
  template <class Symbols>
  const char* code_fan(Symbols& symbols, const Tin& tin, LocalSplit& s);
  template <class Symbols>
  const char* code_inner_position(Symbols& symbols, const Tin& tin, LocalSplit& s);
  template <class Symbols>
  const char* code_border_position(Symbols& symbols, const Tin& tin, LocalSplit& s);
  template <class Symbols>
  const char* code_height(Symbols& symbols, const Tin& tin, LocalSplit& s);
  template <class Symbols>
  void code_classes(Symbols& symbols, const Tin& tin, LocalSplit& s);

  /// Reads the star of w. Its link begins at a vertex on which both sides agree: the one of
  /// smallest id, at a border the first.
  void read_star(const Tin& tin, VertexId w);
  /// Place of a vertex in the link of w, counted from start_; the size of the link when it is not
  /// there.
  [[nodiscard]] std::size_t place(VertexId v) const noexcept;
  [[nodiscard]] std::size_t fan_corners() const noexcept { return fan_size_ + 1; }
  /// Corner k of the fan, 0 for vl to fan_size_ for vr.
  [[nodiscard]] VertexId corner(std::size_t k) const noexcept;
  [[nodiscard]] TriangleId fan_triangle(std::size_t k) const noexcept;
  /// The range of y at which u may stand in column `x`; false when there is none.
  [[nodiscard]] bool column(std::int64_t x, std::int64_t& low, std::int64_t& high) const noexcept;
  [[nodiscard]] std::size_t fan_triangle_of(const Tin& tin, GridPoint u) const noexcept;
  [[nodiscard]] std::optional<std::int64_t> predicted(const Tin& tin, const LocalSplit& s,
                                                      std::size_t k) const;
  [[nodiscard]] std::size_t roughness(const Tin& tin) const;
  [[nodiscard]] std::int64_t number_of(HeightBits bits) const noexcept;
  [[nodiscard]] HeightBits bits_of(std::int64_t number) const noexcept;

  HeightType type_;
  Star star_;                       ///< The star of w.
  std::size_t start_ = 0;           ///< Index in star_.link at which the link begins.
  Side side_ = Side::kInner;        ///< Which of the new triangles does not exist.
  std::size_t fan_first_ = 0;       ///< Place of corner vl, counted from start_.
  std::size_t fan_size_ = 0;        ///< Triangles of the fan.
  std::vector<GridPoint> outline_;  ///< w, vl, ..., vr.
};

}  // namespace ptin
