// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file that lies elsewhere, read in rounds of ranges, with a cache in memory and one on disk.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "storage/file/range_source.h"
#include "storage/file/readable_file.h"
#include "storage/file/sparse_cache.h"

namespace ptin {

/// Reads blocks of 4 KiB, and keeps those used last. What a thread announces is read in one round
/// when it first reads something that is not there: so nothing is read for a question that ends
/// before, and what fails is an error of the read, not of the hint. Threads: all functions but
/// keep_on_disk() may be called at once; two that want one block read it once.
class RangedFile final : public ReadableFile {
 public:
  static constexpr std::uint64_t kBlockBytes = 4096;
  static constexpr std::uint64_t kLeastCacheBytes = std::uint64_t{1} << 20;

  /// Takes what came with the opening of the source.
  RangedFile(std::shared_ptr<RangeSource> source, const RemoteCaches& caches);
  ~RangedFile() override;

  [[nodiscard]] const std::string& path() const noexcept override { return source_->name(); }
  [[nodiscard]] std::uint64_t bytes() const noexcept override { return source_->bytes(); }
  void read_at(std::span<std::byte> out, std::uint64_t offset) const override;
  void will_need(std::span<const ByteRange> ranges) const noexcept override;
  void will_also_need(std::span<const ByteRange> ranges) const noexcept override;
  [[nodiscard]] bool is_far() const noexcept override { return true; }
  [[nodiscard]] bool is_at_hand(const ByteRange& range) const noexcept override;
  void settle(IoCounters& counters) const noexcept override;
  /// Forgets what this thread announced and did not read. The server is not asked: each of its answers
  /// shows whether the object is another one, and once one of them has, this does.
  void check_unchanged() const override;

  /// Keeps blocks in the folder of the options from now on, and looks for them there.
  /// @param key  Stands for the content of the file: two files with one key are equal.
  /// @throws Error not_found, io_error  the folder cannot be used
  void keep_on_disk(std::uint64_t key);

  /// What was read from the source since the opening, which is counted: one round of one request.
  [[nodiscard]] IoCounters cost() const noexcept;

 private:
  using Number = std::uint64_t;  // of a block
  struct Block {
    Number number;
    std::unique_ptr<std::byte[]> bytes;
  };
  struct Costs {
    std::uint64_t rounds = 0, requests = 0, bytes = 0;
  };
  /// The counters of one thread, which is one question.
  struct Asker {
    std::vector<ByteRange> announced;  ///< In the order of reading.
    std::vector<ByteRange> also;       ///< For the next round.
    Costs costs;
  };

  void add_range(const ByteRange& range, std::vector<ByteRange>& to) const;
  void copy_piece(std::span<std::byte> out, std::uint64_t offset) const;
  [[nodiscard]] const std::byte* find(Number number) const;
  void fetch(Number first, Number last, std::unique_lock<std::mutex>& lock) const;
  [[nodiscard]] std::vector<Number> wanted_round(Number first, Number last) const;
  void read_round(const std::vector<Number>& numbers, std::unique_lock<std::mutex>& lock) const;
  void insert(Number number, std::span<const std::byte> bytes) const;
  [[nodiscard]] std::uint64_t length_of(Number number) const;

  std::shared_ptr<RangeSource> source_;
  RemoteCaches caches_;
  std::uint64_t most_blocks_;
  std::unique_ptr<SparseCache> disk_;

  mutable std::mutex mutex_;
  mutable std::condition_variable arrived_;
  mutable std::list<Block> blocks_;  ///< The one used last comes first.
  mutable std::unordered_map<Number, std::list<Block>::iterator> places_;
  mutable std::unordered_set<Number> under_way_;
  mutable std::unordered_map<std::thread::id, Asker> askers_;
  mutable Costs all_;
  mutable bool is_replaced_ = false;  ///< As an answer of the source said.
};

}  // namespace ptin
