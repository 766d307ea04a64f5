// SPDX-License-Identifier: GPL-3.0-or-later
//
// Answers that were given, by their tags: whoever asks the same question of the same file gets the
// same bytes.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tools/http/memory_budget.h"
#include "tools/http/response.h"

namespace ptin::serve {

/// The answers that were asked for last, up to a number of bytes. Threads: any.
class AnswerCache {
 public:
  /// @param most_bytes  Of what is kept. Answers that left it and are still being sent take as much
  ///                    again at most: beyond that nothing is kept.
  explicit AnswerCache(std::uint64_t most_bytes)
      : most_bytes_(most_bytes), room_(std::make_shared<http::MemoryBudget>(2 * most_bytes)) {}

  /// The answer under a key, which shares its bytes; none: it is not kept.
  [[nodiscard]] std::optional<http::Response> find(const std::string& key);
  /// Keeps an answer, unless it takes more than a sixteenth of the room, or there is none left. The
  /// answer shares its bytes with the cache from then on.
  void keep(const std::string& key, http::Response& response);
  /// The bytes of what is kept, heads included.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  /// Bytes, and the room that they take while anybody has them.
  struct Body {
    std::string text;
    std::shared_ptr<http::MemoryBudget::Lease> room;
  };
  struct Kept {
    std::string key;
    std::string content_type;
    std::vector<std::pair<std::string, std::string>> headers;
    std::shared_ptr<Body> body;
    std::uint64_t bytes = 0;
  };
  static http::Response shared(const Kept& kept);

  const std::uint64_t most_bytes_;
  std::shared_ptr<http::MemoryBudget> room_;
  mutable std::mutex mutex_;
  std::list<Kept> kept_;  ///< What was asked for last stands first.
  std::unordered_map<std::string_view, std::list<Kept>::iterator> places_;
  std::uint64_t bytes_ = 0;
};

}  // namespace ptin::serve
