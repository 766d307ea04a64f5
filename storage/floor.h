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

#include "engine/geometry/height.h"
#include "storage/file/io_counters.h"
#include "storage/file/readable_file.h"
#include "storage/floor_facts.h"
#include "storage/floor_tile.h"

namespace ptin {

/// Where the sections lie.
struct FloorPlace {
  ByteRange nodes, pages;
  std::uint64_t root_checksum = 0;
};

/// Reads pages of heights, and verifies each before its tiles are seen: an entry of a node holds the
/// checksum of what it describes, and the section table that of the root. Threads: const functions may
/// be called at once.
class Floor {
 public:
  /// A page that was read last, for tiles that lie on it, too. A value of its caller's.
  class Page {
   private:
    friend class Floor;
    std::uint64_t number_ = UINT64_MAX, first_ = 0;
    std::vector<std::byte> bytes_;
  };

  /// Reads the root.
  /// @param file  Borrowed.
  /// @throws Error corruption, io_error
  Floor(const ReadableFile& file, const FloorPlace& place, const HeightEncoding& heights);

  [[nodiscard]] const FloorFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] const FloorNumbers& numbers() const noexcept { return numbers_; }
  [[nodiscard]] std::uint64_t pages() const noexcept { return tree_.pages(); }

  /// ReadableFile::is_far() of the file.
  [[nodiscard]] bool is_far() const noexcept { return file_.is_far(); }
  /// Has what some tiles are read from come together, where it lies elsewhere: a round for each level of
  /// nodes below the root, and one for the pages. Else nothing.
  /// @param keys  FloorShape::key() of tiles, ascending.
  /// @throws Error corruption, io_error
  void announce(std::span<const std::uint64_t> keys, IoCounters& counters) const;

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
  /// Cost: the nodes and pages of these tiles, announced together; 16 bytes a tile.
  bool visit(const Tiles& tiles, const std::function<bool(const TileBounds&)>& wants,
             const std::function<bool(const TileBounds&, const FloorTile&)>& take,
             IoCounters& counters) const;

  /// Reads a tile.
  /// @param page  That of an earlier call is not read again where it holds this tile.
  /// REQUIRES: there is such a column and row of tiles.
  /// @throws Error corruption, io_error
  /// Cost: a node a level and a page, about 3 us where the system has them; 1 ns a sample.
  void read(std::uint32_t column, std::uint32_t row, Page& page, FloorTile& tile,
            IoCounters& counters) const;

 private:
  static constexpr std::size_t kSlots = 256;
  /// A node that was verified. The lock is held while it is copied.
  struct Slot {
    std::mutex lock;
    std::uint64_t position = UINT64_MAX;
    layout::FloorNode node;
  };

  [[nodiscard]] layout::FloorNode node(std::size_t level, std::uint64_t number,
                                       std::uint64_t checksum, IoCounters& counters) const;
  /// A page as the node above it describes it.
  struct Found {
    std::uint64_t number;
    std::uint64_t end;  ///< Key of the first tile of the next page.
    layout::FloorEntry entry;
  };
  /// The page that holds a key; the node above it, `depth` levels below the root, where that is less deep.
  [[nodiscard]] Found find(std::uint64_t key, std::size_t depth, IoCounters& counters) const;
  void announce_at(std::size_t depth, std::span<const std::uint64_t> keys,
                   IoCounters& counters) const;
  void read_page(const Found& found, Page& page, IoCounters& counters) const;
  [[nodiscard]] std::vector<std::uint64_t> keys_of(const Tiles& tiles) const;
  /// The pages that hold wanted tiles, ascending, and announced.
  [[nodiscard]] std::vector<Found> pages_of(const std::vector<std::uint64_t>& keys,
                                            const std::function<bool(const TileBounds&)>& wants,
                                            IoCounters& counters) const;
  void decode(const Page& page, std::size_t i, std::uint32_t column, std::uint32_t row,
              FloorTile& tile) const;
  [[noreturn]] void damaged(const char* what) const;

  const ReadableFile& file_;
  FloorPlace place_;
  FloorFacts facts_;
  FloorTree tree_{1};
  FloorNumbers numbers_;
  mutable std::vector<Slot> slots_{kSlots};
};

}  // namespace ptin
