// SPDX-License-Identifier: GPL-3.0-or-later
//
// The two page stores of this room: mapped and pread.
#pragma once

#include <cstdint>
#include <span>

#include "storage/file/mapped_file.h"
#include "storage/file/range_joiner.h"
#include "storage/file/readable_file.h"
#include "storage/index_nodes.h"
#include "storage/page_slots.h"
#include "storage/page_store.h"
#include "storage/touch_bits.h"

namespace ptin {

/// What both page stores have in common: where a page lies, and the index with the descriptor that
/// holds its checksum.
class DescribedPageStore : public PageStore {
 public:
  [[nodiscard]] std::uint64_t page_count() const noexcept final { return slots_.pages; }
  [[nodiscard]] std::size_t page_bytes() const noexcept final { return slots_.page_bytes; }
  [[nodiscard]] bool is_far() const noexcept final { return file_.is_far(); }
  void announce(std::span<const PageId> ids, IoCounters& counters) const noexcept final;
  /// Adds the ranges of pages, which ascend, to those that are announced together.
  void add_ranges(std::span<const PageId> ids, RangesToCome& ranges) const noexcept;
  void read(PageId id, std::span<std::byte> out, IoCounters& counters) const final;

  /// As read(), for a caller that has the page's descriptor. REQUIRES: id < page_count(),
  /// out.size() == page_bytes().
  virtual void read_described(PageId id, const layout::NodeEntry& descriptor,
                              std::span<std::byte> out, IoCounters& counters) const = 0;
  /// As read(), for a caller that has the lower half of the page's checksum. REQUIRES: as above.
  void read_checked(PageId id, std::uint32_t checksum, std::span<std::byte> out,
                    IoCounters& counters) const;
  /// As read_described(), but makes no copy of a page that is mapped and was verified before. The
  /// file may lose its bytes while they are looked at: so the caller calls require_undamaged()
  /// after the last look, and before it uses anything made of them.
  /// @return `buffer`, or the bytes in the mapping.
  [[nodiscard]] virtual std::span<const std::byte> view_described(
      PageId id, const layout::NodeEntry& descriptor, std::span<std::byte> buffer,
      IoCounters& counters) const {
    read_described(id, descriptor, buffer, counters);
    return buffer;
  }
  /// @throws Error corruption  bytes that view_described() returned may not be those of the file
  virtual void require_undamaged() const {}

  /// ReadableFile::is_at_hand(), of a page.
  [[nodiscard]] bool is_at_hand(PageId id) const noexcept {
    return index_of(id) >= slots_.pages ||
           file_.is_at_hand({slots_.offset_of(id), slots_.page_bytes});
  }

 protected:
  DescribedPageStore(const ReadableFile& file, const PageSlots& slots, const IndexNodes& nodes)
      : file_(file), slots_(slots), nodes_(nodes) {}
  /// @throws Error corruption
  void verify(PageId id, const layout::NodeEntry& descriptor,
              std::span<const std::byte> copy) const;

  const ReadableFile& file_;
  PageSlots slots_;
  const IndexNodes& nodes_;
};

/// Reads pages from a mapping. The checksum of a page is compared at the first touch, over a copy;
/// from then on the page is trusted as long as the file is unchanged.
class MappedPageStore final : public DescribedPageStore {
 public:
  MappedPageStore(const ReadableFile& file, const MappedFile& mapping, const PageSlots& slots,
                  const IndexNodes& nodes)
      : DescribedPageStore(file, slots, nodes), mapping_(mapping), verified_(slots.pages) {}
  void read_described(PageId id, const layout::NodeEntry& descriptor, std::span<std::byte> out,
                      IoCounters& counters) const override;
  [[nodiscard]] std::span<const std::byte> view_described(PageId id,
                                                          const layout::NodeEntry& descriptor,
                                                          std::span<std::byte> buffer,
                                                          IoCounters& counters) const override;
  void require_undamaged() const override { mapping_.require_undamaged(); }
  void check_unchanged() const override;

 private:
  const MappedFile& mapping_;
  TouchBits verified_;
};

/// Reads with pread; compares the checksum of every read.
class PreadPageStore final : public DescribedPageStore {
 public:
  PreadPageStore(const ReadableFile& file, const PageSlots& slots, const IndexNodes& nodes)
      : DescribedPageStore(file, slots, nodes) {}
  void read_described(PageId id, const layout::NodeEntry& descriptor, std::span<std::byte> out,
                      IoCounters& counters) const override;
  void check_unchanged() const override { file_.check_unchanged(); }
};

}  // namespace ptin
