// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces of long answers one at a time, so that everything else has its turn between two of them.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <utility>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/post.hpp>

namespace ptin::http {

/// So much of an answer is written in one turn, and under one deadline.
inline constexpr std::size_t kPieceBytes = std::size_t{64} << 10;

/// Who has a piece to write waits here. In each round of the executor one of them writes: a thousand
/// clients that take large answers at once delay a request by a few pieces and not by a thousand.
/// Threads: the executor's one.
class Turns {
 public:
  explicit Turns(boost::asio::any_io_executor executor) : executor_(std::move(executor)) {}
  Turns(const Turns&) = delete;
  Turns& operator=(const Turns&) = delete;

  /// Calls `piece` when those that came before had their turn, and not from within this call. Where
  /// there is no memory to go on at once, the next who waits sets all of them going again.
  void wait(std::function<void()> piece) {
    waiting_.push_back(std::move(piece));
    if (!is_going_) go_on();
  }

 private:
  void go_on() {
    is_going_ = false;
    if (waiting_.empty()) return;
    boost::asio::post(executor_, [this] {
      const std::function<void()> piece = std::move(waiting_.front());
      waiting_.pop_front();
      go_on();  // Before the piece, which may throw.
      piece();
    });
    is_going_ = true;
  }

  boost::asio::any_io_executor executor_;
  std::deque<std::function<void()>> waiting_;
  bool is_going_ = false;
};

}  // namespace ptin::http
