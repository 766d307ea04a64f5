// SPDX-License-Identifier: GPL-3.0-or-later
//
// The nodes of the packed R-tree, read where they lie and verified on the way down from the root.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "engine/geometry/height.h"
#include "storage/file/io_counters.h"
#include "storage/file/mapped_file.h"
#include "storage/file/range_joiner.h"
#include "storage/file/readable_file.h"
#include "storage/index_shape.h"
#include "storage/layout.h"
#include "storage/page_store.h"
#include "storage/touch_bits.h"

namespace ptin {

/// Reads nodes of the index, and verifies each before its entries are used. An entry holds the
/// checksum of the node or page that it describes, and the section table holds the root's: so the
/// header's checksum stands for the whole file. Threads: const functions may be called at once.
class IndexNodes {
 public:
  struct Root {
    IndexShape shape;
    std::uint64_t offset = 0;  ///< Place of the root in the file.
    std::uint64_t root_checksum = 0;
  };

  IndexNodes(const IndexNodes&) = delete;
  IndexNodes& operator=(const IndexNodes&) = delete;
  virtual ~IndexNodes() = default;

  [[nodiscard]] const IndexShape& shape() const noexcept { return place_.shape; }
  [[nodiscard]] std::uint64_t root_checksum() const noexcept { return place_.root_checksum; }
  [[nodiscard]] const std::string& path() const noexcept { return file_.path(); }
  [[nodiscard]] const ReadableFile& file() const noexcept { return file_; }

  /// The node `number` of `level`, verified.
  /// @param expected  The checksum of the node, from its parent's entry or from the section table.
  /// @param scratch   Room for the node, where it is not read in place.
  /// @return `scratch`, or the node in the mapping.
  /// REQUIRES: level and number inside of the shape.
  /// @throws Error corruption, io_error
  [[nodiscard]] virtual const layout::IndexNode& node(std::uint32_t level, std::uint64_t number,
                                                      std::uint64_t expected,
                                                      layout::IndexNode& scratch) const = 0;

  /// Starts reading those of the nodes `numbers` of a level that were not read before. `numbers`
  /// ascend. A hint: never fails.
  void announce(std::uint32_t level, std::span<const std::uint64_t> numbers,
                IoCounters& counters) const noexcept {
    RangesToCome ranges(file_, counters);
    add_ranges(level, numbers, ranges);
  }
  /// Adds their ranges to those that are announced together. Ranges that lie near each other are
  /// joined.
  void add_ranges(std::uint32_t level, std::span<const std::uint64_t> numbers,
                  RangesToCome& ranges) const noexcept;

  /// A copy of the descriptor of a page, verified as node() verifies. Cost: one copy when the leaf of the page was verified before
  /// (mapped) or is in the cache (pread), otherwise the path from the root.
  /// @throws Error corruption (also: no such page), io_error
  [[nodiscard]] virtual layout::NodeEntry descriptor(PageId page) const = 0;

  /// @throws Error corruption  when a mapping lost its file while it was read
  virtual void require_undamaged() const {}

  /// ReadableFile::is_far(), is_at_hand() of a node, and settle().
  [[nodiscard]] bool is_far() const noexcept { return file_.is_far(); }
  [[nodiscard]] bool is_at_hand(std::uint32_t level, std::uint64_t number) const noexcept {
    const std::uint64_t position = place_.shape.position(level, number);
    return is_known(position) || file_.is_at_hand({offset_of(position), layout::kNodeBytes});
  }
  void settle(IoCounters& counters) const noexcept { file_.settle(counters); }

 protected:
  IndexNodes(const ReadableFile& file, const Root& place, const HeightEncoding& heights)
      : file_(file), place_(place), heights_(heights) {}
  void require_page(PageId page) const;
  /// Whether the node at a position was verified, and is known without reading.
  [[nodiscard]] virtual bool is_known(std::uint64_t position) const noexcept = 0;
  [[nodiscard]] std::uint64_t offset_of(std::uint64_t position) const noexcept {
    return place_.offset + position * layout::kNodeBytes;
  }
  /// Compares the checksum of a node with `expected`, and the level, number and entries that it
  /// names with its place, and looks whether its entries are possible (is_sound()).
  /// @throws Error corruption
  void verify(const layout::IndexNode& node, std::uint32_t level, std::uint64_t number,
              std::uint64_t expected) const;
  /// The entry of a page in its leaf, found from the root down.
  [[nodiscard]] layout::NodeEntry descend_to(PageId page) const;

  const ReadableFile& file_;
  Root place_;
  HeightEncoding heights_;
};

/// Nodes are read in place, in the mapping. A node is verified when it is first touched.
class MappedIndexNodes final : public IndexNodes {
 public:
  MappedIndexNodes(const ReadableFile& file, const MappedFile& mapping, const Root& place,
                   const HeightEncoding& heights);
  [[nodiscard]] const layout::IndexNode& node(std::uint32_t level, std::uint64_t number,
                                              std::uint64_t expected,
                                              layout::IndexNode& scratch) const override;
  [[nodiscard]] layout::NodeEntry descriptor(PageId page) const override;
  void require_undamaged() const override { mapping_.require_undamaged(); }

 protected:
  [[nodiscard]] bool is_known(std::uint64_t position) const noexcept override {
    return verified_.test(position);
  }

 private:
  const MappedFile& mapping_;
  TouchBits verified_;
};

/// Nodes are read by pread. Verified ones are kept in a cache of at most 4 MiB.
class PreadIndexNodes final : public IndexNodes {
 public:
  PreadIndexNodes(const ReadableFile& file, const Root& place, const HeightEncoding& heights);
  [[nodiscard]] const layout::IndexNode& node(std::uint32_t level, std::uint64_t number,
                                              std::uint64_t expected,
                                              layout::IndexNode& scratch) const override;
  [[nodiscard]] layout::NodeEntry descriptor(PageId page) const override;

 protected:
  [[nodiscard]] bool is_known(std::uint64_t position) const noexcept override;

 private:
  /// A place of the cache. A node can be in one slot alone: its position modulo kSlots. The lock is
  /// held while a node is copied, never while it is read from the disk.
  struct Slot {
    std::mutex lock;
    std::uint64_t position = UINT64_MAX;
    std::unique_ptr<layout::IndexNode> node;
  };
  static constexpr std::size_t kSlots = 1024;
  [[nodiscard]] Slot& slot_of(std::uint64_t position) const noexcept {
    return slots_[position % kSlots];
  }

  mutable std::vector<Slot> slots_{kSlots};
};

}  // namespace ptin
