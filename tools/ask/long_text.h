// SPDX-License-Identifier: GPL-3.0-or-later
//
// The text of an answer that may be long, written piece by piece within a limit of memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

namespace ptin::ask {

using Json = nlohmann::ordered_json;

/// Every piece looks whether a stop was asked for.
class LongText {
 public:
  explicit LongText(std::size_t most_bytes = std::numeric_limits<std::size_t>::max(),
                    std::stop_token stop = {})
      : most_bytes_(most_bytes), stop_(std::move(stop)) {}

  // All throw Error resource_exhausted beyond the memory, and cancelled.
  LongText& add(std::string_view text);
  /// As few digits as read back to the same double; null where it is not finite.
  LongText& number(double value);
  LongText& json(const Json& value);

  [[nodiscard]] std::string take() {
    last_bytes_ = 0;
    return std::move(text_);
  }

 private:
  void make_room(std::size_t bytes);

  std::string text_;
  std::size_t most_bytes_;
  std::size_t next_look_ = 0;  ///< At so many bytes the stop token is asked again.
  std::stop_token stop_;
  // The last number and its digits in the text; often the next is the same. 0 bytes: none.
  std::uint64_t last_bits_ = 0;
  std::size_t last_at_ = 0, last_bytes_ = 0;
};

/// A number as few digits as read back to the same double; null where it is not finite.
void append_json_number(std::string& text, double value);

}  // namespace ptin::ask
