// SPDX-License-Identifier: GPL-3.0-or-later
//
// The way back from a thread that computes to the one of connections.
#pragma once

#include <chrono>
#include <new>
#include <thread>

#include <boost/asio/post.hpp>

namespace ptin::http {

/// Calls `then` on the thread of connections. An answer is not lost where the system gives no memory
/// at this moment: others that end give some back.
template <class Executor, class Then>
void deliver(const Executor& executor, const Then& then) {
  while (true) {
    try {
      boost::asio::post(executor, then);
      return;
    } catch (const std::bad_alloc&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
}

}  // namespace ptin::http
