// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_spool.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "engine/construct/grid/source_point.h"

namespace ptin {

void PointSpool::add(const SourcePoint& p) {
  const std::array<Decimal, 3> numbers{p.x, p.y, p.z};
  std::array<std::byte, kRecordBytes> record;
  for (std::size_t i = 0; i < 3; ++i) {
    std::memcpy(record.data() + 8 * i, &numbers[i].mantissa, 8);
    record[24 + i] = static_cast<std::byte>(numbers[i].decimals);
  }
  block_.insert(block_.end(), record.begin(), record.end());
  ++size_;
  if (block_.size() == kBlockRecords * kRecordBytes) {
    flush();
  }
}

void PointSpool::flush() {
  if (block_.empty()) {
    return;
  }
  if (files_.empty() || blocks_ == files_.back().first_block + files_.back().blocks) {
    files_.push_back({std::make_unique<ScratchFile>(memory_.files, memory_.folder, "spool", true),
                      blocks_, kFileBlocks << (files_.size() / kFilesOfSize)});
  }
  const File& last = files_.back();
  last.file->write_at(block_, (blocks_ - last.first_block) * kBlockRecords * kRecordBytes);
  ++blocks_;
  block_.clear();
}

bool PointSpool::take(std::vector<SourcePoint>& batch) {
  if (taken_ == 0) {
    flush();
  }
  batch.clear();
  if (taken_ == size_) {
    files_.clear();
    return false;
  }
  const std::uint64_t block = taken_ / kBlockRecords;
  const auto count =
      static_cast<std::size_t>(std::min<std::uint64_t>(kBlockRecords, size_ - taken_));
  block_.resize(count * kRecordBytes);
  File& from = files_[taking_];
  from.file->read_at(block_, (block - from.first_block) * kBlockRecords * kRecordBytes);
  for (std::size_t r = 0; r < count; ++r) {
    const std::byte* record = block_.data() + r * kRecordBytes;
    std::array<Decimal, 3> numbers;
    for (std::size_t i = 0; i < 3; ++i) {
      std::memcpy(&numbers[i].mantissa, record + 8 * i, 8);
      numbers[i].decimals = static_cast<std::int32_t>(record[24 + i]);
    }
    batch.push_back({numbers[0], numbers[1], numbers[2]});
  }
  taken_ += count;
  if (block + 1 == from.first_block + from.blocks) {
    from.file.reset();
    ++taking_;
  }
  return true;
}

}  // namespace ptin
