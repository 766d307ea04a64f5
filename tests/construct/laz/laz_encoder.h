// SPDX-License-Identifier: GPL-3.0-or-later
//
// The writing half of the coder of LAZ, for tests: models, bits, integers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace ptin::oracle {

/// Counts of symbols, as A. Said's coder keeps them.
struct Model {
  explicit Model(std::uint32_t symbols) : counts(symbols, 1), places(symbols), cycle(symbols) {
    update();
    cycle = left = (symbols + 6) / 2;
  }
  void update() {
    total += cycle;
    if (total > 32768) {
      total = 0;
      for (auto& c : counts) total += c = (c + 1) / 2;
    }
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      places[i] = (0x80000000U / total * sum) >> 16;
      sum += counts[i];
    }
    cycle =
        std::min<std::uint32_t>(5 * cycle / 4, 8 * (static_cast<std::uint32_t>(counts.size()) + 6));
    left = cycle;
  }
  std::vector<std::uint32_t> counts, places;
  std::uint32_t total = 0, cycle, left = 0;
};

struct ModelOfBits {
  void update() {
    total += cycle;
    if (total > 8192) {
      total = (total + 1) / 2;
      zeros = (zeros + 1) / 2;
      total += zeros == total ? 1 : 0;
    }
    place = (0x80000000U / total * zeros) >> 18;
    left = cycle = std::min<std::uint32_t>(5 * cycle / 4, 64);
  }
  std::uint32_t zeros = 1, total = 2, place = 4096, cycle = 4, left = 4;
};

class Encoder {
 public:
  void symbol(Model& m, std::uint32_t s) {
    const std::uint32_t whole = length_;
    length_ >>= 15;
    const std::uint32_t low = m.places[s] * length_;
    length_ = (s + 1 == m.places.size() ? whole : m.places[s + 1] * length_) - low;
    raise(low);
    ++m.counts[s];
    if (--m.left == 0) m.update();
  }
  void bit(ModelOfBits& m, bool one) {
    const std::uint32_t middle = m.place * (length_ >> 13);
    length_ = one ? length_ - middle : middle;
    raise(one ? middle : 0);
    m.zeros += one ? 0 : 1;
    if (--m.left == 0) m.update();
  }
  void bits(std::uint32_t count, std::uint32_t value) {
    if (count > 19) {
      bits(16, value & 0xffff);
      value >>= 16;
      count -= 16;
    }
    length_ >>= count;
    raise(value * length_);
  }
  std::string finish() {
    const bool one_more = length_ > 2U << 24;
    const std::uint32_t add = one_more ? 1U << 24 : 1U << 23;
    length_ = one_more ? 1U << 23 : 1U << 15;
    raise(add);
    return bytes_ + std::string(one_more ? 3 : 2, '\0');
  }

 private:
  void raise(std::uint32_t by) {
    base_ += by;
    if (base_ < by) {
      for (std::size_t i = bytes_.size(); ++bytes_[--i] == '\0';) continue;
    }
    for (; length_ < 1U << 24; length_ <<= 8, base_ <<= 8) {
      bytes_.push_back(static_cast<char>(base_ >> 24));
    }
  }
  std::uint32_t base_ = 0, length_ = 0xffffffffU;
  std::string bytes_;
};

class Integers {
 public:
  explicit Integers(std::uint32_t bits = 32, std::uint32_t contexts = 1)
      : bits_(bits), intervals_(contexts, Model(bits + 1)) {
    for (std::uint32_t k = 1; k <= bits; ++k) places_.emplace_back(1U << std::min(k, 8U));
  }
  void write(Encoder& e, std::int32_t predicted, std::int32_t value, std::uint32_t context = 0) {
    auto c = static_cast<std::int32_t>(static_cast<std::uint32_t>(value) -
                                       static_cast<std::uint32_t>(predicted));
    if (bits_ < 32) {
      const std::int32_t half = 1 << (bits_ - 1);
      c = ((c + half) & (2 * half - 1)) - half;
    }
    k_ = static_cast<std::uint32_t>(std::bit_width(c <= 0 ? 0U - static_cast<std::uint32_t>(c)
                                                          : static_cast<std::uint32_t>(c) - 1));
    e.symbol(intervals_[context], k_);
    if (k_ == 0) {
      e.bit(bit_, c == 1);
    } else if (k_ < 32) {
      const std::uint32_t place =
          static_cast<std::uint32_t>(c) + (c < 0 ? (1U << k_) - 1 : 0U - 1U);
      const std::uint32_t rest = k_ > 8 ? k_ - 8 : 0;
      e.symbol(places_[k_ - 1], place >> rest);
      if (rest > 0) e.bits(rest, place & ((1U << rest) - 1));
    }
  }
  std::uint32_t k() const { return k_; }

 private:
  std::uint32_t bits_, k_ = 0;
  std::vector<Model> intervals_, places_;
  ModelOfBits bit_;
};

/// Models that are made when they are first wanted.
class Models {
 public:
  explicit Models(std::uint32_t symbols) : symbols_(symbols) {}
  Model& operator[](std::uint32_t context) {
    return models_.try_emplace(context, symbols_).first->second;
  }

 private:
  std::uint32_t symbols_;
  std::map<std::uint32_t, Model> models_;
};

/// The median of five, of which the largest or the smallest gives way.
struct Median {
  std::array<std::int32_t, 5> v{};
  bool high = true;
  void add(std::int32_t x) {
    const std::int32_t median = v[2];
    v[high ? 4 : 0] = x;
    std::sort(v.begin(), v.end());
    high = high ? x < median : x <= median;
  }
};

}  // namespace ptin::oracle
