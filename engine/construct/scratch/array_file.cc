// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/scratch/array_file.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include "engine/error.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

/// Stands before each array; arrays begin at multiples of 8.
struct ArrayHeader {
  std::uint64_t element_bytes;
  std::uint64_t elements;
  std::uint64_t checksum;
};

constexpr std::uint64_t padded(std::uint64_t bytes) { return (bytes + 7) / 8 * 8; }

std::uint64_t chained(std::uint64_t checksum, const ArrayHeader& header) {
  struct {
    std::uint64_t before;
    ArrayHeader header;
  } link{checksum, header};
  return checksum_of_object(link);
}

}  // namespace

const std::string& without_old(FileLayer& files, const std::string& path) {
  const int failure = files.unlink(path);
  if (failure != 0 && failure != ENOENT) {
    throw system_error(failure, "cannot remove the file of an interrupted build", path);
  }
  return path;
}

void refuse_damaged(const std::string& path) {
  throw Error(ErrorCode::corruption,
              "a temporary file of the build is not what was written: the disk or another program "
              "damaged it",
              path);
}

ArrayFileWriter::ArrayFileWriter(FileLayer& files, const std::string& path)
    : file_(files, without_old(files, path), ScratchFile::Kept::kNew) {}

void ArrayFileWriter::put_bytes(std::span<const std::byte> bytes, std::size_t element) {
  const ArrayHeader header{element, bytes.size() / element, checksum_of(bytes)};
  file_.write_at(std::as_bytes(std::span(&header, 1)), facts_.bytes);
  facts_.bytes += sizeof header;
  file_.write_at(bytes, facts_.bytes);
  facts_.bytes += bytes.size();
  const std::array<std::byte, 8> zeros{};
  file_.write_at(std::span(zeros).first(padded(bytes.size()) - bytes.size()), facts_.bytes);
  facts_.bytes = padded(facts_.bytes);
  facts_.checksum = chained(facts_.checksum, header);
}

ArrayFileReader::ArrayFileReader(const std::string& path, const ArrayFileFacts& facts)
    : file_(path), mapped_(file_) {
  if (file_.bytes() != facts.bytes) {
    refuse();
  }
  ArrayFileFacts found;
  while (found.bytes < facts.bytes) {
    ArrayHeader header;
    if (facts.bytes - found.bytes < sizeof header) {
      refuse();
    }
    std::copy_n(mapped_.at(found.bytes), sizeof header, reinterpret_cast<std::byte*>(&header));
    found.checksum = chained(found.checksum, header);
    found.bytes += sizeof header;
    if (header.element_bytes == 0 ||
        header.elements > (facts.bytes - found.bytes) / header.element_bytes) {
      refuse();
    }
    found.bytes += padded(header.element_bytes * header.elements);
  }
  mapped_.require_undamaged();
  if (!(found == facts)) {
    refuse();
  }
}

void ArrayFileReader::skip() {
  ArrayHeader header;
  if (offset_ >= file_.bytes()) {
    refuse();
  }
  std::copy_n(mapped_.at(offset_), sizeof header, reinterpret_cast<std::byte*>(&header));
  mapped_.require_undamaged();
  offset_ += sizeof header + padded(header.element_bytes * header.elements);
}

std::span<const std::byte> ArrayFileReader::take_bytes(std::size_t element) {
  ArrayHeader header;
  if (offset_ >= file_.bytes()) {
    refuse();
  }
  std::copy_n(mapped_.at(offset_), sizeof header, reinterpret_cast<std::byte*>(&header));
  const std::span<const std::byte> bytes(mapped_.at(offset_ + sizeof header),
                                         header.element_bytes * header.elements);
  const std::span<const std::byte> zeros(bytes.data() + bytes.size(),
                                         padded(bytes.size()) - bytes.size());
  const bool is_sound =
      header.element_bytes == element && checksum_of(bytes) == header.checksum &&
      std::all_of(zeros.begin(), zeros.end(), [](std::byte zero) { return zero == std::byte{0}; });
  mapped_.require_undamaged();
  if (!is_sound) {
    refuse();
  }
  offset_ += sizeof header + padded(bytes.size());
  return bytes;
}

}  // namespace ptin
