// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/laz/attributes.h"

#include <algorithm>

#include "engine/construct/laz/las_value.h"

namespace ptin::laz {

namespace {

// Symbols of GpsTimes, where the last step of a sequence was not 0: its multiples from 0 to 500, those
// from -1 to -10 as 501 to 510, and what follows.
constexpr std::uint32_t kMostMultiple = 500, kLeastMultiple = 510;
constexpr std::uint32_t kSameTime = 511, kNewSequence = 512;

/// A writer changes to another sequence at most once for a point.
constexpr int kMostChanges = 4;

/// So many steps that are no multiples make the last of them the step of their sequence.
constexpr std::uint32_t kMostOddSteps = 3;

std::int32_t times(std::int32_t factor, std::int32_t step) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(factor) *
                                   static_cast<std::uint32_t>(step));
}

}  // namespace

void GpsTimes::begin(std::span<const unsigned char> first) noexcept {
  sequences_.fill({});
  sequences_[0].time = las_value<std::uint64_t>(first, 0);
  now_ = newest_ = 0;
  multiples_.begin();
  kinds_.begin();
  steps_.begin();
}

void GpsTimes::pass(ArithmeticDecoder& decoder) {
  for (int changes = 0; changes < kMostChanges; ++changes) {
    if (sequences_[now_].step == 0 ? pass_after_no_step(decoder) : pass_after_step(decoder)) {
      return;
    }
  }
  throw DamagedBytes{"its times are no times"};
}

/// A time far from those of the sequence begins another one, in the place of the oldest.
void GpsTimes::begin_sequence(ArithmeticDecoder& decoder) {
  const std::uint64_t before = sequences_[now_].time;
  const auto high =
      static_cast<std::uint32_t>(steps_.read(decoder, static_cast<std::int32_t>(before >> 32), 8));
  now_ = newest_ = (newest_ + 1) % 4;
  sequences_[now_] = {std::uint64_t{high} << 32 | decoder.bits(32), 0, 0};
}

/// @return  False: the sequence changes, and the time is still to come.
bool GpsTimes::pass_after_no_step(ArithmeticDecoder& decoder) {
  Sequence& s = sequences_[now_];
  const std::uint32_t kind = decoder.symbol(kinds_);
  switch (kind) {
    case 0:
      return true;
    case 1:
      s.step = steps_.read(decoder, 0, 0);
      s.time += static_cast<std::uint64_t>(std::int64_t{s.step});
      s.odd_steps = 0;
      return true;
    case 2:
      begin_sequence(decoder);
      return true;
    default:
      now_ = (now_ + kind - 2) % 4;
      return false;
  }
}

bool GpsTimes::pass_after_step(ArithmeticDecoder& decoder) {
  Sequence& s = sequences_[now_];
  const std::uint32_t symbol = decoder.symbol(multiples_);
  if (symbol == kSameTime) {
    return true;
  }
  if (symbol == kNewSequence) {
    begin_sequence(decoder);
    return true;
  }
  if (symbol > kNewSequence) {
    now_ = (now_ + symbol - kNewSequence) % 4;
    return false;
  }
  const auto multiple = static_cast<std::int32_t>(symbol);
  std::int32_t step = 0;
  if (symbol == 0) {
    step = steps_.read(decoder, 0, 7);
    take_odd(s, step);
  } else if (symbol == 1) {
    step = steps_.read(decoder, s.step, 1);
    s.odd_steps = 0;
  } else if (symbol < kMostMultiple) {
    step = steps_.read(decoder, times(multiple, s.step), symbol < 10 ? 2 : 3);
  } else if (symbol == kMostMultiple) {
    step = steps_.read(decoder, times(multiple, s.step), 4);
    take_odd(s, step);
  } else if (symbol < kLeastMultiple) {
    step = steps_.read(decoder, times(500 - multiple, s.step), 5);
  } else {
    step = steps_.read(decoder, times(500 - multiple, s.step), 6);
    take_odd(s, step);
  }
  s.time += static_cast<std::uint64_t>(std::int64_t{step});
  return true;
}

void GpsTimes::take_odd(Sequence& s, std::int32_t step) noexcept {
  if (++s.odd_steps > kMostOddSteps) {
    s.step = step;
    s.odd_steps = 0;
  }
}

void Colours::begin(std::span<const unsigned char> first) noexcept {
  std::copy_n(first.begin(), kBytes, last_.begin());
  changes_.begin();
  for (auto& model : corrections_) {
    model.begin();
  }
}

int Colours::changed(ArithmeticDecoder& decoder, std::uint32_t byte, int predicted) {
  const int sum =
      std::clamp(predicted, 0, 255) + static_cast<int>(decoder.symbol(corrections_[byte]));
  return sum & 0xff;
}

void Colours::pass(ArithmeticDecoder& decoder) {
  const std::uint32_t changes = decoder.symbol(changes_);
  const auto is_changed = [&](std::uint32_t byte) { return (changes >> byte & 1) != 0; };
  std::array<int, 6> now = last_;
  for (const std::uint32_t red : {0U, 1U}) {
    if (is_changed(red)) {
      now[red] = changed(decoder, red, last_[red]);
    }
  }
  if ((changes & 0x40) == 0) {  // grey
    last_ = {now[0], now[1], now[0], now[1], now[0], now[1]};
    return;
  }
  for (const std::uint32_t red : {0U, 1U}) {
    const std::uint32_t green = red + 2, blue = red + 4;
    const int of_red = now[red] - last_[red];
    if (is_changed(green)) {
      now[green] = changed(decoder, green, last_[green] + of_red);
    }
    if (is_changed(blue)) {
      const int of_both = (of_red + now[green] - last_[green]) / 2;
      now[blue] = changed(decoder, blue, last_[blue] + of_both);
    }
  }
  last_ = now;
}

void WavePackets::begin(std::span<const unsigned char> first) noexcept {
  bytes_ = las_value<std::int32_t>(first, 9);
  place_ = las_value<std::int32_t>(first, 13);
  for (std::size_t i = 0; i < 3; ++i) {
    direction_[i] = las_value<std::int32_t>(first, 17 + 4 * i);
  }
  offset_step_ = 0;
  kind_ = 0;
  descriptors_.begin();
  for (auto& model : kinds_) {
    model.begin();
  }
  offsets_.begin();
  sizes_.begin();
  places_.begin();
  directions_.begin();
}

void WavePackets::pass(ArithmeticDecoder& decoder) {
  static_cast<void>(decoder.symbol(descriptors_));
  kind_ = decoder.symbol(kinds_[kind_]);
  if (kind_ == 2) {  // the offset, by its step
    offset_step_ = offsets_.read(decoder, offset_step_);
  } else if (kind_ == 3) {  // the offset itself
    static_cast<void>(decoder.bits(32));
    static_cast<void>(decoder.bits(32));
  }
  bytes_ = sizes_.read(decoder, bytes_);
  place_ = places_.read(decoder, place_);
  for (std::uint32_t i = 0; i < 3; ++i) {
    direction_[i] = directions_.read(decoder, direction_[i], i);
  }
}

void ExtraBytes::begin(std::span<const unsigned char> first) noexcept {
  std::copy_n(first.begin(), bytes_.size(), bytes_.begin());
  for (auto& model : corrections_) {
    model.begin();
  }
}

void ExtraBytes::pass(ArithmeticDecoder& decoder) {
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    bytes_[i] = static_cast<unsigned char>(bytes_[i] + decoder.symbol(corrections_[i]));
  }
}

}  // namespace ptin::laz
