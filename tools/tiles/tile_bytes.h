// SPDX-License-Identifier: GPL-3.0-or-later
//
// Little-endian bytes of tiles, gathered in memory.
#pragma once

#include <bit>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace ptin::tools {

static_assert(std::endian::native == std::endian::little,
              "tiles are written as they lie in memory");

class TileBytes {
 public:
  template <class Value>
  void add(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Value));
  }
  void add_text(std::string_view text) { bytes_.append(text); }
  /// Fills up to a multiple of `step` bytes.
  void align(std::size_t step, char with = '\0') {
    bytes_.resize((bytes_.size() + step - 1) / step * step, with);
  }
  [[nodiscard]] std::size_t size() const noexcept { return bytes_.size(); }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace ptin::tools
