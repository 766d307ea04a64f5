// SPDX-License-Identifier: GPL-3.0-or-later
//
// The border of any number of triangles on disk.
#pragma once

#include <stop_token>
#include <vector>

#include "engine/construct/scratch/record_file.h"
#include "engine/construct/tin/tin_faults.h"
#include "engine/construct/tin/tin_on_grid.h"

namespace ptin {

/// A directed edge with a triangle on its left and none on its right.
struct GridEdge {
  GridVertex from, to;
};

/// A border in memory: vertices in the order of their keys, edges in that of (from, to).
struct TinBorder {
  std::vector<GridPoint> positions;
  std::vector<double> heights;  ///< One for each of `positions`.
  std::vector<BorderEdge> edges;
};

/// Finds the border of triangles: the edges that are left when those with one triangle on each side
/// are taken out. Within a piece of 65536 triangles they are taken out in memory; what a piece
/// leaves is sorted on disk, where edges between pieces meet. Pieces are of one size whatever the
/// memory, so that the answer never depends on it.
///
/// An edge with two triangles on one side is a fault, and counted. It is missed where two pieces
/// each hold one triangle on either side of it. The border then winds twice around what is covered
/// twice, and fill_hull() and sweep_voids() find that.
class BorderFinder {
 public:
  explicit BorderFinder(const ExternalMemory& memory, const std::stop_token& stop = {})
      : edges_(memory, "edges", stop) {}

  /// @throws Error io_error, resource_exhausted (the disk is full)
  void add(const GridTriangle& t);
  /// Calls visit(edge) for each edge of the border, in no order that means anything. To be called
  /// once, after the last add().
  /// @param faults  Its shared_edges counts edges with several triangles on one side.
  /// @throws Error as add(), cancelled
  template <class Visit>
  void finish(TinFaults& faults, const Visit& visit, const std::stop_token& stop = {}) {
    clear_piece();
    Group group;
    edges_.merge(
        [&](std::span<const Side> sides) {
          for (const Side& s : sides) {
            if (!group.is_of(s)) {
              group.end(faults, visit);
              group = {s, {}};
            }
            ++group.count[s.is_reversed];
          }
        },
        stop);
    group.end(faults, visit);
  }

 private:
  static constexpr std::size_t kPiece = 1 << 16;
  /// An undirected edge, the smaller key first.
  struct Side {
    VertexKey low = kNoVertexKey, high = kNoVertexKey;
    double low_height = 0.0, high_height = 0.0;
    std::uint32_t is_reversed = 0;  ///< 1: its triangle has it from high to low.

    friend bool operator<(const Side& a, const Side& b) noexcept {
      return a.low != b.low     ? a.low < b.low
             : a.high != b.high ? a.high < b.high
                                : a.is_reversed < b.is_reversed;
    }
  };
  /// All sides of one edge.
  struct Group {
    Side side;
    std::array<std::uint64_t, 2> count{};  ///< By is_reversed.

    [[nodiscard]] bool is_of(const Side& s) const noexcept {
      return side.low == s.low && side.high == s.high;
    }
    template <class Visit>
    void end(TinFaults& faults, const Visit& visit) const {
      if (count[0] > 1 || count[1] > 1) {
        faults.shared_edges.add(point_of(side.low));
      } else if (count[0] != count[1]) {
        const GridVertex low{point_of(side.low), side.low_height};
        const GridVertex high{point_of(side.high), side.high_height};
        visit(count[0] != 0 ? GridEdge{low, high} : GridEdge{high, low});
      }
    }
  };
  void clear_piece();

  std::vector<Side> piece_;
  ExternalSorter<Side> edges_;
};

/// Numbers the vertices of a border, and names its edges by these numbers. Where vertices share a
/// position the one with the least height counts. Cost: O(b log b) for b edges.
[[nodiscard]] TinBorder border_in_memory(std::span<const GridEdge> edges);

}  // namespace ptin
