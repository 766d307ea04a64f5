// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/sparse_cache.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

#include <fcntl.h>
#include <unistd.h>

#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/file/ranged_file.h"

namespace ptin {

namespace {

constexpr std::uint64_t kBlockBytes = RangedFile::kBlockBytes;

std::string path_of(const std::string& folder, std::uint64_t key) {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(key));
  return folder + "/" + digits.data() + ".ptin-cache";
}

/// 0 stands for a block that is not there.
std::uint64_t checksum_of_block(std::span<const std::byte> block) {
  return std::max<std::uint64_t>(checksum_of(block), 1);
}

}  // namespace

SparseCache::SparseCache(const std::string& folder, std::uint64_t key, std::uint64_t bytes)
    : bytes_(bytes) {
  const std::string path = path_of(folder, key);
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    throw system_error(errno, "cannot open or make the cache", path);
  }
}

SparseCache::~SparseCache() { ::close(descriptor_); }

std::uint64_t SparseCache::place_of_checksum(std::uint64_t number) const noexcept {
  const std::uint64_t blocks = (bytes_ + kBlockBytes - 1) / kBlockBytes;
  return blocks * kBlockBytes + number * sizeof(std::uint64_t);
}

bool SparseCache::load(std::uint64_t number, std::span<std::byte> out) const noexcept {
  std::uint64_t checksum = 0;
  const auto read = [&](void* to, std::size_t bytes, std::uint64_t offset) {
    return ::pread(descriptor_, to, bytes, static_cast<off_t>(offset)) ==
           static_cast<ssize_t>(bytes);
  };
  return read(&checksum, sizeof checksum, place_of_checksum(number)) && checksum != 0 &&
         read(out.data(), out.size(), number * kBlockBytes) && checksum_of_block(out) == checksum;
}

void SparseCache::keep(std::uint64_t number, std::span<const std::byte> block) noexcept {
  const std::uint64_t checksum = checksum_of_block(block);
  const auto write = [&](const void* from, std::size_t bytes, std::uint64_t offset) {
    return ::pwrite(descriptor_, from, bytes, static_cast<off_t>(offset)) ==
           static_cast<ssize_t>(bytes);
  };
  if (write(block.data(), block.size(), number * kBlockBytes)) {
    static_cast<void>(write(&checksum, sizeof checksum, place_of_checksum(number)));
  }
}

}  // namespace ptin
