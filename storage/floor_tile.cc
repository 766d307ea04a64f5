// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor_tile.h"

#include <algorithm>
#include <array>
#include <bit>

#include "storage/bit_fields.h"

namespace ptin {

namespace {

/// How a tile tells its void samples.
enum class Voids : std::uint8_t { kNone = 0, kAll = 1, kBits = 2, kRuns = 3 };
constexpr unsigned kVoidsBits = 2;
constexpr unsigned kHeightBits = 32;
/// A number of samples, or a place among them: a tile has at most 65 x 65.
constexpr unsigned kPlaceBits = 13;
static_assert((kMostFloorSide + 1) * (kMostFloorSide + 1) < (1U << kPlaceBits));
/// Widths from 0 to 32.
constexpr unsigned kWidthBits = 6;
/// Residuals of a block have one width.
constexpr std::uint32_t kBlockWidth = 8, kBlockHeight = 4;

/// Small numbers of either sign as small numbers.
constexpr std::uint32_t zigzag(std::uint32_t residual) noexcept {
  return (residual << 1) ^ (0U - (residual >> 31));
}
constexpr std::uint32_t unzigzag(std::uint32_t coded) noexcept {
  return (coded >> 1) ^ (0U - (coded & 1));
}

class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& to) : to_(to), first_(to.size()) {}
  void put(std::uint64_t value, unsigned width) {
    to_.resize(first_ + (at_ + width) / 8 + 1 + kFloorTileTail);
    write_bits(to_.data() + first_, at_, width, value);
    at_ += width;
  }
  /// Ends at a whole byte.
  void end() { to_.resize(first_ + (at_ + 7) / 8); }

 private:
  std::vector<std::byte>& to_;
  std::size_t first_, at_ = 0;
};

class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> from) : from_(from) {}
  /// REQUIRES: has(width)
  [[nodiscard]] std::uint64_t take_word(unsigned width) noexcept {
    const std::uint64_t value = read_bits(from_.data(), at_, width);
    at_ += width;
    return value;
  }
  [[nodiscard]] std::uint32_t take(unsigned width) noexcept {
    return static_cast<std::uint32_t>(take_word(width));
  }
  [[nodiscard]] bool has(std::size_t bits) const noexcept { return at_ + bits <= 8 * from_.size(); }
  /// Nothing follows but the zeros that fill up the last byte.
  [[nodiscard]] bool is_at_end() noexcept {
    const std::size_t left = 8 * from_.size() - at_;
    return left < 8 && (left == 0 || take(static_cast<unsigned>(left)) == 0);
  }

 private:
  std::span<const std::byte> from_;
  std::size_t at_ = 0;
};

bool is_all_void(const FloorTile& tile) {
  return !tile.is_void.empty() &&
         std::find(tile.is_void.begin(), tile.is_void.end(), 0) == tile.is_void.end();
}
bool has_voids(const FloorTile& tile) {
  return std::ranges::any_of(tile.is_void, [](std::uint8_t v) { return v != 0; });
}

/// Lengths of runs of samples that are not void and void, in turn; the first may be 0.
std::vector<std::uint32_t> runs_of(const std::vector<std::uint8_t>& is_void) {
  std::vector<std::uint32_t> runs{0};
  bool now = false;
  for (const std::uint8_t v : is_void) {
    if ((v != 0) != now) {
      runs.push_back(0);
      now = !now;
    }
    ++runs.back();
  }
  return runs;
}

void put_voids(const FloorTile& tile, BitWriter& bits) {
  const auto count = std::count_if(tile.is_void.begin(), tile.is_void.end(),
                                   [](std::uint8_t v) { return v != 0; });
  const auto put_kind = [&](Voids kind) { bits.put(static_cast<std::uint64_t>(kind), kVoidsBits); };
  if (count == 0) return put_kind(Voids::kNone);
  if (static_cast<std::size_t>(count) == tile.samples()) return put_kind(Voids::kAll);
  const std::vector<std::uint32_t> runs = runs_of(tile.is_void);
  // The last run is what is left, so it is not written.
  if (runs.size() * kPlaceBits < tile.samples()) {
    put_kind(Voids::kRuns);
    bits.put(runs.size() - 1, kPlaceBits);
    for (std::size_t i = 0; i + 1 < runs.size(); ++i) bits.put(runs[i], kPlaceBits);
    return;
  }
  put_kind(Voids::kBits);
  for (const std::uint8_t v : tile.is_void) bits.put(v != 0 ? 1 : 0, 1);
}

/// Heights of void samples are chosen such that what comes after them is well foretold: the gradient of
/// their neighbours, but between these. One that none precedes has the first height.
void fill_voids(const FloorTile& tile, std::vector<OrderedHeight>& heights) {
  const std::size_t width = tile.width;
  const auto first = std::find(tile.is_void.begin(), tile.is_void.end(), 0);
  OrderedHeight last = heights[static_cast<std::size_t>(first - tile.is_void.begin())];
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const bool has_left = i % width != 0, has_up = i >= width;
    if (tile.is_void[i] != 0) {
      const OrderedHeight a = has_left ? heights[i - 1] : has_up ? heights[i - width] : last;
      const OrderedHeight b = has_up ? heights[i - width] : a;
      const std::int64_t c = has_left && has_up ? heights[i - width - 1] : a;
      const auto [low, high] = std::minmax(a, b);
      heights[i] = static_cast<OrderedHeight>(
          std::clamp(std::int64_t{a} + std::int64_t{b} - c, std::int64_t{low}, std::int64_t{high}));
    }
    last = heights[i];
  }
}

/// Differences from what the neighbours foretell, in the numbers' own arithmetic, which wraps.
std::vector<std::uint32_t> residuals_of(const FloorTile& tile,
                                        const std::vector<OrderedHeight>& heights) {
  const std::size_t width = tile.width;
  std::vector<std::uint32_t> residuals(heights.size());
  for (std::size_t i = 1; i < heights.size(); ++i) {
    const OrderedHeight left = i % width != 0 ? heights[i - 1] : 0;
    const OrderedHeight up = i >= width ? heights[i - width] : 0;
    const OrderedHeight corner = i % width != 0 && i >= width ? heights[i - width - 1] : 0;
    residuals[i] = zigzag(heights[i] - (left + up - corner));
  }
  return residuals;
}

/// Puts a block of residuals: their width, and them.
/// @param first  That of the block's south-western sample.
void put_block(const std::uint32_t* first, std::uint32_t tile_width, std::uint32_t columns,
               std::uint32_t rows, BitWriter& bits) {
  std::uint32_t all = 0;
  for (std::uint32_t y = 0; y < rows; ++y) {
    for (std::uint32_t x = 0; x < columns; ++x) all |= first[std::size_t{y} * tile_width + x];
  }
  const auto width = static_cast<unsigned>(std::bit_width(all));
  bits.put(width, kWidthBits);
  for (std::uint32_t y = 0; y < rows; ++y) {
    for (std::uint32_t x = 0; x < columns; ++x) {
      bits.put(first[std::size_t{y} * tile_width + x], width);
    }
  }
}

void put_heights(const FloorTile& tile, BitWriter& bits) {
  std::vector<OrderedHeight> heights = tile.heights;
  if (has_voids(tile)) fill_voids(tile, heights);
  const std::vector<std::uint32_t> residuals = residuals_of(tile, heights);
  bits.put(heights.front(), kHeightBits);
  for (std::uint32_t y = 0; y < tile.height; y += kBlockHeight) {
    for (std::uint32_t x = 0; x < tile.width; x += kBlockWidth) {
      put_block(residuals.data() + std::size_t{y} * tile.width + x, tile.width,
                std::min(kBlockWidth, tile.width - x), std::min(kBlockHeight, tile.height - y),
                bits);
    }
  }
}

void put_lone(const FloorTile& tile, BitWriter& bits) {
  bits.put(tile.lone.size(), kPlaceBits);
  for (const FloorTile::Lone& lone : tile.lone) {
    bits.put(lone.place, kPlaceBits);
    bits.put(lone.height, kHeightBits);
  }
}

constexpr const char* kCut = "a tile of heights ends too early";

const char* take_runs(BitReader& bits, FloorTile& tile) {
  if (!bits.has(kPlaceBits)) return kCut;
  const std::uint32_t count = bits.take(kPlaceBits);
  if (!bits.has(std::size_t{count} * kPlaceBits)) return kCut;
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t run = bits.take(kPlaceBits);
    if (run > tile.samples() - at) return "a run of void samples leaves its tile of heights";
    std::fill_n(tile.is_void.begin() + static_cast<std::ptrdiff_t>(at), run,
                static_cast<std::uint8_t>(i % 2));
    at += run;
  }
  std::fill(tile.is_void.begin() + static_cast<std::ptrdiff_t>(at), tile.is_void.end(),
            static_cast<std::uint8_t>(count % 2));
  return nullptr;
}

const char* take_voids(BitReader& bits, FloorTile& tile) {
  if (!bits.has(kVoidsBits)) return kCut;
  const auto kind = static_cast<Voids>(bits.take(kVoidsBits));
  tile.is_void.clear();
  if (kind == Voids::kNone) return nullptr;
  tile.is_void.assign(tile.samples(), 1);
  if (kind == Voids::kAll) return nullptr;
  if (kind == Voids::kRuns) return take_runs(bits, tile);
  if (!bits.has(tile.samples())) return kCut;
  for (std::uint8_t& v : tile.is_void) v = static_cast<std::uint8_t>(bits.take(1));
  return nullptr;
}

/// Takes `kColumns` residuals of a row, and appends their running sum to it.
template <unsigned kColumns>
OrderedHeight take_row(BitReader& bits, unsigned width, OrderedHeight along,
                       OrderedHeight* out) noexcept {
  // Residuals of up to 7 bits, as most are, are a single load.
  if (width * kColumns > kMostFieldBits) {
    for (unsigned i = 0; i < kColumns; ++i) {
      out[i] = along += unzigzag(bits.take(width));
    }
    return along;
  }
  std::uint64_t word = bits.take_word(width * kColumns);
  const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
  for (unsigned i = 0; i < kColumns; ++i) {
    out[i] = along += unzigzag(static_cast<std::uint32_t>(word & mask));
    word >>= width;
  }
  return along;
}

OrderedHeight take_row(BitReader& bits, unsigned width, std::uint32_t columns, OrderedHeight along,
                       OrderedHeight* out) noexcept {
  if (columns == kBlockWidth) return take_row<kBlockWidth>(bits, width, along, out);
  for (; columns > 0; --columns) along = take_row<1>(bits, width, along, out++);
  return along;
}

/// Takes the rows of a row of blocks, each summed up along itself: the sums of a block's rows do not wait
/// for one another.
bool take_band(BitReader& bits, FloorTile& tile, std::uint32_t y, std::uint32_t rows) noexcept {
  std::array<OrderedHeight, kBlockHeight> along{};
  for (std::uint32_t x = 0; x < tile.width; x += kBlockWidth) {
    if (!bits.has(kWidthBits)) return false;
    const unsigned width = bits.take(kWidthBits);
    const std::uint32_t columns = std::min(kBlockWidth, tile.width - x);
    if (width > kHeightBits || !bits.has(std::size_t{width} * columns * rows)) return false;
    OrderedHeight* out = tile.heights.data() + std::size_t{y} * tile.width + x;
    for (std::uint32_t row = 0; row < rows; ++row, out += tile.width) {
      along[row] = take_row(bits, width, columns, along[row], out);
    }
  }
  return true;
}

/// Adds what lies above to rows that are summed up along themselves.
void add_above(FloorTile& tile, std::uint32_t y, std::uint32_t rows) noexcept {
  const std::size_t width = tile.width;
  for (std::uint32_t row = y; row < y + rows; ++row) {
    OrderedHeight* const here = tile.heights.data() + row * width;
    const OrderedHeight* const above = here - width;
    for (std::size_t x = 0; x < width; ++x) here[x] += above[x];
  }
}

const char* take_heights(BitReader& bits, FloorTile& tile) {
  if (!bits.has(kHeightBits)) return kCut;
  const OrderedHeight first_height = bits.take(kHeightBits);
  tile.heights.resize(tile.samples());
  for (std::uint32_t y = 0; y < tile.height; y += kBlockHeight) {
    const std::uint32_t rows = std::min(kBlockHeight, tile.height - y);
    if (!take_band(bits, tile, y, rows)) {
      return "a tile of heights ends too early, or has numbers of more than 32 bits";
    }
    if (y > 0) {
      add_above(tile, y, rows);
      continue;
    }
    // The sum of one residual is that residual.
    if (tile.heights.front() != 0) return "a tile of heights tells its first height twice";
    for (std::uint32_t x = 0; x < tile.width; ++x) tile.heights[x] += first_height;
    add_above(tile, 1, rows - 1);
  }
  return nullptr;
}

const char* take_lone(BitReader& bits, FloorTile& tile) {
  tile.lone.clear();
  if (!bits.has(kPlaceBits)) return kCut;
  const std::uint32_t count = bits.take(kPlaceBits);
  if (!bits.has(std::size_t{count} * (kPlaceBits + kHeightBits))) return kCut;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto place = static_cast<std::uint16_t>(bits.take(kPlaceBits));
    const bool is_next = tile.lone.empty() || place > tile.lone.back().place;
    if (!is_next || place >= tile.samples() || tile.is_void.empty() || tile.is_void[place] == 0) {
      return "a lone sample of a tile of heights is not void, or not in order";
    }
    tile.lone.push_back({place, bits.take(kHeightBits)});
  }
  return nullptr;
}

}  // namespace

void append_floor_tile(const FloorTile& tile, std::vector<std::byte>& to) {
  BitWriter bits(to);
  put_voids(tile, bits);
  if (!is_all_void(tile)) put_heights(tile, bits);
  if (has_voids(tile)) put_lone(tile, bits);
  bits.end();
}

const char* read_floor_tile(std::span<const std::byte> from, std::uint32_t width,
                            std::uint32_t height, FloorTile& tile) {
  tile.width = width;
  tile.height = height;
  BitReader bits(from);
  if (const char* const fault = take_voids(bits, tile)) return fault;
  if (is_all_void(tile)) {
    tile.heights.assign(tile.samples(), 0);
  } else if (const char* const fault = take_heights(bits, tile)) {
    return fault;
  }
  tile.lone.clear();
  if (!tile.is_void.empty()) {
    if (const char* const fault = take_lone(bits, tile)) return fault;
  }
  return bits.is_at_end() ? nullptr : "a tile of heights is followed by bytes that are not its own";
}

}  // namespace ptin
