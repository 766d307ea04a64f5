// SPDX-License-Identifier: GPL-3.0-or-later
//
// An object on a web server or in a store of objects, by HTTP.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "engine/remote/http_transfer.h"
#include "storage/file/range_source.h"

namespace ptin {

/// The URL of an object.
struct ObjectUrl {
  /// The one to ask now; `anew`: the last one was refused.  @throws Error
  std::function<std::string(bool anew)> get;
  bool is_signed = false;  ///< It ages, and another one may be taken where one was refused.
};

/// Ranges by GET, at most kMostRequests at once, over connections that are kept. The first thread
/// that waits does the work of all, so that rounds of several threads run together without a thread
/// of our own.
class HttpRanges final : public RangeSource {
 public:
  static constexpr std::size_t kMostRequests = 16;
  /// Bytes of the first request: the object's front, which holds the upper levels of the index of a
  /// file of nine million vertices.
  static constexpr std::size_t kFrontBytes = std::size_t{64} << 10;

  /// @param name  For errors.
  /// @throws Error as open_remote
  HttpRanges(std::string name, ObjectUrl url, const RemoteOptions& options);

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept override { return identity_.bytes; }
  [[nodiscard]] std::span<const std::byte> front() const noexcept override { return front_; }
  void read(std::span<const RangeRead> ranges) override;

 private:
  /// The transfers of one call, and how many of them are not done.
  struct Round {
    std::vector<HttpTransfer> transfers;
    std::size_t left = 0;
  };
  struct Waiting {
    HttpTransfer* transfer;
    Round* round;
    bool is_second_url = false;  ///< The first one was refused.
  };
  struct Running {
    CurlHandle handle;
    Waiting work;
  };

  void run(Round& round);
  void drive(std::unique_lock<std::mutex>& lock);
  void start_what_may();
  void start(const Waiting& work);
  void reap();
  void forget(const Round& round);

  std::string name_;
  ObjectUrl url_;
  RemoteOptions options_;
  ObjectIdentity identity_;
  std::vector<std::byte> front_;

  std::mutex mutex_;
  std::condition_variable moved_;
  bool is_driven_ = false;  ///< A thread is within the multi handle, without the lock.
  CurlMulti multi_;
  std::deque<Waiting> waiting_;
  std::vector<Running> running_;
  std::vector<CurlHandle> idle_;
};

}  // namespace ptin
