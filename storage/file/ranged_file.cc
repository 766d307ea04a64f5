// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/ranged_file.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/error.h"

namespace ptin {

namespace {

/// A round reads at most so much, and a quarter of the cache: what it reads is used before it goes.
constexpr std::uint64_t kMostRoundBytes = std::uint64_t{4} << 20;

}  // namespace

RangedFile::RangedFile(std::shared_ptr<RangeSource> source, const RemoteCaches& caches)
    : source_(std::move(source)),
      caches_(caches),
      most_blocks_(std::max(caches.memory_bytes, kLeastCacheBytes) / kBlockBytes) {
  const std::span<const std::byte> front = source_->front();
  all_ = {1, 1, front.size()};
  for (Number number = 0; number * kBlockBytes < front.size(); ++number) {
    const std::uint64_t offset = number * kBlockBytes;
    if (front.size() - offset < length_of(number)) {
      break;
    }
    insert(number, front.subspan(offset, length_of(number)));
  }
}

RangedFile::~RangedFile() = default;

std::uint64_t RangedFile::length_of(Number number) const {
  return std::min(kBlockBytes, bytes() - number * kBlockBytes);
}

void RangedFile::keep_on_disk(std::uint64_t key) {
  if (!caches_.folder.empty()) {
    disk_ = std::make_unique<SparseCache>(caches_.folder, key, bytes());
  }
}

void RangedFile::read_at(std::span<std::byte> out, std::uint64_t offset) const {
  if (offset > bytes() || out.size() > bytes() - offset) {
    throw Error(ErrorCode::corruption,
                "the file ends at byte " + std::to_string(bytes()) + ", and " +
                    std::to_string(out.size()) + " bytes from " + std::to_string(offset) +
                    " on were to be read; it was cut short",
                path());
  }
  // Each piece fits into the smallest cache.
  constexpr std::uint64_t kPieceBytes = kLeastCacheBytes / 4;
  while (!out.empty()) {
    const std::size_t piece = std::min<std::uint64_t>(kPieceBytes, out.size());
    copy_piece(out.first(piece), offset);
    out = out.subspan(piece);
    offset += piece;
  }
}

void RangedFile::copy_piece(std::span<std::byte> out, std::uint64_t offset) const {
  const Number first = offset / kBlockBytes;
  const Number last = (offset + out.size() - 1) / kBlockBytes;
  std::unique_lock lock(mutex_);
  for (;;) {
    bool is_complete = true;
    for (Number number = first; number <= last; ++number) {
      const std::byte* const block = find(number);
      if (block == nullptr) {
        is_complete = false;
        break;
      }
      const std::uint64_t begin = std::max(offset, number * kBlockBytes);
      const std::uint64_t end = std::min(offset + out.size(), (number + 1) * kBlockBytes);
      std::memcpy(out.data() + (begin - offset), block + (begin - number * kBlockBytes),
                  end - begin);
    }
    if (is_complete) {
      return;
    }
    fetch(first, last, lock);
  }
}

/// A block that is in memory, or on the disk; null when it is neither.
const std::byte* RangedFile::find(Number number) const {
  if (const auto place = places_.find(number); place != places_.end()) {
    blocks_.splice(blocks_.begin(), blocks_, place->second);
    return blocks_.front().bytes.get();
  }
  if (disk_) {
    std::byte loaded[kBlockBytes];
    const std::span<std::byte> block = std::span(loaded).first(length_of(number));
    if (disk_->load(number, block)) {
      insert(number, block);
      return blocks_.front().bytes.get();
    }
  }
  return nullptr;
}

/// Makes those of the blocks that are neither here nor under way come, and with them what was
/// announced; or waits for those under way.
void RangedFile::fetch(Number first, Number last, std::unique_lock<std::mutex>& lock) const {
  const std::vector<Number> numbers = wanted_round(first, last);
  if (numbers.empty()) {
    arrived_.wait(lock);  // for what another thread reads
    return;
  }
  for (const Number number : numbers) {
    under_way_.insert(number);
  }
  const auto land = [&] {
    for (const Number number : numbers) {
      under_way_.erase(number);
    }
    arrived_.notify_all();
  };
  try {
    read_round(numbers, lock);
  } catch (...) {
    land();
    throw;
  }
  land();
}

/// The blocks to read now, ascending. What was announced is read in its order from the blocks wanted
/// on; what was announced before them is left out, since it will not be read any more. What goes with
/// the next round goes with this one.
std::vector<RangedFile::Number> RangedFile::wanted_round(Number first, Number last) const {
  const auto is_missing = [&](Number number) {
    return !under_way_.contains(number) && find(number) == nullptr;
  };
  std::vector<Number> numbers;
  for (Number number = first; number <= last; ++number) {
    if (is_missing(number)) {
      numbers.push_back(number);
    }
  }
  const auto asker = askers_.find(std::this_thread::get_id());
  if (numbers.empty() || asker == askers_.end()) {
    return numbers;
  }
  const std::size_t most = std::min(kMostRoundBytes, most_blocks_ * kBlockBytes / 4) / kBlockBytes;
  std::vector<ByteRange>& announced = asker->second.announced;
  const auto holds_first = [&](const ByteRange& r) {
    return r.offset / kBlockBytes <= first && first <= (r.offset + r.bytes - 1) / kBlockBytes;
  };
  auto next = std::find_if(announced.begin(), announced.end(), holds_first);
  if (next == announced.end()) {
    next = announced.begin();
  }
  std::size_t looked_at = numbers.size();
  // Ranges that do not fit are for the next round.
  const auto take = [&](std::vector<ByteRange>& ranges, std::vector<ByteRange>::iterator from) {
    for (; from != ranges.end() && looked_at < most; ++from) {
      Number number = from->offset / kBlockBytes;
      const Number end = (from->offset + from->bytes - 1) / kBlockBytes + 1;
      for (; number < end && looked_at < most; ++number, ++looked_at) {
        if ((number < first || number > last) && is_missing(number)) numbers.push_back(number);
      }
      if (number < end) {
        from->bytes -= number * kBlockBytes - from->offset;
        from->offset = number * kBlockBytes;
        break;
      }
    }
    ranges.erase(ranges.begin(), from);
  };
  take(asker->second.also, asker->second.also.begin());
  take(announced, next);
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

void RangedFile::read_round(const std::vector<Number>& numbers,
                            std::unique_lock<std::mutex>& lock) const {
  struct Run {
    Number first, count;
  };
  std::vector<Run> runs;  // What lies near was joined where it was announced.
  for (const Number number : numbers) {
    if (!runs.empty() && runs.back().first + runs.back().count == number) {
      ++runs.back().count;
    } else {
      runs.push_back({number, 1});
    }
  }
  const auto bytes_of = [&](const Run& r) {
    return std::min((r.first + r.count) * kBlockBytes, bytes()) - r.first * kBlockBytes;
  };
  std::uint64_t total = 0;
  for (const Run& r : runs) {
    total += bytes_of(r);
  }
  std::vector<std::byte> buffer(total);
  std::vector<RangeRead> reads;
  std::uint64_t at = 0;
  for (const Run& r : runs) {
    reads.push_back({r.first * kBlockBytes, std::span(buffer).subspan(at, bytes_of(r))});
    at += bytes_of(r);
  }
  Costs& mine = askers_[std::this_thread::get_id()].costs;  // stays where it is: nobody erases it
  for (Costs* costs : {&mine, &all_}) {
    ++costs->rounds;
    costs->requests += reads.size();
    costs->bytes += total;
  }
  lock.unlock();
  try {
    source_->read(reads);
  } catch (const Error& error) {
    lock.lock();
    is_replaced_ = is_replaced_ || error.code() == ErrorCode::corruption;
    throw;
  } catch (...) {
    lock.lock();
    throw;
  }
  lock.lock();
  for (const RangeRead& read : reads) {
    for (std::uint64_t from = 0; from < read.out.size(); from += kBlockBytes) {
      const Number number = (read.offset + from) / kBlockBytes;
      const auto block = std::span<const std::byte>(read.out).subspan(from, length_of(number));
      if (disk_) {
        disk_->keep(number, block);
      }
      insert(number, block);
    }
  }
}

/// Puts a block where the one used last is, or leaves it where it is.
void RangedFile::insert(Number number, std::span<const std::byte> bytes) const {
  if (places_.contains(number)) {
    return;
  }
  if (blocks_.size() >= most_blocks_) {
    places_.erase(blocks_.back().number);
    blocks_.pop_back();
  }
  Block block{number, std::make_unique<std::byte[]>(kBlockBytes)};
  std::copy(bytes.begin(), bytes.end(), block.bytes.get());
  blocks_.push_front(std::move(block));
  try {
    places_.emplace(number, blocks_.begin());
  } catch (...) {
    blocks_.pop_front();
    throw;
  }
}

void RangedFile::will_need(std::span<const ByteRange> ranges) const noexcept {
  try {
    const std::lock_guard lock(mutex_);
    std::vector<ByteRange>& announced = askers_[std::this_thread::get_id()].announced;
    announced.clear();
    for (const ByteRange& range : ranges) add_range(range, announced);
  } catch (...) {  // A hint: without memory for it, what is read comes one by one.
  }
}

void RangedFile::will_also_need(std::span<const ByteRange> ranges) const noexcept {
  try {
    const std::lock_guard lock(mutex_);
    std::vector<ByteRange>& also = askers_[std::this_thread::get_id()].also;
    // A question that reads nothing more leaves its own behind, which must not grow.
    constexpr std::size_t kMost = kMostRoundBytes / kBlockBytes;
    if (also.size() + ranges.size() > kMost) also.clear();
    for (const ByteRange& range : ranges) add_range(range, also);
  } catch (...) {  // as above
  }
}

void RangedFile::add_range(const ByteRange& range, std::vector<ByteRange>& to) const {
  if (range.bytes > 0 && range.offset < bytes()) {
    to.push_back({range.offset, std::min(range.bytes, bytes() - range.offset)});
  }
}

bool RangedFile::is_at_hand(const ByteRange& range) const noexcept {
  try {
    const std::lock_guard lock(mutex_);
    const Number last = (range.offset + range.bytes - 1) / kBlockBytes;
    for (Number number = range.offset / kBlockBytes; number <= last; ++number) {
      if (find(number) == nullptr) {
        return false;
      }
    }
    return true;
  } catch (...) {
    return false;
  }
}

void RangedFile::settle(IoCounters& counters) const noexcept {
  const std::lock_guard lock(mutex_);
  const auto asker = askers_.find(std::this_thread::get_id());
  if (asker == askers_.end()) {
    return;
  }
  const Costs costs = std::exchange(asker->second.costs, {});
  counters.remote_rounds += costs.rounds;
  counters.remote_requests += costs.requests;
  counters.remote_bytes += costs.bytes;
}

void RangedFile::check_unchanged() const {
  const std::lock_guard lock(mutex_);
  if (const auto asker = askers_.find(std::this_thread::get_id()); asker != askers_.end()) {
    asker->second.announced.clear();
    asker->second.also.clear();
  }
  if (is_replaced_) {
    throw Error(ErrorCode::corruption,
                "the object was replaced or cut short while it was open; open it again", path());
  }
}

IoCounters RangedFile::cost() const noexcept {
  const std::lock_guard lock(mutex_);
  IoCounters counters;
  counters.remote_rounds = all_.rounds;
  counters.remote_requests = all_.requests;
  counters.remote_bytes = all_.bytes;
  return counters;
}

}  // namespace ptin
