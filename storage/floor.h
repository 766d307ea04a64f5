// SPDX-License-Identifier: GPL-3.0-or-later
//
// The heights of the raster that a file was built from, read tile by tile.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "storage/file/io_counters.h"
#include "storage/file/readable_file.h"
#include "storage/floor_facts.h"
#include "storage/floor_tile.h"
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
/// checksum of what it describes, and the section table that of the root. The root stays in memory;
/// as in the index, a node counts whenever its entries are looked at. Threads: const functions may be
/// called at once.
class Floor {
  /// An entry of a node: what it describes, and where the keys below that end.
  struct Child {
    std::uint64_t number;  ///< Of a node within its level, or of a page.
    std::uint64_t end;
    layout::FloorEntry entry;
  };
  /// The nodes on the way to a page, which are not read again for the next page below them.
  struct Path {
    struct Step {
      Child at;
      layout::FloorNode node;
    };
    bool is_begun = false;    ///< The root was looked at.
    std::vector<Step> below;  ///< Below the root, down to a leaf.
  };

 public:
  /// What was read last, for tiles that lie there, too. A value of its caller's, for one file.
  class Page {
   private:
    friend class Floor;
    std::uint64_t number_ = UINT64_MAX, first_ = 0, end_ = 0;  ///< From a key to another.
    std::vector<std::byte> bytes_;
    Path path_;
  };

  /// Reads the root.
  /// @param file   Borrowed.
  /// @param store  What the file says of its terrain.
  /// @throws Error corruption, io_error
  Floor(const ReadableFile& file, const FloorPlace& place, const StoreFacts& store);

  [[nodiscard]] const FloorFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] const FloorNumbers& numbers() const noexcept { return numbers_; }
  [[nodiscard]] std::uint64_t pages() const noexcept { return tree_.pages(); }

  /// Tiles from a column and a row to others, these too.
  struct Tiles {
    std::uint32_t first_column, first_row, last_column, last_row;
  };
  /// A tile, and what is known of it before its samples are decoded.
  struct TileBounds {
    std::uint32_t column, row;
    OrderedHeight least, greatest;  ///< Of its samples, not nearer; least > greatest: all are void.
  };

  /// Reads some tiles along the curve, so that each page is read once.
  /// @param wants  Whether a tile is to be read. Of a whole page it is asked by the page's heights, for
  ///               each of its tiles until one is wanted: so it may have no state.
  /// @param take   Takes each tile that is wanted. The tile is there for the call. False ends it.
  /// @return False when `take` ended it.
  /// REQUIRES: the tiles are those of the shape.
  /// @throws Error corruption, io_error; what the functions throw
  /// Cost: the nodes and pages of these tiles. Pages of about 8192 tiles at a time are announced
  /// together; they take 1 MiB of memory at most.
  bool visit(const Tiles& tiles, const std::function<bool(const TileBounds&)>& wants,
             const std::function<bool(const TileBounds&, const FloorTile&)>& take,
             IoCounters& counters) const;

  /// Reads a tile.
  /// @param page  That of an earlier call is not read again where it holds this tile.
  /// REQUIRES: there is such a column and row of tiles.
  /// @throws Error corruption, io_error
  /// Cost: a node a level and a page, where `page` has not those of the tile; about 3 us where the
  /// system has them, and 1 ns a sample.
  void read(std::uint32_t column, std::uint32_t row, Page& page, FloorTile& tile,
            IoCounters& counters) const;

 private:
  static constexpr std::size_t kSlots = 256;
  /// A node that was verified. The lock is held while it is copied, never while it is read.
  struct Slot {
    std::mutex lock;
    std::uint64_t position = UINT64_MAX;
    std::unique_ptr<layout::FloorNode> node;
  };
  [[nodiscard]] layout::FloorNode read_node(std::size_t level, std::uint64_t number,
                                            std::uint64_t checksum) const;
  [[nodiscard]] layout::FloorNode node(std::size_t level, const Child& at,
                                       IoCounters& counters) const;
  [[nodiscard]] Child child_with(std::uint64_t key, const layout::FloorNode& node,
                                 const Child& at) const;
  /// The page that holds a key.
  [[nodiscard]] Child find(std::uint64_t key, Path& path, IoCounters& counters) const;
  void read_page(const Child& found, Page& page, IoCounters& counters) const;
  /// The pages that hold wanted tiles, ascending, and announced.
  [[nodiscard]] std::vector<Child> pages_of(std::span<const std::uint64_t> keys,
                                            const std::function<bool(const TileBounds&)>& wants,
                                            Path& path, IoCounters& counters) const;
  bool visit_page(const Page& page, std::span<const std::uint64_t> keys,
                  const std::function<bool(const TileBounds&)>& wants,
                  const std::function<bool(const TileBounds&, const FloorTile&)>& take,
                  FloorTile& tile) const;
  void decode(const Page& page, std::size_t i, std::uint32_t column, std::uint32_t row,
              FloorTile& tile) const;
  [[nodiscard]] bool has_heights(const FloorTile& tile) const;
  [[noreturn]] void damaged(const char* what) const;

  const ReadableFile& file_;
  FloorPlace place_;
  layout::FloorNode root_;
  FloorFacts facts_;
  FloorTree tree_{1};
  FloorNumbers numbers_;
  mutable std::vector<Slot> slots_{kSlots};
};

}  // namespace ptin
