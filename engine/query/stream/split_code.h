// SPDX-License-Identifier: GPL-3.0-or-later
//
// One vertex split as a few bits: everything in it is told relative to the mesh that both sides
// have. storage/FORMAT.md, "Streams".
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
  bool begins_level = false;  ///< The number of w counts from 0 again.
  VertexId w = 0, vl = 0, vr = 0;
  GridPoint u;
  HeightBits height = 0;
  std::uint16_t flags = 0;
};

/// Codes splits one after the other, learning as it goes. An encoder and a decoder that see the
/// same splits over the same meshes stay equal. Threads: one owner.
class SplitCode {
 public:
  explicit SplitCode(HeightType type) : type_(type) {}

  /// Codes `split`, which comes next on `tin`. Cost: the degree of w.
  /// @return null; or what does not fit, as a sentence's predicate ("names a w ..."). The split is
  /// then not one of this mesh, and the code is useless.
  [[nodiscard]] const char* encode(RangeEncoder& coder, const Tin& tin, LocalSplit split) {
    return code(coder, tin, split);
  }
  /// The split that comes next on `tin`. REQUIRES: every vertex of `tin` is alive, the mesh valid.
  /// @return null; or why there is none. Any input is safe. What is decoded has its w, vl and vr in
  /// the mesh, in order around w, u on the grid and heights and classes that fit; split() tells
  /// whether it is a split.
  [[nodiscard]] const char* decode(RangeDecoder& coder, const Tin& tin, LocalSplit& split) {
    return code(coder, tin, split);
  }

  /// The next split begins a block: vertices are numbered again along the Hilbert curve. Cost:
  /// linear in the mesh, and n log n in the vertices that are new.
  void begin_block(const Tin& tin);
  /// Number of a vertex in the current block, which w's are told by: those that came within the
  /// block stand behind all others, as they came.
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

  /// The link of w from a vertex that both sides agree on.
  void read_star(const Tin& tin, VertexId w);
  [[nodiscard]] std::size_t place(VertexId v) const noexcept;
  [[nodiscard]] std::size_t fan_corners() const noexcept { return fan_size_ + 1; }
  /// Corner k of the fan, 0 for vl to fan_size_ for vr.
  [[nodiscard]] VertexId corner(std::size_t k) const noexcept;
  [[nodiscard]] TriangleId fan_triangle(std::size_t k) const noexcept;
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

  Star star_;                       ///< Of w.
  std::size_t start_ = 0;           ///< Where its link begins.
  Side side_ = Side::kInner;        ///< Which triangle does not exist.
  std::size_t fan_first_ = 0;       ///< Corner vl, counted from start_.
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
