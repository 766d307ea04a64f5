// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a server takes of its clients before it answers them with a refusal.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/http/client_address.h"

namespace ptin::http {

/// Every one is named to a client that goes beyond it, under its name here.
struct Limits {
  std::size_t request_line_bytes = std::size_t{32} << 10;  ///< Beyond: 414.
  std::size_t header_bytes = std::size_t{8} << 10;         ///< All header lines. Beyond: 431.
  std::size_t body_bytes = std::size_t{1} << 20;           ///< Beyond: 413.
  /// Beyond, the longest idle one closes; where none is idle: 503. A client may have three quarters
  /// of them, and of the last quarter those that have less than an eighth of all, or none.
  std::size_t connections = 1024;
  std::size_t waiting = 64;  ///< Questions that wait in each lane. Beyond: 503.
  std::size_t threads = 1;   ///< Questions of each lane that are computed at once.
  /// Memory of bodies, questions and answers, which wait where there is none at the moment.
  std::uint64_t memory_bytes = std::uint64_t{192} << 20;
  /// Of the memory, what is lent to nobody, since the allocator keeps as much of what was freed.
  std::uint64_t kept_bytes = 0;
  /// Bytes that one question of the lane of points takes at most, and one of any lane: for so much of the
  /// memory there is always room beside answers that clients take slowly.
  std::uint64_t point_bytes = 0, question_bytes = 0;

  // Absolute: no byte that arrives makes them longer.
  std::chrono::milliseconds reading{5000};     ///< The head, and again the body. Beyond: 408.
  std::chrono::milliseconds queueing{10000};   ///< Until a question's turn comes. Beyond: 503.
  std::chrono::milliseconds computing{10000};  ///< From its turn on. Beyond: 503.
  std::chrono::milliseconds writing{10000};    ///< For each 64 KiB. Beyond: the connection closes.
  /// A client takes an answer that memory is held for at this rate at least, beside `writing`.
  std::uint64_t least_bytes_a_second = std::uint64_t{32} << 10;
  std::chrono::milliseconds idle{15000};  ///< Between two requests.
  /// How long a server that ends still listens, so that whoever sends clients to it learns of it.
  std::chrono::milliseconds draining{0};

  /// Proxies that are believed what they say of their clients.
  std::vector<Network> trusted_proxies;
};

}  // namespace ptin::http
