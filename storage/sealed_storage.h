// SPDX-License-Identifier: GPL-3.0-or-later
//
// libspatialindex's disk storage with a checksum behind every array, and one behind the table of
// its pages: what is damaged is an Error, never a node.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <spatialindex/SpatialIndex.h>

namespace ptin {

/// libspatialindex's arrays in BASE.dat, found by BASE.idx. Storage that create() makes writes
/// arrays. Storage that open() gives only reads: it drops what libspatialindex's tree writes, which
/// is its header whenever it is destroyed.
class SealedStorage final : public SpatialIndex::IStorageManager {
 public:
  /// Makes new files, which open() accepts once seal() has closed them.
  static std::unique_ptr<SealedStorage> create(std::string base, std::uint32_t page_bytes);
  /// Opens sealed files. Null when they are not there, or when BASE.idx is not what was sealed.
  static std::unique_ptr<SealedStorage> open(std::string base);

  /// @throws Error corruption  the array is not what was stored
  void loadByteArray(SpatialIndex::id_type id, std::uint32_t& bytes, std::uint8_t** data) override;
  void storeByteArray(SpatialIndex::id_type& id, std::uint32_t bytes,
                      const std::uint8_t* data) override;
  void deleteByteArray(SpatialIndex::id_type id) override;
  void flush() override {}  // `disk_` writes BASE.idx when it goes.

  /// Closes the files of a storage that create() made, and puts the checksum behind BASE.idx. To be
  /// called when nothing refers to the storage any more.  @throws Error io_error,
  /// resource_exhausted
  static void seal(std::unique_ptr<SealedStorage> storage);

 private:
  SealedStorage(std::string base, SpatialIndex::IStorageManager* disk, bool is_read_only)
      : base_(std::move(base)), disk_(disk), is_read_only_(is_read_only) {}

  std::string base_;
  std::unique_ptr<SpatialIndex::IStorageManager> disk_;
  bool is_read_only_;
};

}  // namespace ptin
