// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/packed_bucket.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace ptin {

namespace {

/// How a height becomes a key, a number of 64 bits: the whole number that it is, or the bits of its
/// float or double.
enum class HeightKey : std::uint8_t { kWhole, kFloat, kDouble };

/// The key of 0 as a whole number, so that keys of numbers below 0 are smaller.
constexpr std::uint64_t kZero = std::uint64_t{1} << 63;

bool is_whole(double h) {
  constexpr double kMost = 9e15;  // all whole numbers up to there are doubles
  return std::abs(h) <= kMost && h == std::trunc(h) && (h != 0.0 || !std::signbit(h));
}

bool is_float(double h) { return static_cast<double>(static_cast<float>(h)) == h; }

HeightKey key_for(std::span<const GridVertex> points) {
  const auto all = [&](bool (*holds)(double)) {
    return std::all_of(points.begin(), points.end(),
                       [&](const GridVertex& p) { return holds(p.height); });
  };
  return all(is_whole) ? HeightKey::kWhole
                       : (all(is_float) ? HeightKey::kFloat : HeightKey::kDouble);
}

std::uint64_t key_of_height(double h, HeightKey kind) {
  switch (kind) {
    case HeightKey::kWhole:
      return kZero + static_cast<std::uint64_t>(static_cast<std::int64_t>(h));
    case HeightKey::kFloat:
      return std::bit_cast<std::uint32_t>(static_cast<float>(h));
    case HeightKey::kDouble:
      break;
  }
  return std::bit_cast<std::uint64_t>(h);
}

double height_of_key(std::uint64_t key, HeightKey kind) {
  switch (kind) {
    case HeightKey::kWhole:
      return static_cast<double>(static_cast<std::int64_t>(key - kZero));
    case HeightKey::kFloat:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(key)));
    case HeightKey::kDouble:
      break;
  }
  return std::bit_cast<double>(key);
}

/// Bits one after the other, the low ones of a byte first.
class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& to) : to_(to) {}
  /// REQUIRES: `value` has no more than `bits` bits.
  void put(std::uint64_t value, unsigned bits) {
    for (; bits > 32; bits -= 32, value >>= 32) {
      put_few(value & 0xFFFFFFFFU, 32);
    }
    put_few(value, bits);
  }
  void finish() {
    if (held_ > 0) {
      to_.push_back(static_cast<std::byte>(waiting_));
    }
  }

 private:
  void put_few(std::uint64_t value, unsigned bits) {
    waiting_ |= value << held_;
    held_ += bits;
    for (; held_ >= 8; held_ -= 8, waiting_ >>= 8) {
      to_.push_back(static_cast<std::byte>(waiting_));
    }
  }
  std::vector<std::byte>& to_;
  std::uint64_t waiting_ = 0;
  unsigned held_ = 0;  ///< Bits in waiting_: fewer than 8 between calls.
};

class BitReader {
 public:
  /// @param from  With kUnpackSlack bytes behind the last one that is asked for.
  explicit BitReader(const std::byte* from) : from_(from) {}
  [[nodiscard]] std::uint64_t take(unsigned bits) {
    if (bits > 32) {
      const std::uint64_t low = take_few(32);
      return low | take_few(bits - 32) << 32;
    }
    return take_few(bits);
  }

 private:
  [[nodiscard]] std::uint64_t take_few(unsigned bits) {
    std::uint64_t word;
    std::memcpy(&word, from_ + at_ / 8, sizeof word);
    word >>= at_ % 8;
    at_ += bits;
    return word & ((std::uint64_t{1} << bits) - 1);
  }
  const std::byte* from_;
  std::uint64_t at_ = 0;
};
static_assert(std::endian::native == std::endian::little);

/// Bits of the numbers of a point.
struct Widths {
  unsigned x, y, height;
  Widths(const GridBox& box, unsigned height_bits)
      : x(bits_of(box.min_x, box.max_x)), y(bits_of(box.min_y, box.max_y)), height(height_bits) {}
  static unsigned bits_of(std::int64_t low, std::int64_t high) {
    return static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(high - low)));
  }
};

constexpr std::size_t kHeader = 10;  // bytes: the kind of key, the bits of a height, the least key

}  // namespace

void pack_bucket(std::span<const GridVertex> points, const GridBox& box,
                 std::vector<std::byte>& to) {
  const HeightKey kind = key_for(points);
  std::uint64_t low = ~std::uint64_t{0}, high = 0;
  for (const GridVertex& p : points) {
    const std::uint64_t key = key_of_height(p.height, kind);
    low = std::min(low, key);
    high = std::max(high, key);
  }
  const Widths widths(box, static_cast<unsigned>(std::bit_width(high - low)));
  to.assign(kHeader, std::byte{});
  to[0] = static_cast<std::byte>(kind);
  to[1] = static_cast<std::byte>(widths.height);
  std::memcpy(to.data() + 2, &low, sizeof low);
  BitWriter bits(to);
  for (const GridVertex& p : points) {
    bits.put(static_cast<std::uint64_t>(std::int64_t{p.position.x} - box.min_x), widths.x);
    bits.put(static_cast<std::uint64_t>(std::int64_t{p.position.y} - box.min_y), widths.y);
    bits.put(key_of_height(p.height, kind) - low, widths.height);
  }
  bits.finish();
}

void unpack_bucket(std::span<const std::byte> bytes, const GridBox& box,
                   std::span<GridVertex> points) {
  if (bytes.size() < kHeader) {
    return;
  }
  const auto kind = static_cast<HeightKey>(bytes[0]);
  const Widths widths(box, std::to_integer<unsigned>(bytes[1]));
  std::uint64_t low = 0;
  std::memcpy(&low, bytes.data() + 2, sizeof low);
  const std::uint64_t all = std::uint64_t{widths.x} + widths.y + widths.height;
  if ((all * points.size() + 7) / 8 > bytes.size() - kHeader || widths.height > 64) {
    return;
  }
  BitReader bits(bytes.data() + kHeader);
  for (GridVertex& p : points) {
    p.position.x =
        static_cast<std::int32_t>(box.min_x + static_cast<std::int64_t>(bits.take(widths.x)));
    p.position.y =
        static_cast<std::int32_t>(box.min_y + static_cast<std::int64_t>(bits.take(widths.y)));
    p.height = height_of_key(low + bits.take(widths.height), kind);
  }
}

}  // namespace ptin
