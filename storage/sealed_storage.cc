// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/sealed_storage.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/file/file_questions.h"

namespace ptin {

namespace si = SpatialIndex;

namespace {

using Seal = std::uint64_t;

Seal seal_of(const std::uint8_t* data, std::size_t bytes) {
  return checksum_of({reinterpret_cast<const std::byte*>(data), bytes});
}

std::vector<std::uint8_t> content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

bool is_sealed(const std::string& path) {
  const std::vector<std::uint8_t> content = content_of(path);
  if (content.size() < sizeof(Seal)) {
    return false;
  }
  Seal kept = 0;
  std::memcpy(&kept, content.data() + content.size() - sizeof kept, sizeof kept);
  return kept == seal_of(content.data(), content.size() - sizeof kept);
}

}  // namespace

std::unique_ptr<SealedStorage> SealedStorage::create(std::string base, std::uint32_t page_bytes) {
  si::IStorageManager* disk = si::StorageManager::createNewDiskStorageManager(base, page_bytes);
  return std::unique_ptr<SealedStorage>(new SealedStorage(std::move(base), disk, false));
}

std::unique_ptr<SealedStorage> SealedStorage::open(std::string base) {
  if (!is_there(base + ".dat") || !is_there(base + ".idx") || !is_sealed(base + ".idx")) {
    return nullptr;
  }
  si::IStorageManager* disk = si::StorageManager::loadDiskStorageManager(base);
  return std::unique_ptr<SealedStorage>(new SealedStorage(std::move(base), disk, true));
}

void SealedStorage::loadByteArray(si::id_type id, std::uint32_t& bytes, std::uint8_t** data) {
  std::uint8_t* content = nullptr;
  disk_->loadByteArray(id, bytes, &content);
  std::unique_ptr<std::uint8_t[]> owner(content);
  Seal kept = 0;
  const bool is_whole = bytes >= sizeof kept;
  if (is_whole) {
    bytes -= static_cast<std::uint32_t>(sizeof kept);
    std::memcpy(&kept, content + bytes, sizeof kept);
  }
  if (!is_whole || kept != seal_of(content, bytes)) {
    throw Error(ErrorCode::corruption,
                "page " + std::to_string(id) +
                    " of the second index is damaged; remove it (.dat and .idx), and it is built "
                    "again",
                base_);
  }
  *data = owner.release();
}

void SealedStorage::storeByteArray(si::id_type& id, std::uint32_t bytes, const std::uint8_t* data) {
  if (is_read_only_) {
    return;
  }
  std::vector<std::uint8_t> sealed(data, data + bytes);
  const Seal seal = seal_of(data, bytes);
  sealed.resize(bytes + sizeof seal);
  std::memcpy(sealed.data() + bytes, &seal, sizeof seal);
  disk_->storeByteArray(id, static_cast<std::uint32_t>(sealed.size()), sealed.data());
}

void SealedStorage::deleteByteArray(si::id_type id) {
  if (!is_read_only_) {
    disk_->deleteByteArray(id);
  }
}

void SealedStorage::seal(std::unique_ptr<SealedStorage> storage) {
  const std::string path = storage->base_ + ".idx";
  storage->disk_->flush();
  storage.reset();
  const std::vector<std::uint8_t> content = content_of(path);
  const Seal seal = seal_of(content.data(), content.size());
  std::array<char, sizeof seal> bytes{};
  std::memcpy(bytes.data(), &seal, sizeof seal);
  std::ofstream out(path, std::ios::binary | std::ios::app);
  out.write(bytes.data(), bytes.size());
  out.close();
  if (!out) {
    throw system_error(errno, "cannot write the second index", path);
  }
}

}  // namespace ptin
