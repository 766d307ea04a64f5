// SPDX-License-Identifier: GPL-3.0-or-later
//
// Arrays of plain values in a temporary file, each with a checksum: what the stages of a build hand
// to one another on disk. Read back by the same program on the same machine only.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/construct/scratch/plain_value.h"
#include "storage/file/file_layer.h"
#include "storage/file/mapped_file.h"
#include "storage/file/read_only_file.h"

namespace ptin {

/// What a manifest knows of a finished file.
struct ArrayFileFacts {
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< Checksum of the headers, which hold those of the arrays.
  friend bool operator==(const ArrayFileFacts&, const ArrayFileFacts&) = default;
};

/// Removes the file of a name, if there is one: what an interrupted build left. Returns the name.
/// @throws Error io_error
const std::string& without_old(FileLayer& files, const std::string& path);

/// Says that a temporary file is not what was written: the disk, or another program, damaged it.
/// @throws Error corruption  always
[[noreturn]] void refuse_damaged(const std::string& path);

/// A type, const or not: a template `serialize(file, value)` says once which members of a value are kept,
/// and in which order, for writing and for reading.
template <class T, class Value>
concept MaybeConst = std::same_as<std::remove_const_t<T>, Value>;

/// Writes arrays one after the other. A file of that name that is there already is replaced: it is
/// what an interrupted build left.
class ArrayFileWriter {
 public:
  /// @throws Error io_error, resource_exhausted
  ArrayFileWriter(FileLayer& files, const std::string& path);

  /// @throws Error io_error, resource_exhausted
  template <PlainValue T>
  void put(std::span<const T> array) {
    put_bytes(std::as_bytes(array), sizeof(T));
  }
  template <PlainValue T>
  void put(const std::vector<T>& array) {
    put(std::span<const T>(array));
  }
  /// Writes values one after the other: vectors, spans, plain values and texts as an array each,
  /// optional ones behind whether they are there, and of other types what serialize(file, value) names.
  /// @throws Error as put()
  template <class... Values>
  void values(const Values&... values) {
    (put_value(values), ...);
  }

  /// Makes what was written durable.  @throws Error io_error, resource_exhausted
  void sync() { file_.sync(); }
  /// Closes the file, after the last array (ScratchFile::close()).
  /// @throws Error io_error, resource_exhausted
  [[nodiscard]] ArrayFileFacts finish() {
    file_.close();
    return facts_;
  }

 private:
  template <class T>
  void put_value(const T& value) {
    if constexpr (requires { put(value); }) {
      put(value);
    } else if constexpr (std::same_as<T, std::string>) {
      put(std::span<const char>(value));
    } else if constexpr (requires { value.has_value(); }) {
      put_value(value.has_value());
      if (value) {
        put_value(*value);
      }
    } else if constexpr (PlainValue<T>) {
      put(std::span<const T>(&value, 1));
    } else {
      serialize(*this, value);
    }
  }
  void put_bytes(std::span<const std::byte> bytes, std::size_t element);

  ScratchFile file_;
  ArrayFileFacts facts_;
};

/// Reads arrays back in the order of writing, from a mapping of the file. Spans live as long as the
/// reader, and take no anonymous memory.
class ArrayFileReader {
 public:
  /// Checks the headers of all arrays; an array itself is checked when it is taken.
  /// @throws Error corruption  the file is not the one of `facts`; io_error, not_found
  ArrayFileReader(const std::string& path, const ArrayFileFacts& facts);

  /// Passes over the next array, whose content is not looked at.
  /// @throws Error corruption  there is none
  void skip();
  [[nodiscard]] bool at_end() const noexcept { return offset_ == file_.bytes(); }
  /// The next array.
  /// @throws Error corruption  it is not of elements of this size, or damaged, or there is none
  template <class T>
  [[nodiscard]] std::span<const T> take() {
    const std::span<const std::byte> bytes = take_bytes(sizeof(T));
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// To be called when the work with spans is done: the file may have lost bytes under its mapping
  /// meanwhile, and what was read there is not what was written.
  /// @throws Error corruption  a read met a hole: the file was cut short, or its disk failed
  void require_undamaged() const { mapped_.require_undamaged(); }
  /// As take(), but a copy: nothing needs to be asked about it later on.
  template <class T>
  [[nodiscard]] std::vector<T> take_copy() {
    const std::span<const T> array = take<T>();
    std::vector<T> copy(array.begin(), array.end());
    require_undamaged();
    return copy;
  }
  /// Takes back what ArrayFileWriter::values() wrote.  @throws Error as take_copy()
  template <class... Values>
  void values(Values&... values) {
    (take_value(values), ...);
  }

 private:
  template <class T>
  void take_value(T& value) {
    if constexpr (std::same_as<T, std::string>) {
      const std::vector<char> text = take_copy<char>();
      value.assign(text.begin(), text.end());
    } else if constexpr (requires { value.push_back(value.front()); }) {
      value = take_copy<typename T::value_type>();
    } else if constexpr (requires { value.has_value(); }) {
      bool is_there = false;
      take_value(is_there);
      value.reset();
      if (is_there) {
        take_value(value.emplace());
      }
    } else if constexpr (PlainValue<T>) {
      const std::span<const T> one = take<T>();
      if (one.size() != 1) {
        refuse();
      }
      value = one.front();
      require_undamaged();
    } else {
      serialize(*this, value);
    }
  }
  std::span<const std::byte> take_bytes(std::size_t element);
  [[noreturn]] void refuse() const { refuse_damaged(file_.path()); }

  ReadOnlyFile file_;
  MappedFile mapped_;
  std::uint64_t offset_ = 0;
};

}  // namespace ptin
