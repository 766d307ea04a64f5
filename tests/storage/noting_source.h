// SPDX-License-Identifier: GPL-3.0-or-later
//
// An object in memory in the place of one that lies elsewhere.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "storage/file/range_source.h"

namespace ptin::test {

inline std::vector<std::byte> noise(std::size_t bytes, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::vector<std::byte> result(bytes);
  for (std::byte& b : result) b = static_cast<std::byte>(random());
  return result;
}

/// Notes its rounds, and fails or waits when it is told to.
class NotingSource final : public RangeSource {
 public:
  explicit NotingSource(std::vector<std::byte> content, std::size_t front = 0)
      : content_(std::move(content)), front_(front) {}
  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept override { return content_.size(); }
  [[nodiscard]] std::span<const std::byte> front() const noexcept override {
    return std::span(content_).first(front_);
  }
  void read(std::span<const RangeRead> ranges) override {
    {
      const std::lock_guard lock(mutex_);
      rounds.emplace_back();
      for (const RangeRead& r : ranges) rounds.back().push_back({r.offset, r.out.size()});
    }
    if (delay.count() > 0) std::this_thread::sleep_for(delay);
    if (fails) throw Error(fault, "refused", name_);
    for (const RangeRead& r : ranges) {
      std::memcpy(r.out.data(), content_.data() + r.offset, r.out.size());
    }
  }
  using Round = std::vector<ByteRange>;
  std::vector<Round> rounds;
  std::atomic<bool> fails = false;
  ErrorCode fault = ErrorCode::io_error;
  std::chrono::milliseconds delay{0};

 private:
  std::string name_ = "elsewhere";
  std::vector<std::byte> content_;
  std::size_t front_;
  std::mutex mutex_;
};

}  // namespace ptin::test
