// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/laz/arithmetic_decoder.h"

namespace ptin::laz {

void ArithmeticDecoder::open(std::uint64_t begin, std::uint64_t end) {
  bytes_.open(begin, end);
  length_ = 0xffffffffU;
  value_ = 0;
  for (int i = 0; i < 4; ++i) {
    value_ = value_ << 8 | bytes_.next();
  }
  if (value_ == length_) {
    throw DamagedBytes{"its bytes are no arithmetic code"};
  }
}

}  // namespace ptin::laz
