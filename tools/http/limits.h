// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a server takes of its clients before it answers them with a refusal.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace ptin::http {

/// Every one is told to a client that goes beyond it, under its name here.
struct Limits {
  std::size_t request_line_bytes = std::size_t{32} << 10;  ///< Beyond: 414.
  std::size_t header_bytes = std::size_t{8} << 10;         ///< Of all header lines. Beyond: 431.
  std::size_t body_bytes = std::size_t{1} << 20;           ///< Beyond: 413.
  std::size_t connections = 1024;                          ///< Beyond: 503.
  std::size_t waiting = 64;  ///< Requests that wait for a thread. Beyond: 503.
  std::size_t threads = 1;   ///< Requests that are computed at once.
  std::uint64_t memory_bytes = std::uint64_t{192} << 20;  ///< Of all questions. Beyond: 503.

  // Absolute: no byte that arrives makes them longer.
  std::chrono::milliseconds reading{5000};     ///< The head, and again the body. Beyond: 408.
  std::chrono::milliseconds computing{10000};  ///< From the end of the request on. Beyond: 503.
  std::chrono::milliseconds writing{10000};    ///< Of each 64 KiB. Beyond: the connection closes.
  /// A client takes an answer that memory is held for at this rate at least, beside `writing`.
  std::uint64_t least_bytes_a_second = std::uint64_t{32} << 10;
  std::chrono::milliseconds idle{15000};  ///< Between two requests.
};

}  // namespace ptin::http
