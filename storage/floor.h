// SPDX-License-Identifier: GPL-3.0-or-later
//
// The heights of the raster that a file was built from, read tile by tile.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/geometry/interval.h"
#include "storage/file/io_counters.h"
#include "storage/file/readable_file.h"
#include "storage/floor_facts.h"
#include "storage/floor_page.h"
#include "storage/floor_tile.h"
#include "storage/merit.h"
#include "storage/store_facts.h"

namespace ptin {

/// Where the sections lie.
struct FloorPlace {
  std::uint64_t root = 0, root_checksum = 0;  ///< Offset of the root.
  ByteRange nodes, pages;                     ///< Nodes below the root.
  /// The offset of a node by FloorTree::position().
  [[nodiscard]] std::uint64_t offset_of_node(std::uint64_t position) const noexcept {
    return position == 0 ? root : nodes.offset + (position - 1) * layout::kNodeBytes;
  }
  [[nodiscard]] std::uint64_t offset_of_page(std::uint64_t number) const noexcept {
    return pages.offset + number * layout::kFloorPageBytes;
  }
};

/// Reads pages of heights, and verifies each before its tiles are seen: an entry of a node holds the
/// checksum of what it describes, and the section table that of the root. The root is
/// read at the making and stays in memory. Threads: const functions may be called at once.
class Floor {
 public:
  /// What a question has read lately of one floor, and so does not read again, nor count: parts of a line,
  /// or of a place, share pages. A value of its caller's, which stays where it is. While a visit goes on
  /// nothing else may read with it. Memory: 4 KiB for each of at most 80 nodes and pages.
  /// Threads: one owner.
  class Recent {
   public:
    Recent() = default;
    Recent(const Recent&) = delete;
    Recent& operator=(const Recent&) = delete;
    /// The page that was looked at last.
    [[nodiscard]] std::uint64_t page() const noexcept { return last_->number; }
    /// Goes on with another floor.
    void forget() noexcept {
      for (Page& page : pages_) page.number = UINT64_MAX;
      for (Node& node : nodes_) node.position = UINT64_MAX;
      last_ = &pages_[0];
    }

   private:
    friend class Floor;
    struct Page {
      std::uint64_t number = UINT64_MAX, first = 0, end = 0;  ///< From a key to another.
      std::vector<std::byte> bytes;
      [[nodiscard]] FloorPageView view() const noexcept {
        return FloorPageView(std::span(bytes).first(layout::kFloorPageBytes));
      }
    };
    struct Node {
      std::uint64_t position = UINT64_MAX;
      std::unique_ptr<layout::FloorNode> node;
    };
    std::array<Page, 64> pages_;
    std::array<Node, 16> nodes_;
    const Page* last_ = &pages_[0];
  };

  /// Reads the root.
  /// @param file   Borrowed.
  /// @param store  What the file says of its terrain.
  /// @throws Error corruption, io_error
  Floor(const ReadableFile& file, const FloorPlace& place, const StoreFacts& store);

  [[nodiscard]] const FloorFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] const FloorNumbers& numbers() const noexcept { return numbers_; }
  /// As vertices have them.
  [[nodiscard]] const HeightEncoding& heights() const noexcept { return heights_; }
  [[nodiscard]] std::uint64_t pages() const noexcept { return tree_.pages(); }

  /// ReadableFile::is_far() of the file.
  [[nodiscard]] bool is_far() const noexcept { return file_.is_far(); }
  /// Has what some tiles are read from come together, where it lies elsewhere: a round for each level of
  /// nodes below the root, and one for the pages. Else nothing.
  /// @param keys    FloorShape::key() of tiles, ascending.
  /// @param coming  Whether the tiles are read next, or something else before them.
  /// @throws Error corruption, io_error
  void announce(std::span<const std::uint64_t> keys, Recent& recent, IoCounters& counters,
                Coming coming = Coming::kInOrder) const;
  /// Announces without reading anything from elsewhere: where nodes are not at hand, they are announced, and the
  /// tiles below them when this is called again.
  void announce_known(std::span<const std::uint64_t> keys, Recent& recent,
                      IoCounters& counters) const;

  /// What is known of samples before they are read.
  struct Bounds {
    GridBox box;     ///< Of their places, grid units.
    Interval codes;  ///< Of their heights, not nearer; empty: all are void.
  };
  struct TileAt {
    std::uint32_t column, row;
    Bounds bounds;
  };
  /// Takes a tile that is there for the call.
  using TakeTile = std::function<bool(const TileAt&, const FloorTile&)>;

  /// Reads tiles along the curve, so that each page is read once.
  /// @param wants  Whether samples within these bounds are wanted: true for wider bounds where it is for
  ///               some within them.
  /// @param take   Takes each tile that is wanted; false ends it.
  /// @return False when `take` ended it.
  /// @throws Error corruption, io_error; what the functions throw
  /// Cost: the nodes and pages that hold such tiles, of a far file a round for each level of nodes and one
  /// for the pages.
  bool visit(const std::function<bool(const Bounds&)>& wants, const TakeTile& take, Recent& recent,
             IoCounters& counters) const;

  /// The caller's part of a best-first search.
  class BestVisitor {
   public:
    BestVisitor() = default;
    BestVisitor(const BestVisitor&) = delete;
    BestVisitor& operator=(const BestVisitor&) = delete;
    virtual ~BestVisitor() = default;
    /// An upper bound of the merit of all within these bounds: wider ones have no smaller merit.
    /// A value of -infinity: nothing there is wanted.
    [[nodiscard]] virtual Merit bound(const Bounds& bounds) const = 0;
    /// Whether all that is wanted will probably be visited: of a far file it is announced together.
    [[nodiscard]] virtual bool wants_all() const { return false; }
    /// Takes a tile. Returns the cut-off: what is below it is not read.
    /// @param left  No merit of what was not visited yet is above it.
    virtual Merit visit(const TileAt& at, const FloorTile& tile, Merit left) = 0;
  };
  /// Reads tiles by pages of falling merit until the cut-off is above all that is left.
  /// @throws Error corruption, io_error; what the visitor throws
  void visit_best_first(BestVisitor& visitor, Merit cut_off, Recent& recent,
                        IoCounters& counters) const;

  /// Reads a tile.
  /// REQUIRES: there is such a column and row of tiles.
  /// @throws Error corruption, io_error
  /// Cost: a node a level and a page, about 3 us where the system has them; 1 ns a sample.
  void read(std::uint32_t column, std::uint32_t row, Recent& recent, FloorTile& tile,
            IoCounters& counters) const;

 private:
  static constexpr std::size_t kSlots = 256;
  /// A node that was verified. The lock is held while it is copied, never while it is read.
  struct Slot {
    std::mutex lock;
    std::uint64_t position = UINT64_MAX;
    std::unique_ptr<layout::FloorNode> node;
  };

  /// A node or a page as the node above it describes it.
  struct Found {
    std::uint64_t number;  ///< On its level.
    std::uint64_t end;     ///< Key of the first tile of the next one.
    layout::FloorEntry entry;
    std::size_t level;  ///< That of pages is tree_.levels().
    Merit merit = kNoMerit;
  };
  [[nodiscard]] layout::FloorNode read_node(const Found& found) const;
  /// A node, copied from those that were verified before, or read.
  void take_node(const Found& found, layout::FloorNode& node, IoCounters& counters) const;
  /// The result is there until the next call.
  [[nodiscard]] const layout::FloorNode& node(const Found& found, Recent& recent,
                                              IoCounters& counters) const;
  using Bound = std::function<Merit(const Bounds&)>;
  [[nodiscard]] Found root() const noexcept;
  /// The page that holds a key; the node above it, `depth` levels below the root, where that is less deep.
  [[nodiscard]] Found find(std::uint64_t key, std::size_t depth, Recent& recent,
                           IoCounters& counters) const;
  /// What of a node's entries is not below the cut-off, along the curve.
  void expand(const Found& found, const Bound& bound, Merit cut_off, std::vector<Found>& below,
              Recent& recent, IoCounters& counters) const;
  /// The pages that are not below the cut-off, along the curve.
  [[nodiscard]] std::vector<Found> find_pages(const Bound& bound, Merit cut_off, Recent& recent,
                                              IoCounters& counters) const;
  void announce(const std::vector<Found>& found, const Recent& recent, IoCounters& counters,
                Coming coming = Coming::kInOrder) const;
  [[nodiscard]] std::vector<Found> find_all(std::span<const std::uint64_t> keys, std::size_t depth,
                                            Recent& recent, IoCounters& counters) const;
  [[nodiscard]] bool is_at_hand(const Found& node, const Recent& recent) const;
  [[nodiscard]] Bounds bounds_of(const TileRange& tiles, OrderedHeight least,
                                 OrderedHeight greatest) const;
  const Recent::Page& read_page(const Found& found, Recent& recent, IoCounters& counters) const;
  /// Throws where the raster has tiles from one key to another, that one not.
  void check_none(std::uint64_t from, std::uint64_t to) const;
  /// Visits the tiles of a page; false when `visit` ended it.
  template <class Visit>
  bool visit_tiles(const Recent::Page& page, const Visit& visit) const;
  void decode(const Recent::Page& page, std::size_t i, std::uint32_t column, std::uint32_t row,
              FloorTile& tile) const;
  [[nodiscard]] bool has_heights(const FloorTile& tile) const;
  [[noreturn]] void damaged(const char* what) const;

  const ReadableFile& file_;
  FloorPlace place_;
  FloorFacts facts_;
  FloorTree tree_{1};
  layout::FloorNode root_{};
  HeightEncoding heights_;
  FloorNumbers numbers_;
  mutable std::vector<Slot> slots_{kSlots};
};

}  // namespace ptin
