// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the bytes of a format go: a file, or memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace ptin::tools {

class ByteSink {
 public:
  ByteSink() = default;
  ByteSink(const ByteSink&) = delete;
  ByteSink& operator=(const ByteSink&) = delete;
  virtual ~ByteSink() = default;

  /// Appends.  @throws Error resource_exhausted (disk full), io_error
  virtual void write(const void* data, std::size_t bytes) = 0;
  /// Writes over bytes that were written before: a header whose counts are known at the end.
  /// @throws Error as write
  virtual void replace(std::uint64_t offset, std::string_view bytes) = 0;

  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Appends the bytes of a trivially copyable value, as this (little-endian) machine holds them.
  template <typename T>
  void write_value(const T& value) {
    write(&value, sizeof value);
  }
};

/// Bytes in memory.
class MemorySink : public ByteSink {
 public:
  using ByteSink::write;
  void write(const void* data, std::size_t bytes) override {
    text_.append(static_cast<const char*>(data), bytes);
  }
  void replace(std::uint64_t offset, std::string_view bytes) override {
    text_.replace(static_cast<std::size_t>(offset), bytes.size(), bytes);
  }
  /// What was written; the sink is empty then.
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace ptin::tools
