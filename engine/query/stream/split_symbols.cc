// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/split_symbols.h"

namespace ptin {

namespace {

/// Takes bytes that were written down, from the front.
class Taken {
 public:
  explicit Taken(std::span<const std::byte> bytes) : at_(bytes.data()), end_(at_ + bytes.size()) {}
  [[nodiscard]] bool is_over() const noexcept { return at_ == end_; }
  std::size_t byte() noexcept { return static_cast<std::size_t>(*at_++); }
  std::uint64_t number() noexcept {
    std::uint64_t v = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint64_t b = byte();
      v |= (b & 127) << shift;
      if (b < 128) return v;
    }
  }
  std::int64_t signed_number() noexcept {
    const std::uint64_t v = number();
    return static_cast<std::int64_t>(v >> 1) ^ -static_cast<std::int64_t>(v & 1U);
  }

 private:
  const std::byte* at_;
  const std::byte* end_;
};

}  // namespace

void RecordedSymbols::code(std::span<const std::byte> symbols, SplitModels& models,
                           RangeEncoder& coder) {
  for (Taken taken(symbols); !taken.is_over();) {
    const std::size_t tag = taken.byte();
    if (tag < kRangeTag) {
      models.bit(coder, (tag - kBitTag) / 2, (tag - kBitTag) % 2 != 0);
    } else if (tag < kHeightTag) {
      const auto most = static_cast<std::uint32_t>(taken.number());
      models.range(coder, tag - kRangeTag, most, static_cast<std::uint32_t>(taken.number()));
    } else {
      const std::int64_t number = taken.signed_number();
      std::optional<std::int64_t> expected;
      if ((tag - kHeightTag) % 2 != 0) expected = number + taken.signed_number();
      models.height(coder, (tag - kHeightTag) / 2, expected, number);
    }
  }
}

}  // namespace ptin
