// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/long_text.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/error.h"
#include "engine/stop.h"
#include "tools/formats/number_text.h"

namespace ptin::ask {

namespace {

constexpr std::size_t kFirstBytes = 4096;
constexpr std::size_t kLookBytes = 64 * 1024;  ///< Between two looks at the stop token.

}  // namespace

void append_json_number(std::string& text, double value) {
  if (std::isfinite(value)) {
    tools::append_number(text, value);
  } else {
    text += "null";
  }
}

void LongText::make_room(std::size_t bytes) {
  const std::size_t needed = text_.size() + bytes;
  if (needed > most_bytes_) {
    throw Error(ErrorCode::resource_exhausted, "the text of the answer takes more than its memory");
  }
  if (needed > text_.capacity()) {
    text_.reserve(std::min(most_bytes_, std::max({needed, 2 * text_.capacity(), kFirstBytes})));
  }
  if (needed < next_look_) return;
  stop_if_asked(stop_, "the answer");
  next_look_ = needed + kLookBytes;
}

LongText& LongText::add(std::string_view text) {
  make_room(text.size());
  text_ += text;
  return *this;
}

LongText& LongText::number(double value) {
  constexpr std::size_t kMostDigits = 32;
  make_room(kMostDigits);
  // An exact answer has its height as both of its bounds, and to find digits is what takes time.
  const auto bits = std::bit_cast<std::uint64_t>(value);
  if (last_bytes_ != 0 && bits == last_bits_) {
    text_.append(text_, last_at_, last_bytes_);
    return *this;
  }
  last_bits_ = bits;
  last_at_ = text_.size();
  append_json_number(text_, value);
  last_bytes_ = text_.size() - last_at_;
  return *this;
}

LongText& LongText::json(const Json& value) {
  if (value.is_number_float()) return number(value.get<double>());
  return add(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace ptin::ask
