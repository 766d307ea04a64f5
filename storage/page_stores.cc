// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/page_stores.h"

#include <cstring>

#include "engine/check.h"
#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/file/range_joiner.h"

namespace ptin {

void DescribedPageStore::announce(std::span<const PageId> ids,
                                  IoCounters& counters) const noexcept {
  RangesToCome ranges(file_, counters);
  add_ranges(ids, ranges);
}

void DescribedPageStore::add_ranges(std::span<const PageId> ids,
                                    RangesToCome& ranges) const noexcept {
  RangeJoiner joiner(slots_.offset, slots_.page_bytes, ranges);
  for (const PageId id : ids) {
    if (index_of(id) < slots_.pages) {
      joiner.add(slots_.slot_of(id));
    }
  }
}

void DescribedPageStore::read(PageId id, std::span<std::byte> out, IoCounters& counters) const {
  PTIN_CHECK(out.size() == slots_.page_bytes);
  read_described(id, nodes_.descriptor(id), out, counters);
}

void DescribedPageStore::read_checked(PageId id, std::uint32_t checksum, std::span<std::byte> out,
                                      IoCounters& counters) const {
  file_.read_at(out, slots_.offset_of(id));
  ++counters.pages;
  counters.bytes_read += out.size();
  if (static_cast<std::uint32_t>(checksum_of(out)) != checksum) {
    throw Error(ErrorCode::corruption,
                "the page does not match the checksum in the directory; the file is damaged, "
                "`ptin verify` tells where",
                file_.path() + ", page " + std::to_string(index_of(id)));
  }
  ++counters.pages_verified;
  file_.settle(counters);
}

void DescribedPageStore::verify(PageId id, const layout::NodeEntry& descriptor,
                                std::span<const std::byte> copy) const {
  if (checksum_of(copy) != descriptor.checksum) {
    throw Error(ErrorCode::corruption,
                "the page does not match the checksum in its descriptor; the file is damaged, "
                "`ptin verify` tells where",
                file_.path() + ", page " + std::to_string(index_of(id)));
  }
}

void MappedPageStore::read_described(PageId id, const layout::NodeEntry& descriptor,
                                     std::span<std::byte> out, IoCounters& counters) const {
  std::memcpy(out.data(), mapping_.at(slots_.offset_of(id)), out.size());
  // After the copy: if the copy met lost bytes, it is not what the file held, whether the page was
  // verified before or not.
  mapping_.require_undamaged();
  ++counters.pages;
  counters.bytes_read += out.size();
  if (!verified_.test(index_of(id))) {
    verify(id, descriptor, out);
    verified_.set(index_of(id));
    ++counters.pages_verified;
  }
}

std::span<const std::byte> MappedPageStore::view_described(PageId id,
                                                           const layout::NodeEntry& descriptor,
                                                           std::span<std::byte> buffer,
                                                           IoCounters& counters) const {
  if (!verified_.test(index_of(id))) {
    read_described(id, descriptor, buffer, counters);
    return buffer;
  }
  ++counters.pages;
  counters.bytes_read += buffer.size();
  return {mapping_.at(slots_.offset_of(id)), buffer.size()};
}

void MappedPageStore::check_unchanged() const {
  mapping_.require_undamaged();
  file_.check_unchanged();
}

void PreadPageStore::read_described(PageId id, const layout::NodeEntry& descriptor,
                                    std::span<std::byte> out, IoCounters& counters) const {
  file_.read_at(out, slots_.offset_of(id));
  ++counters.pages;
  counters.bytes_read += out.size();
  verify(id, descriptor, out);
  ++counters.pages_verified;
  file_.settle(counters);
}

}  // namespace ptin
