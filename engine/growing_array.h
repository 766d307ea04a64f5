// SPDX-License-Identifier: GPL-3.0-or-later
//
// An array that grows to a length that nobody knows beforehand, without having its old and its new
// memory at the same time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>

#include "engine/large_array.h"

namespace ptin {

/// An array of elements that can be moved as bytes, in one block that grows by realloc(). The
/// system grows a large block by moving its pages and adding further ones; a vector would take a
/// second block and copy. Elements that grow() adds are not initialised.
template <typename T>
class GrowingArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  GrowingArray() = default;
  GrowingArray(GrowingArray&& other) noexcept { swap(other); }
  GrowingArray(const GrowingArray& other) {
    reserve(other.size_);
    size_ = other.size_;
    std::copy(other.data_, other.data_ + size_, data_);
  }
  GrowingArray& operator=(GrowingArray other) noexcept {
    swap(other);
    return *this;
  }
  ~GrowingArray() { std::free(data_); }

  [[nodiscard]] T* data() noexcept { return data_; }
  [[nodiscard]] const T* data() const noexcept { return data_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }

  /// Makes room for `capacity` elements, on large pages when it is much. Cost: nothing for each
  /// element where the system moves pages, else a copy of the elements.
  /// @throws std::bad_alloc  the array is as before
  void reserve(std::size_t capacity) {
    if (capacity <= capacity_) {
      return;
    }
    void* block = capacity <= static_cast<std::size_t>(-1) / sizeof(T)
                      ? std::realloc(data_, capacity * sizeof(T))
                      : nullptr;
    if (block == nullptr) {
      throw std::bad_alloc();
    }
    data_ = static_cast<T*>(block);
    capacity_ = capacity;
    advise();
  }

  /// Changes the size to `size` elements. Where there is not enough room, makes room for a quarter
  /// more than `size`. Cost and errors: as reserve(), which is called once for each quarter of
  /// growth.
  void grow(std::size_t size) {
    if (size > capacity_) {
      reserve(size + size / 4);
    }
    size_ = size;
  }

  /// Changes the size to `size` elements, fewer than there are, and gives back the room beyond a
  /// quarter more than `size`. Cost: as reserve().
  void shrink(std::size_t size) noexcept {
    size_ = size;
    const std::size_t capacity = size + size / 4;
    if (capacity == 0 || capacity >= capacity_) {
      return;
    }
    if (void* block = std::realloc(data_, capacity * sizeof(T)); block != nullptr) {
      data_ = static_cast<T*>(block);
      capacity_ = capacity;
    }
  }

 private:
  /// Asks for large pages, for all pages that the block touches: the system moves the pages of a
  /// block only where all of them have been given the same advice.
  void advise() noexcept {
    constexpr std::uintptr_t kPage = 4096;
    const auto begin = reinterpret_cast<std::uintptr_t>(data_);
    const std::uintptr_t first = begin / kPage * kPage;
    const std::uintptr_t last = (begin + capacity_ * sizeof(T) + kPage - 1) / kPage * kPage;
    advise_large_pages(reinterpret_cast<void*>(first), last - first);
  }

  void swap(GrowingArray& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace ptin
