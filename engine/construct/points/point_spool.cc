// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_spool.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "storage/file/checksum.h"

namespace ptin {

SpoolWriter::SpoolWriter(FileLayer& files, const std::string& path)
    : file_(files, without_old(files, path), ScratchFile::Kept::kNew) {
  block_.reserve(kSpoolBlock * kSpooledBytes);
}

void SpoolWriter::add(const SourcePoint& p) {
  const std::array<Decimal, 3> numbers{p.x, p.y, p.z};
  std::array<std::byte, kSpooledBytes> record;
  for (std::size_t i = 0; i < 3; ++i) {
    std::memcpy(record.data() + 8 * i, &numbers[i].mantissa, 8);
    record[24 + i] = static_cast<std::byte>(numbers[i].decimals);
  }
  block_.insert(block_.end(), record.begin(), record.end());
  if (block_.size() == kSpoolBlock * kSpooledBytes) {
    flush();
  }
}

void SpoolWriter::flush() {
  file_.write_at(block_, checksums_.size() * kSpoolBlock * kSpooledBytes);
  checksums_.push_back(checksum_of(block_));
  block_.clear();
}

std::vector<std::uint64_t> SpoolWriter::finish() {
  if (!block_.empty()) {
    flush();
  }
  return std::move(checksums_);
}

SpoolReader::SpoolReader(const PointFiles& files, const std::string& path, std::uint64_t points,
                         std::vector<std::uint64_t> checksums)
    : path_(path), file_(files.open(path)), points_(points), checksums_(std::move(checksums)) {
  if (file_->size() != points * kSpooledBytes || checksums_.size() != spool_blocks(points)) {
    refuse_damaged(path_);
  }
}

void SpoolReader::read(std::uint64_t block, std::vector<SourcePoint>& points) {
  const std::uint64_t first = block * kSpoolBlock;
  const auto count = static_cast<std::size_t>(std::min(kSpoolBlock, points_ - first));
  bytes_.resize(count * kSpooledBytes);
  file_->read_at(bytes_, first * kSpooledBytes);
  if (checksum_of(bytes_) != checksums_[block]) {
    refuse_damaged(path_);
  }
  points.clear();
  for (std::size_t r = 0; r < count; ++r) {
    const std::byte* record = bytes_.data() + r * kSpooledBytes;
    std::array<Decimal, 3> numbers;
    for (std::size_t i = 0; i < 3; ++i) {
      std::memcpy(&numbers[i].mantissa, record + 8 * i, 8);
      numbers[i].decimals = static_cast<std::int32_t>(record[24 + i]);
    }
    points.push_back({numbers[0], numbers[1], numbers[2]});
  }
}

}  // namespace ptin
