// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/page_stores.h"

#include <cstring>

#include "engine/check.h"
#include "engine/error.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

// Unwanted pages between two wanted ones are read along when they are no more than this: one more
// request to the disk costs as much.
constexpr std::uint64_t kGapBytes = std::uint64_t{32} << 10;
// Yet at most a third of what a run of requests reads is unwanted.
constexpr std::uint64_t kWantedPerWaste = 2;

// Makes ranges of slots from the slots of wanted pages; ranges that lie near each other are joined.
class RangeJoiner {
 public:
  explicit RangeJoiner(std::uint64_t page_bytes) : gap_(kGapBytes / page_bytes) {}

  // True when `slot` was joined to the current range; otherwise the range is complete and `slot`
  // begins the next.
  bool join(std::uint64_t slot) {
    ++wanted_;
    if (begin_ == end_ || slot < end_ || slot - end_ > gap_ ||
        (wasted_ + (slot - end_)) * kWantedPerWaste > wanted_) {
      return false;
    }
    wasted_ += slot - end_;
    end_ = slot + 1;
    return true;
  }
  void restart(std::uint64_t slot) {
    begin_ = slot;
    end_ = slot + 1;
  }
  [[nodiscard]] std::uint64_t begin() const { return begin_; }
  [[nodiscard]] std::uint64_t size() const { return end_ - begin_; }

 private:
  std::uint64_t gap_;
  std::uint64_t begin_ = 0, end_ = 0;
  std::uint64_t wanted_ = 0, wasted_ = 0;
};

}  // namespace

void DescribedPageStore::announce(std::span<const PageId> ids,
                                  IoCounters& counters) const noexcept {
  RangeJoiner range(slots_.page_bytes);
  const auto send = [&] {
    if (range.size() > 0) {
      file_.will_need(slots_.offset + range.begin() * slots_.page_bytes,
                      range.size() * slots_.page_bytes);
      ++counters.ranges_announced;
    }
  };
  for (const PageId id : ids) {
    if (index_of(id) >= slots_.pages) {
      continue;
    }
    const std::uint64_t slot = slots_.slot_of(id);
    if (!range.join(slot)) {
      send();
      range.restart(slot);
    }
  }
  send();
}

void DescribedPageStore::read(PageId id, std::span<std::byte> out, IoCounters& counters) const {
  PTIN_CHECK(out.size() == slots_.page_bytes);
  read_described(id, nodes_.descriptor(id), out, counters);
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
}

}  // namespace ptin
