// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/support/uring_pages.h"

#include <cerrno>
#include <fstream>
#include <vector>

#include "engine/error.h"
#include "storage/file/read_only_file.h"
#include "storage/layout.h"
#include "storage/store_file.h"

#ifdef PTIN_BENCH_URING
#include <fcntl.h>
#include <liburing.h>
#endif

namespace ptin::bench {

PageSlots page_slots_of(const std::string& store) {
  const auto open = StoreFile::open(store);
  layout::FileHeader header{};
  ReadOnlyFile(store).read_at(std::as_writable_bytes(std::span(&header, 1)), 0);
  PageSlots slots;
  slots.pages = header.page_count;
  slots.first_page = header.first_page;
  slots.page_bytes = header.page_bytes;
  for (const SectionInfo& s : open->sections()) {
    if (s.name == "pages") slots.offset = s.offset;
  }
  return slots;
}

#ifdef PTIN_BENCH_URING

namespace {

/// An io_uring that is closed when the object goes.
class Ring {
 public:
  explicit Ring(unsigned depth) {
    if (const int result = ::io_uring_queue_init(depth, &ring_, 0); result < 0)
      throw system_error(-result, "cannot make", "io_uring");
  }
  ~Ring() { ::io_uring_queue_exit(&ring_); }
  Ring(const Ring&) = delete;
  Ring& operator=(const Ring&) = delete;
  io_uring* get() { return &ring_; }

 private:
  io_uring ring_{};
};

}  // namespace

bool has_uring() noexcept { return true; }

void read_with_uring(const std::string& store, const PageSlots& slots,
                     std::span<const PageId> pages,
                     const std::function<void(PageId, std::span<const std::byte>)>& seen) {
  constexpr unsigned depth = kUringDepth;
  const ReadOnlyFile file(store);
  ::posix_fadvise(file.descriptor(), 0, 0,
                  POSIX_FADV_RANDOM);  // no read-ahead: all reads are known
  Ring ring(depth);
  std::vector<std::byte> buffer(std::size_t{depth} * slots.page_bytes);
  std::vector<PageId> reading(depth);
  std::vector<std::size_t> idle;
  for (std::size_t i = depth; i-- > 0;) idle.push_back(i);
  std::size_t next = 0, done = 0;
  while (done < pages.size()) {
    for (; next < pages.size() && !idle.empty(); ++next, idle.pop_back()) {
      const std::size_t place = idle.back();
      reading[place] = pages[next];
      io_uring_sqe* entry = ::io_uring_get_sqe(ring.get());
      ::io_uring_prep_read(entry, file.descriptor(), buffer.data() + place * slots.page_bytes,
                           slots.page_bytes, slots.offset_of(pages[next]));
      ::io_uring_sqe_set_data64(entry, place);
    }
    ::io_uring_submit_and_wait(ring.get(), 1);
    io_uring_cqe* arrived = nullptr;
    while (::io_uring_peek_cqe(ring.get(), &arrived) == 0) {
      const std::size_t place = ::io_uring_cqe_get_data64(arrived);
      if (arrived->res != static_cast<int>(slots.page_bytes))
        throw system_error(arrived->res < 0 ? -arrived->res : EIO, "cannot read", store);
      seen(reading[place], {buffer.data() + place * slots.page_bytes, slots.page_bytes});
      ::io_uring_cqe_seen(ring.get(), arrived);
      idle.push_back(place);
      ++done;
    }
  }
}

#else

bool has_uring() noexcept { return false; }

void read_with_uring(const std::string& store, const PageSlots&, std::span<const PageId>,
                     const std::function<void(PageId, std::span<const std::byte>)>&) {
  throw Error(ErrorCode::io_error, "built without liburing", store);
}

#endif

}  // namespace ptin::bench
