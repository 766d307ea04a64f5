// SPDX-License-Identifier: GPL-3.0-or-later
//
// An array that grows to unknown length without its old and its new room there at once.
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

/// Elements that can be moved as bytes, in one block that grows as realloc() does it: a large one
/// keeps its pages and only gets further ones, where a vector would touch as many again and copy.
/// Elements that grow() adds are not initialised.
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

  /// Room for `capacity` elements, on large pages when it is much. Cost: none for the elements
  /// where the system moves pages, else a copy of them.
  /// @throws std::bad_alloc  nothing has changed
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

  /// To `size` elements, and room for a quarter more when there was not enough. Cost, errors: as
  /// reserve(), which is called once for each quarter.
  void grow(std::size_t size) {
    if (size > capacity_) {
      reserve(size + size / 4);
    }
    size_ = size;
  }

  /// To `size` elements, fewer than there are, and gives back room beyond a quarter more.
  /// Cost: as reserve().
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
  /// Whole pages around the block: the system moves a block's pages only where all of them have
  /// been given the same advice.
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
