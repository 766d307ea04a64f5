// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/uring_announcer.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include <fcntl.h>

#include "engine/error.h"

#ifdef PTIN_LIBURING
#include <liburing.h>
#endif

namespace ptin::tools {

#ifdef PTIN_LIBURING

namespace {

constexpr unsigned kRingDepth = 64;
constexpr std::uint64_t kRingReadBytes = std::uint64_t{128} << 10;

}  // namespace

/// The ring, and where its reads put what nobody looks at: the page cache has it then.
class UringAnnouncer::Ring {
 public:
  /// @throws Error io_error
  Ring() : buffer_(kRingDepth * kRingReadBytes) {
    if (const int result = ::io_uring_queue_init(kRingDepth, &ring_, 0); result < 0)
      throw system_error(-result, "the kernel refuses io_uring", "io_uring_setup");
    for (unsigned i = 0; i < kRingDepth; ++i) idle_.push_back(i);
  }
  Ring(const Ring&) = delete;
  Ring& operator=(const Ring&) = delete;
  ~Ring() {
    while (under_way_ > 0 && take_arrived(true)) {
    }
    ::io_uring_queue_exit(&ring_);
  }

  void read(int descriptor, std::uint64_t offset, std::uint64_t bytes) noexcept {
    const std::lock_guard turn(lock_);
    while (take_arrived(false)) {
    }
    for (std::uint64_t at = 0; at < bytes; at += kRingReadBytes) {
      if (idle_.empty()) submit();
      if (idle_.empty() && !take_arrived(true)) return;
      io_uring_sqe* const entry = ::io_uring_get_sqe(&ring_);
      if (entry == nullptr) break;
      const unsigned place = idle_.back();
      idle_.pop_back();
      ::io_uring_prep_read(entry, descriptor, buffer_.data() + place * kRingReadBytes,
                           static_cast<unsigned>(std::min(kRingReadBytes, bytes - at)),
                           offset + at);
      ::io_uring_sqe_set_data64(entry, place);
    }
    submit();
  }

 private:
  void submit() noexcept {
    const int submitted = ::io_uring_submit(&ring_);
    if (submitted > 0) under_way_ += submitted;
  }
  /// Takes a read that has arrived; with `waits` on, waits for one. What it read, or why it failed,
  /// is of no interest: the store reads all of it again. False when there is none.
  bool take_arrived(bool waits) noexcept {
    if (under_way_ == 0) return false;
    io_uring_cqe* arrived = nullptr;
    int result = 0;
    do {
      result =
          waits ? ::io_uring_wait_cqe(&ring_, &arrived) : ::io_uring_peek_cqe(&ring_, &arrived);
    } while (result == -EINTR);
    if (result != 0) return false;
    idle_.push_back(static_cast<unsigned>(::io_uring_cqe_get_data64(arrived)));
    ::io_uring_cqe_seen(&ring_, arrived);
    --under_way_;
    return true;
  }

  std::mutex lock_;
  io_uring ring_{};
  std::vector<std::byte> buffer_;
  std::vector<unsigned> idle_;  ///< Parts of the buffer that no read has; never grows.
  int under_way_ = 0;
};

std::string why_no_uring() {
  try {
    const UringAnnouncer announcer;
    return {};
  } catch (const Error& e) {
    return e.message();
  }
}

UringAnnouncer::UringAnnouncer() : ring_(std::make_unique<Ring>()) {}

void UringAnnouncer::announce(int descriptor, std::uint64_t offset, std::uint64_t bytes) noexcept {
  // All reads are known: read-ahead of the kernel's own would read more than was announced.
  ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_RANDOM);
  ring_->read(descriptor, offset, bytes);
}

#else

class UringAnnouncer::Ring {};

std::string why_no_uring() { return "the program was built without liburing"; }

UringAnnouncer::UringAnnouncer() { throw Error(ErrorCode::io_error, why_no_uring(), "io_uring"); }

void UringAnnouncer::announce(int, std::uint64_t, std::uint64_t) noexcept {}

#endif

UringAnnouncer::~UringAnnouncer() = default;

}  // namespace ptin::tools
