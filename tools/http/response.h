// SPDX-License-Identifier: GPL-3.0-or-later
//
// An answer before it is written.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ptin::http {

/// Bytes that are read while they are written: a part of a file that need not fit into memory.
struct LongBody {
  std::uint64_t bytes = 0;
  /// Called on a thread that may wait for a disk. Fills `into` with the bytes from `offset` on. An exception closes the connection, so that a
  /// client sees that something is missing.
  std::function<void(std::uint64_t offset, std::span<char> into)> read;
};

struct Response {
  unsigned status = 200;
  std::string content_type;  ///< Empty: there is no body.
  /// Further ones. A value holds no line break: nothing of a request is put into it as it came.
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;
  /// Bytes that outlive the server, sent instead of `body` where there are any.
  std::string_view lasting_body;
  std::shared_ptr<LongBody> long_body;  ///< Sent instead of both where it is not null.
  /// Is let go once the last byte is written: the memory that was reserved for the answer.
  std::shared_ptr<void> held;

  void add(std::string name, std::string value) {
    headers.emplace_back(std::move(name), std::move(value));
  }
  [[nodiscard]] std::uint64_t body_bytes() const noexcept {
    if (long_body) return long_body->bytes;
    return lasting_body.empty() ? body.size() : lasting_body.size();
  }
};

}  // namespace ptin::http
