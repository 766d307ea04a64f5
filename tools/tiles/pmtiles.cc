// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/pmtiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <nlohmann/json.hpp>
#include <xxhash.h>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "tools/http/gzip.h"

namespace ptin::tools {

namespace {

constexpr std::size_t kPmtilesHeaderBytes = 127;
/// Header and root directory are read by one request (section 2).
constexpr std::size_t kMostRootBytes = 16384 - kPmtilesHeaderBytes;
/// Entries of a leaf directory at first; more where the root does not hold so many leaves.
constexpr std::size_t kLeafEntries = 4096;

void add_varint(std::string& bytes, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7U) bytes.push_back(static_cast<char>(value | 0x80U));
  bytes.push_back(static_cast<char>(value));
}

template <typename T>
void add_value(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::int32_t ten_millionths(double degrees) {
  return static_cast<std::int32_t>(std::lround(degrees * 1e7));
}

}  // namespace

std::uint64_t pmtiles_id(const WebTile& tile) noexcept {
  // Tiles of all zooms before: 1 + 4 + 16 + ...
  const std::uint64_t before = ((std::uint64_t{1} << 2U * static_cast<unsigned>(tile.z)) - 1) / 3;
  auto x = static_cast<std::uint32_t>(tile.x);
  auto y = static_cast<std::uint32_t>(tile.y);
  // The curve of order 32 exchanges the axes once for each of its 32 - z upper levels.
  if ((32 - tile.z) % 2 != 0) std::swap(x, y);
  return before + hilbert_position(x, y);
}

PmtilesWriter::PmtilesWriter(const std::string& path, bool overwrite)
    : out_(path, overwrite), tiles_(path) {}

void PmtilesWriter::add(const WebTile& tile, const std::string& bytes) {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::resource_exhausted, "a tile has more than 4 GiB");
  }
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  const auto [known, is_new] =
      known_.try_emplace({{hash.high64, hash.low64}, bytes.size()}, tile_bytes_);
  if (is_new) {
    tiles_.write(bytes.data(), bytes.size());
    tile_bytes_ += bytes.size();
    ++counts_.contents;
  }
  ++counts_.tiles;
  const std::uint64_t id = pmtiles_id(tile);
  const auto length = static_cast<std::uint32_t>(bytes.size());
  if (!entries_.empty()) {
    Entry& last = entries_.back();
    if (last.id + last.run == id && last.offset == known->second && last.length == length) {
      ++last.run;
      return;
    }
  }
  entries_.push_back({id, known->second, length, 1});
}

/// Columns of numbers: differences of tiles, runs, lengths, and offsets, 0 for one that follows the
/// tile before (section 4.2).
std::string PmtilesWriter::directory(const Entry* begin, const Entry* end) {
  std::string bytes;
  add_varint(bytes, static_cast<std::uint64_t>(end - begin));
  std::uint64_t before = 0;
  for (const Entry* e = begin; e != end; ++e) {
    add_varint(bytes, e->id - before);
    before = e->id;
  }
  for (const Entry* e = begin; e != end; ++e) add_varint(bytes, e->run);
  for (const Entry* e = begin; e != end; ++e) add_varint(bytes, e->length);
  for (const Entry* e = begin; e != end; ++e) {
    const bool follows = e != begin && e->offset == e[-1].offset + e[-1].length;
    add_varint(bytes, follows ? 0 : e->offset + 1);
  }
  return http::gzip(bytes);
}

PmtilesWriter::Directories PmtilesWriter::directories() const {
  const Entry* const begin = entries_.data();
  Directories made;
  made.root = directory(begin, begin + entries_.size());
  for (std::size_t size = kLeafEntries; made.root.size() > kMostRootBytes; size += size / 4) {
    made = {};
    std::vector<Entry> leaves;
    for (std::size_t i = 0; i < entries_.size(); i += size) {
      const std::string leaf = directory(begin + i, begin + std::min(i + size, entries_.size()));
      leaves.push_back(
          {entries_[i].id, made.leaves.size(), static_cast<std::uint32_t>(leaf.size()), 0});
      made.leaves += leaf;
    }
    made.leaf_count = leaves.size();
    made.root = directory(leaves.data(), leaves.data() + leaves.size());
  }
  return made;
}

PmtilesCounts PmtilesWriter::publish(const PmtilesFacts& facts, const nlohmann::json& metadata) {
  const Directories made = directories();
  const std::string told = http::gzip(metadata.dump());
  counts_.entries = entries_.size();
  counts_.leaves = made.leaf_count;
  const std::uint64_t metadata_at = kPmtilesHeaderBytes + made.root.size();
  const std::uint64_t leaves_at = metadata_at + told.size();
  const std::uint64_t tiles_at = leaves_at + made.leaves.size();
  counts_.bytes = tiles_at + tile_bytes_;
  std::string header = "PMTiles\x03";
  for (const std::uint64_t number :
       {std::uint64_t{kPmtilesHeaderBytes}, std::uint64_t{made.root.size()}, metadata_at,
        std::uint64_t{told.size()}, leaves_at, std::uint64_t{made.leaves.size()}, tiles_at,
        tile_bytes_, counts_.tiles, counts_.entries, counts_.contents}) {
    add_value(header, number);
  }
  constexpr std::uint8_t kIsClustered = 1, kGzip = 2, kNotPacked = 1;
  for (const std::uint8_t number :
       {kIsClustered, kGzip, kNotPacked, static_cast<std::uint8_t>(facts.type),
        static_cast<std::uint8_t>(facts.min_zoom), static_cast<std::uint8_t>(facts.max_zoom)}) {
    add_value(header, number);
  }
  const GlobeBox b = unwrapped(facts.bounds);
  for (const double degrees : {b.west, b.south, b.east, b.north}) {
    add_value(header, ten_millionths(degrees));
  }
  add_value(header, static_cast<std::uint8_t>((facts.min_zoom + facts.max_zoom) / 2));
  const MapPoint middle = middle_of(facts.bounds);
  add_value(header, ten_millionths(middle.x));
  add_value(header, ten_millionths(middle.y));
  out_.write(header);
  out_.write(made.root);
  out_.write(told);
  out_.write(made.leaves);
  for (std::span<const char> some = tiles_.read(); !some.empty(); some = tiles_.read()) {
    out_.write(some.data(), some.size());
  }
  out_.publish();
  return counts_;
}

}  // namespace ptin::tools
