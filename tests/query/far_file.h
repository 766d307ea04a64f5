// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file as one that lies elsewhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "engine/query/questions.h"
#include "storage/directory_writer.h"
#include "storage/packed_segment.h"
#include "storage/sample_heights.h"
#include "storage/store_writer.h"
#include "tests/storage/noting_source.h"
#include "tests/support/test_folder.h"

namespace ptin::test {

/// A directory of many cells, however small the file is and whatever it costs.
inline DirectoryOptions small_cells(std::uint64_t pages_of_cell) {
  return {.least_pages = 1, .pages_of_cell = pages_of_cell, .page_bytes_of_byte = 1};
}

inline std::vector<std::byte> bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::vector<std::byte> bytes(all.size());
  std::memcpy(bytes.data(), all.data(), all.size());
  return bytes;
}

inline constexpr std::size_t kFrontBytes = std::size_t{64} << 10;

/// A file opened as one that lies elsewhere, and what was read of it.
struct Far {
  std::shared_ptr<NotingSource> source;
  Terrain terrain;
  explicit Far(const std::vector<std::byte>& bytes, std::size_t front = kFrontBytes)
      : source(std::make_shared<NotingSource>(bytes, std::min(front, bytes.size()))),
        terrain(StoreFile::open(source)) {}
};

/// The records of a store in a file with a directory, whatever that costs.
struct WithDirectory {
  TestFolder folder;
  std::string path = folder.file("a.ptin");
  std::vector<std::byte> bytes;
  WithDirectory(const StoreFile& store, const DirectoryOptions& directory) {
    const auto writer = StoreWriter::create(path, {.overwrite = true, .directory = directory});
    StarredRecords records;
    IoCounters counters;
    SampleHeights samples;
    for (std::uint64_t i = 0; i < store.pages().page_count(); ++i) {
      store.read_starred(PageId{i}, records, samples, counters);
    }
    writer->add_segment(pack_segment(records, store.facts().heights, {}, 4096),
                        store.facts().heights);
    writer->publish(store.facts(), store.t0(), std::string(store.metadata_json()));
    bytes = bytes_of(path);
  }
};

/// Bytes of the opening of a large file: it ends with the cells of the directory. Nodes of a small one
/// would come with it.
inline std::size_t front_with_directory(const std::string& path) {
  for (const SectionInfo& s : Terrain::open(path).store().sections()) {
    if (s.name == "index") return s.offset;
  }
  return 0;
}

}  // namespace ptin::test
