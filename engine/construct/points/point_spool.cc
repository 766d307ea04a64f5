// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_spool.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "storage/file/checksum.h"

namespace ptin {

namespace {

constexpr std::uint64_t kChecksumBytes = sizeof(std::uint64_t);

constexpr std::uint64_t begin_of_block(std::uint64_t block) {
  return block * (kSpoolBlock * kSpooledBytes + kChecksumBytes);
}

/// Another one for the same points in another place.
std::uint64_t checksum_of_block(std::uint64_t spool, std::uint64_t block,
                                std::span<const std::byte> points) {
  return checksum_of_object(std::array{spool, block, checksum_of(points)});
}

}  // namespace

SpoolWriter::SpoolWriter(FileLayer& files, const std::string& path, std::uint64_t number)
    : file_(files, without_old(files, path), ScratchFile::Kept::kNew), number_(number) {
  block_.reserve(kSpoolBlock * kSpooledBytes + kChecksumBytes);
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
  const std::uint64_t checksum = checksum_of_block(number_, blocks_, block_);
  const auto bytes = std::as_bytes(std::span(&checksum, 1));
  block_.insert(block_.end(), bytes.begin(), bytes.end());
  file_.write_at(block_, begin_of_block(blocks_));
  ++blocks_;
  block_.clear();
}

void SpoolWriter::finish() {
  if (!block_.empty()) {
    flush();
  }
  file_.close();
}

SpoolReader::SpoolReader(const PointFiles& files, std::uint64_t number, std::uint64_t points)
    : number_(number),
      path_(files.path("spool", number)),
      file_(files.open(path_)),
      points_(points) {
  if (file_->size() != points * kSpooledBytes + spool_blocks(points) * kChecksumBytes) {
    refuse_damaged(path_);
  }
}

void SpoolReader::read(std::uint64_t block, std::vector<SourcePoint>& points) {
  const std::uint64_t first = block * kSpoolBlock;
  const auto count = static_cast<std::size_t>(std::min(kSpoolBlock, points_ - first));
  bytes_.resize(count * kSpooledBytes + kChecksumBytes);
  file_->read_at(bytes_, begin_of_block(block));
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes_.data() + count * kSpooledBytes, kChecksumBytes);
  if (checksum_of_block(number_, block, std::span(bytes_).first(count * kSpooledBytes)) !=
      checksum) {
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
