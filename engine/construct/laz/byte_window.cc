// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/laz/byte_window.h"

#include <algorithm>

namespace ptin::laz {

namespace {

constexpr std::uint64_t kWindowBytes = std::uint64_t{1} << 15;

}  // namespace

void ByteWindow::fill() {
  const std::uint64_t bytes = std::min(end_ - next_, kWindowBytes);
  if (bytes == 0) {
    throw DamagedBytes{"it ends before its points do"};
  }
  buffer_.resize(bytes);
  source_->read(next_, buffer_);
  next_ += bytes;
  at_ = buffer_.data();
  filled_ = at_ + bytes;
}

}  // namespace ptin::laz
