// SPDX-License-Identifier: GPL-3.0-or-later
//
// One vertex split as a few bits: everything in it is coded relative to the mesh that both sides
// have. storage/FORMAT.md, "Streams", has it step by step.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "engine/mesh/star.h"
#include "engine/mesh/tin.h"
#include "engine/query/stream/range_coder.h"

namespace ptin {

/// A split in a mesh's own numbering. `flags` are VertexSplit::Flag.
struct LocalSplit {
  bool begins_level = false;  ///< First split of a level: the number of w counts from 0 again.
  VertexId w = 0, vl = 0, vr = 0;
  GridPoint u;
  HeightBits height = 0;
  std::uint16_t flags = 0;
};

/// Codes splits one after the other, and learns as it goes. An encoder and a decoder that see the
/// same splits over the same meshes stay in the same state. Threads: one owner.
class SplitCode {
 public:
  explicit SplitCode(HeightType type) : type_(type) {}

  /// Codes `split`, which comes next on `tin`. Cost: the degree of w.
  /// @return null; or what does not fit, as a sentence's predicate ("names a w ..."). Then `split`
  /// is no split of this mesh, and neither the code nor this object can be used on.
  [[nodiscard]] const char* encode(RangeEncoder& coder, const Tin& tin, LocalSplit split) {
    return code(coder, tin, split);
  }
  /// Decodes the split that comes next on `tin`. Any input is safe. What is decoded has its w, vl
  /// and vr in the mesh, in order around w, u on the grid, and heights and classes that fit;
  /// split() finds out whether it is a split. REQUIRES: every vertex of `tin` is alive, the mesh
  /// valid.
  /// @return null; or why there is no split, as encode() says it.
  [[nodiscard]] const char* decode(RangeDecoder& coder, const Tin& tin, LocalSplit& split) {
    return code(coder, tin, split);
  }

  /// Begins a block with the next split: numbers the vertices of `tin` along the Hilbert curve.
  /// Cost: linear in the mesh, and n log n in the vertices that are new.
  void begin_block(const Tin& tin);
  /// The number that stands for a w in the current block: its place along the curve among the
  /// vertices that were there when the block began. A vertex that came within the block keeps its
  /// id, which is behind all of these.
  [[nodiscard]] std::uint32_t rank_of(VertexId v) const noexcept {
    return v < rank_.size() ? rank_[v] : v;
  }

 private:
  enum class Side : std::uint8_t { kInner, kNoLeft, kNoRight };

  [[nodiscard]] VertexId vertex_at(std::uint64_t rank) const noexcept {
    return rank < curve_.size() ? curve_[rank].vertex : static_cast<VertexId>(rank);
  }

  template <class Coder>
  const char* code(Coder& coder, const Tin& tin, LocalSplit& s);
  template <class Coder>
  const char* code_w(Coder& coder, const Tin& tin, LocalSplit& s);
  template <class Coder>
  const char* code_fan(Coder& coder, const Tin& tin, LocalSplit& s);
  template <class Coder>
  const char* code_inner_position(Coder& coder, const Tin& tin, LocalSplit& s);
  template <class Coder>
  const char* code_border_position(Coder& coder, const Tin& tin, LocalSplit& s);
  template <class Coder>
  const char* code_height(Coder& coder, const Tin& tin, LocalSplit& s);
  template <class Coder>
  void code_classes(Coder& coder, const Tin& tin, LocalSplit& s);

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
  [[nodiscard]] std::int64_t predicted(const Tin& tin, const LocalSplit& s, std::size_t k) const;
  [[nodiscard]] std::size_t roughness(const Tin& tin) const;
  [[nodiscard]] std::int64_t number_of(HeightBits bits) const noexcept;
  [[nodiscard]] HeightBits bits_of(std::int64_t number) const noexcept;

  HeightType type_;
  std::uint64_t last_w_ = 0;  ///< Number of the last w.
  struct OnCurve {
    std::uint64_t position;
    VertexId vertex;
    friend bool operator<(const OnCurve& a, const OnCurve& b) noexcept {
      return a.position < b.position;
    }
  };
  std::vector<OnCurve> curve_;       ///< Vertices along the curve, when the block began.
  std::vector<std::uint32_t> rank_;  ///< Where each stands in `curve_`.
  std::int64_t last_height_ = 0;

  Star star_;                       ///< The star of w.
  std::size_t start_ = 0;           ///< Index in star_.link at which the link begins.
  Side side_ = Side::kInner;        ///< Which of the new triangles does not exist.
  std::size_t fan_first_ = 0;       ///< Place of corner vl, counted from start_.
  std::size_t fan_size_ = 0;        ///< Triangles of the fan.
  std::vector<GridPoint> outline_;  ///< w, vl, ..., vr.

  BitModel level_;
  NumberModel gap_;
  BitModel at_border_, no_left_;
  RangeModel first_, inner_size_, border_size_, x_, y_, along_;
  std::array<BitModel, 4> is_void_;
  std::array<NumberModel, 34> residual_;  ///< By the length in bits of the fan's range of heights.
  std::array<BitModel, 4> left_void_, right_void_;
};

}  // namespace ptin
