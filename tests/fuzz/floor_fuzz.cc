// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as the heights of a raster whose checksums are right: read tile by tile and together, with the
// same answers, packed again, and verified. Nothing may escape but an Error. Input: flags and the number of
// pages (3 bytes), then the root, then pages.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/file/read_only_file.h"
#include "storage/floor.h"
#include "storage/floor_page.h"
#include "storage/store_front.h"
#include "storage/verify_floor.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace ptin;
using fuzz::require;

constexpr std::uint64_t kMostPages = 400;  // two levels of nodes

using Page = std::array<std::byte, layout::kFloorPageBytes>;

/// Root, nodes and pages, one behind the other.
struct Sections {
  std::vector<layout::FloorNode> nodes;
  std::vector<Page> pages;
};

// Short inputs are repeated. Where they are to be repaired, numbers of entries and their order are right,
// so that most inputs get past them.
Sections made(const std::byte* data, std::size_t size, std::uint64_t pages, bool repairs) {
  layout::FloorNode root{};
  std::memcpy(&root, data, std::min(size, sizeof root));
  Sections s;
  s.pages.resize(pages);
  const std::size_t rest = size - std::min(size, sizeof root);
  const std::size_t given = std::max<std::size_t>((rest + sizeof(Page) - 1) / sizeof(Page), 1);
  for (std::uint64_t i = 0; i < pages; ++i) {
    const std::size_t at = i % given * sizeof(Page);
    if (at < rest) {
      std::memcpy(s.pages[i].data(), data + sizeof root + at, std::min(rest - at, sizeof(Page)));
    }
  }
  const FloorTree tree(pages);
  s.nodes.assign(tree.total_nodes(), root);
  std::vector<layout::FloorEntry> below(pages);
  for (std::uint64_t i = 0; i < pages; ++i) {
    below[i] = root.entry[i % layout::kFloorFanOut];
    if (repairs && i > 0) below[i].first = std::max(below[i].first, below[i - 1].first + 1);
    below[i].checksum = checksum_of(s.pages[i]);
  }
  for (std::size_t level = tree.levels(); level-- > 0;) {
    std::vector<layout::FloorEntry> here;
    for (std::uint64_t number = 0; number < tree.nodes(level); ++number) {
      layout::FloorNode& node = s.nodes[tree.position(level, number)];
      if (repairs) node.entries = tree.children(level, number);
      if (repairs && level == 0) node.pages = pages;
      std::copy_n(below.begin() + static_cast<std::ptrdiff_t>(number * layout::kFloorFanOut),
                  tree.children(level, number), node.entry.begin());
      here.push_back(node.entry[0]);
      here.back().checksum = checksum_of_object(node);
    }
    below = std::move(here);
  }
  return s;
}

bool is_void(const FloorTile& tile, std::size_t i) {
  return !tile.is_void.empty() && tile.is_void[i] != 0;
}
bool are_same(const FloorTile& a, const FloorTile& b) {
  if (a.width != b.width || a.height != b.height || a.lone != b.lone) return false;
  for (std::size_t i = 0; i < a.samples(); ++i) {
    if (is_void(a, i) != is_void(b, i)) return false;
    if (!is_void(a, i) && a.heights[i] != b.heights[i]) return false;
  }
  return true;
}

/// A tile that was read is packed and read again.
void pack_again(const FloorTile& tile) {
  std::vector<std::byte> bytes, again;
  append_floor_tile(tile, bytes);
  const std::size_t size = bytes.size();
  bytes.resize(size + kFloorTileTail);
  FloorTile back;
  require(read_floor_tile(std::span(bytes).first(size), tile.width, tile.height, back) == nullptr);
  require(are_same(tile, back));
  append_floor_tile(back, again);
  require(std::equal(again.begin(), again.end(), bytes.begin()) && again.size() == size);
}

void use(const Floor& floor) {
  const FloorShape& shape = floor.facts().shape;
  std::map<std::pair<std::uint32_t, std::uint32_t>, FloorTile> seen;
  IoCounters counters;
  try {
    floor.visit([](const Floor::Bounds&) { return true; },
                [&](const Floor::TileAt& at, const FloorTile& tile) {
                  require(seen.emplace(std::pair(at.column, at.row), tile).second);
                  return seen.size() < 500;
                },
                counters);
  } catch (const Error&) {
  }
  Floor::Page page;
  FloorTile tile;
  std::size_t packed = 0;
  for (const auto& [place, first] : seen) {
    floor.read(place.first, place.second, page, tile, counters);
    require(are_same(first, tile));
    if (packed++ < 20) pack_again(tile);
  }
  floor.read(shape.columns() - 1, shape.rows() - 1, page, tile, counters);
}

void verify(const ReadOnlyFile& file, const FloorPlace& place, const StoreFacts& facts) {
  StoreFront front{};
  front.facts = facts;
  front.floor = place;
  std::size_t faults = 0;
  verify_floor(
      file, front, [&](const std::string&, const std::string&) { ++faults; }, [] {});
}

}  // namespace

PTIN_FUZZ_TARGET(floor, data, size) {
  if (size < 4) {
    return 0;
  }
  const std::uint64_t pages = 1 + (data[1] + 256U * data[2]) % kMostPages;
  const Sections s =
      made(reinterpret_cast<const std::byte*>(data) + 3, size - 3, pages, data[0] % 4 != 3);
  const int fd = ::memfd_create("floor", MFD_CLOEXEC);
  const std::size_t node_bytes = s.nodes.size() * sizeof s.nodes[0];
  const std::size_t page_bytes = s.pages.size() * sizeof s.pages[0];
  if (fd < 0 || ::write(fd, s.nodes.data(), node_bytes) != static_cast<ssize_t>(node_bytes) ||
      ::write(fd, s.pages.data(), page_bytes) != static_cast<ssize_t>(page_bytes)) {
    return 0;
  }
  const ReadOnlyFile file("/proc/self/fd/" + std::to_string(fd));
  const FloorPlace place{0,
                         checksum_of_object(s.nodes[0]),
                         {layout::kNodeBytes, node_bytes - layout::kNodeBytes},
                         {node_bytes, page_bytes}};
  StoreFacts facts;
  facts.heights.type = data[0] % 2 == 0 ? HeightType::float32 : HeightType::int32;
  // Those of a file are not empty.
  const auto last = [](std::uint32_t samples) {
    return static_cast<std::int32_t>(std::max(samples % (1U << 30), 1U)) - 1;
  };
  facts.bounds = {0, 0, last(s.nodes[0].width), last(s.nodes[0].height)};
  try {
    use(Floor(file, place, facts));
  } catch (const Error&) {
  }
  verify(file, place, facts);
  ::close(fd);
  return 0;
}
