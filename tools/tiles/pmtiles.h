// SPDX-License-Identifier: GPL-3.0-or-later
//
// PMTiles 3: the tiles of a web map in one file, which any host that answers ranges gives out.
// The sections below are those of its specification, version 3, by Protomaps.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/output/output_file.h"
#include "tools/output/spill_file.h"
#include "tools/tiles/globe.h"
#include "tools/tiles/web_mercator.h"

namespace ptin::tools {

/// The number of a tile among all of all zooms: zoom by zoom, each along the Hilbert curve (section
/// 4.1).
[[nodiscard]] std::uint64_t pmtiles_id(const WebTile& tile) noexcept;

/// What tiles are, as the header has it (section 3.2).
enum class PmtilesType : std::uint8_t { kMvt = 1, kPng = 2, kWebp = 4 };

/// What is told of all tiles together.
struct PmtilesFacts {
  PmtilesType type = PmtilesType::kPng;
  int min_zoom = 0, max_zoom = 0;
  GlobeBox
      bounds;  ///< West is above east across the antimeridian: the header goes around the Earth then.
};

struct PmtilesCounts {
  std::uint64_t tiles = 0;     ///< Tiles that a client may ask for.
  std::uint64_t entries = 0;   ///< Of directories: runs of equal tiles are one.
  std::uint64_t contents = 0;  ///< Tiles that differ.
  std::uint64_t leaves = 0;    ///< Leaf directories.
  std::uint64_t bytes = 0;     ///< Of the file.
};

/// Writes one file. Tiles lie in the order of their numbers, equal ones once (told by 128 bits of hash
/// and their length); directories and metadata are packed with gzip, tiles are as they come. Threads: one.
/// Memory: some 100 bytes for each tile that differs from those before.
class PmtilesWriter {
 public:
  /// @throws Error as OutputFile, SpillFile
  PmtilesWriter(const std::string& path, bool overwrite);

  /// REQUIRES: tiles come by ascending pmtiles_id().
  /// @throws Error as SpillFile; resource_exhausted  a tile of 4 GiB
  void add(const WebTile& tile, const std::string& bytes);
  /// Makes the file appear under its name.
  /// @throws Error as OutputFile
  PmtilesCounts publish(const PmtilesFacts& facts, const nlohmann::json& metadata);

 private:
  /// Of a directory: `run` tiles from `id` on have the same bytes; 0: a leaf directory.
  struct Entry {
    std::uint64_t id, offset;
    std::uint32_t length, run;
  };
  struct Directories {
    std::string root, leaves;
    std::uint64_t leaf_count = 0;
  };
  [[nodiscard]] static std::string directory(const Entry* begin, const Entry* end);
  [[nodiscard]] Directories directories() const;

  OutputFile out_;
  SpillFile tiles_;
  std::uint64_t tile_bytes_ = 0;
  PmtilesCounts counts_;
  std::vector<Entry> entries_;
  /// Where the bytes of a hash, with their length, were put.
  std::map<std::pair<std::pair<std::uint64_t, std::uint64_t>, std::uint64_t>, std::uint64_t> known_;
};

}  // namespace ptin::tools
