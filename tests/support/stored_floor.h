// SPDX-License-Identifier: GPL-3.0-or-later
//
// The heights of a raster in a file, taken out, changed and put back with every checksum right, so that only
// a look at what they mean can find the lie.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "storage/file/checksum.h"
#include "storage/floor.h"
#include "storage/floor_writer.h"
#include "storage/store_file.h"
#include "tests/storage/seal.h"

namespace ptin::test {

/// The heights of a raster: facts, and tiles by their keys.
struct StoredFloor {
  FloorFacts facts;
  std::map<std::uint64_t, FloorTile> tiles;
};

inline StoredFloor floor_of(const StoreFile& store) {
  StoredFloor result;
  const Floor& floor = *store.floor();
  result.facts = floor.facts();
  IoCounters counters;
  Floor::Recent recent;
  floor.visit([](const Floor::Bounds&) { return true; },
              [&](const Floor::TileAt& at, const FloorTile& tile) {
                result.tiles.emplace(FloorShape::key(at.column, at.row), tile);
                return true;
              },
              recent, counters);
  return result;
}

/// A file as bytes that sections are taken from, and bytes as what a file holds.
inline Bytes bytes_of(const std::string& file) {
  const auto* const first = reinterpret_cast<const std::byte*>(file.data());
  return {first, first + file.size()};
}
inline std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What a file has in its sections of heights.
struct FloorSections {
  layout::FloorNode root;
  std::vector<layout::FloorNode> nodes;  ///< Below the root.
  Bytes pages;

  [[nodiscard]] FloorTree tree() const { return FloorTree(pages.size() / layout::kFloorPageBytes); }
  [[nodiscard]] layout::FloorNode& node(std::size_t level, std::uint64_t number) {
    const std::uint64_t position = tree().position(level, number);
    return position == 0 ? root : nodes.at(position - 1);
  }
  [[nodiscard]] std::span<std::byte> page(std::uint64_t number) {
    return std::span(pages).subspan(number * layout::kFloorPageBytes, layout::kFloorPageBytes);
  }
};

inline FloorSections sections_of(const StoredFloor& floor) {
  FloorSections result;
  FloorWriter writer([&](std::span<const std::byte> page) {
    result.pages.insert(result.pages.end(), page.begin(), page.end());
  });
  for (const auto& [key, tile] : floor.tiles) {
    if (!writer.add(key, tile)) throw std::runtime_error("a tile does not fit");
  }
  writer.finish();
  result.nodes = writer.nodes(floor.facts);
  result.root = result.nodes.front();
  result.nodes.erase(result.nodes.begin());
  return result;
}

inline FloorSections floor_sections_of(const Bytes& file) {
  FloorSections result;
  const auto root = section_of(file, layout::SectionKind::kFloorRoot);
  const auto nodes = section_of(file, layout::SectionKind::kFloorNodes);
  const auto pages = section_of(file, layout::SectionKind::kFloorPages);
  result.root = object_at<layout::FloorNode>(file, root.offset);
  result.nodes.resize(nodes.bytes / layout::kNodeBytes);
  std::memcpy(result.nodes.data(), file.data() + nodes.offset, nodes.bytes);
  result.pages.assign(file.begin() + static_cast<std::ptrdiff_t>(pages.offset), file.end());
  return result;
}

/// The file with other sections of heights, sealed: the root in its place, the others at the end.
inline Bytes with_floor(const Bytes& file, const FloorSections& floor) {
  std::vector<layout::SectionEntry> sections = sections_of(file);
  Bytes result(file.begin(),
               file.begin() + static_cast<std::ptrdiff_t>(sections.at(sections.size() - 2).offset));
  set_object(result, section_of(file, layout::SectionKind::kFloorRoot).offset, floor.root);
  const auto put = [&](std::size_t section, std::span<const std::byte> bytes) {
    sections[section].offset = result.size();
    sections[section].bytes = bytes.size();
    result.insert(result.end(), bytes.begin(), bytes.end());
  };
  put(sections.size() - 2, std::as_bytes(std::span(floor.nodes)));
  put(sections.size() - 1, floor.pages);
  set_sections(result, sections);
  layout::FileHeader header = header_of(result);
  header.file_bytes = result.size();
  set_header(result, header);
  seal(result);
  return result;
}

}  // namespace ptin::test
