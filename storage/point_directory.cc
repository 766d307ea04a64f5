// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/point_directory.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "storage/file/checksum.h"
#include "storage/file/range_joiner.h"

namespace ptin {

namespace {

[[noreturn]] void damaged(const ReadableFile& file, const std::string& message) {
  throw Error(ErrorCode::corruption, message, file.path());
}

template <class T>
std::vector<T> column(std::span<const std::byte> bytes, std::size_t offset, std::size_t count) {
  std::vector<T> result(count);
  std::memcpy(result.data(), bytes.data() + offset, count * sizeof(T));
  return result;
}

/// The less, the sooner a page will be found to hold a place: a small box is mostly covered by its
/// triangles, and of two boxes of one size those of the smaller error leave less of it to others.
double rarity(const DirectoryPage& p) {
  return (static_cast<double>(p.box.max_x) - p.box.min_x + 1) *
         (static_cast<double>(p.box.max_y) - p.box.min_y + 1) * short_value(p.error_max);
}

/// A box of the grid with a unit around it.
GridBox grown(const GridBox& b) { return {b.min_x - 1, b.min_y - 1, b.max_x + 1, b.max_y + 1}; }

}  // namespace

DirectoryRoot DirectoryRoot::read(const ReadableFile& file, const DirectoryPlace& place,
                                  const GridBox& bounds) {
  std::vector<std::byte> bytes(place.root.bytes);
  file.read_at(bytes, place.root.offset);
  if (checksum_of(bytes) != place.root_checksum) {
    damaged(file, "the section \"directory\" does not match its checksum; the file is damaged");
  }
  layout::DirectoryHead head{};
  std::memcpy(&head, bytes.data(), sizeof head);
  const std::size_t cells = head.cells;
  if (bytes.size() != sizeof head + cells * layout::kDirectoryCellBytes ||
      head.entries != place.nodes.bytes / layout::kDirectoryEntryBytes) {
    damaged(file, "the directory says another number of cells or entries than it has");
  }
  DirectoryRoot root{{bounds, column<std::uint32_t>(bytes, sizeof head + 4 * cells, cells)},
                     {head.least, head.step_shift},
                     column<std::uint32_t>(bytes, sizeof head, cells),
                     {}};
  std::uint64_t sum = 0;
  for (const std::uint16_t entries : column<std::uint16_t>(bytes, sizeof head + 8 * cells, cells)) {
    root.end.push_back(sum += entries);
  }
  if (sum != head.entries || !root.cells.is_sound() || !root.scale.is_sound()) {
    damaged(file, "the directory has cells that no program made");
  }
  return root;
}

const DirectoryRoot& PointDirectory::root() const {
  const std::lock_guard lock(mutex_);
  if (!root_) {
    root_ = std::make_unique<const DirectoryRoot>(DirectoryRoot::read(file_, place_, bounds_));
  }
  return *root_;
}

ByteRange PointDirectory::range_of(const DirectoryRoot& root, std::uint32_t cell) const noexcept {
  const ByteRange range = root.range_of(cell);
  return {place_.nodes.offset + range.offset, range.bytes};
}

/// Reads and verifies the node of a cell, and calls visit(const DirectoryPage&) for those pages that
/// may have stars that live at the filter's level.
template <class Visit>
void PointDirectory::read_node(const DirectoryRoot& root, const DirectoryCells::Cell& cell,
                               const StarFilter& filter, IoCounters& counters,
                               const Visit& visit) const {
  const auto place = [&] {
    return file_.path() + ", directory node " + std::to_string(cell.number);
  };
  const ByteRange range = range_of(root, cell.number);
  std::vector<std::byte> bytes(range.bytes);
  if (!bytes.empty()) {
    file_.read_at(bytes, range.offset);
  }
  ++counters.index_nodes;
  counters.bytes_read += bytes.size();
  if (static_cast<std::uint32_t>(checksum_of(bytes)) != root.checksums[cell.number]) {
    throw Error(
        ErrorCode::corruption,
        "the node does not match the checksum that the directory holds; the file is damaged",
        place());
  }
  const std::int32_t level = level_bits(filter.level);
  const DirectoryNode node(bytes);
  for (std::size_t i = 0; i < node.count(); ++i) {
    const layout::DirectoryEntry e = node.entry(i);
    const std::optional<std::uint64_t> number = pages_.page(e.page);
    if (!number) {
      throw Error(ErrorCode::corruption, "the node names a page that is not there", place());
    }
    const DirectoryPage page{PageId{*number}, e.checksum, box_of_bytes(e.box, cell.box),
                             root.scale.error_of(e.error_max), root.scale.death_of(e.death_min)};
    if (page.error_max > level - (filter.with_ties ? 1 : 0) && page.death_min <= level + 1) {
      visit(page);
    }
  }
}

void PointDirectory::find(std::span<const GridBox> places, const StarFilter& filter,
                          std::span<std::vector<DirectoryPage>> found, IoCounters& counters) const {
  struct Asked {
    DirectoryCells::Cell cell;
    std::size_t place;
  };
  const DirectoryRoot& root = this->root();
  std::vector<Asked> asked;
  for (std::size_t i = 0; i < places.size(); ++i) {
    found[i].clear();
    asked.push_back({root.cells.cell_of({places[i].min_x, places[i].min_y}), i});
  }
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) {
    return a.cell.number != b.cell.number ? a.cell.number < b.cell.number : a.place < b.place;
  });
  {
    RangesToCome ranges(file_, counters);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (i == 0 || asked[i].cell.number != asked[i - 1].cell.number) {
        ranges.add(range_of(root, asked[i].cell.number));
      }
    }
  }
  for (auto at = asked.begin(); at != asked.end();) {
    const DirectoryCells::Cell cell = at->cell;
    const auto next =
        std::find_if(at, asked.end(), [&](const Asked& a) { return a.cell.number != cell.number; });
    read_node(root, cell, filter, counters, [&](const DirectoryPage& page) {
      for (auto a = at; a != next; ++a) {
        if (contains(page.box, places[a->place])) {
          found[a->place].push_back(page);
        }
      }
    });
    at = next;
  }
  for (std::vector<DirectoryPage>& pages : found) {
    std::sort(pages.begin(), pages.end(), [](const DirectoryPage& a, const DirectoryPage& b) {
      const double x = rarity(a), y = rarity(b);
      return x != y ? x < y : a.id < b.id;
    });
  }
  file_.settle(counters);
}

std::uint64_t PointDirectory::bytes_for(const GridBox& box) const {
  const DirectoryRoot& root = this->root();
  std::uint64_t bytes = 0;
  root.cells.for_each(
      box, [&](const DirectoryCells::Cell& c) { bytes += range_of(root, c.number).bytes; });
  return bytes;
}

void PointDirectory::find_in(const StarFilter& filter, std::vector<DirectoryPage>& pages,
                             IoCounters& counters) const {
  const DirectoryRoot& root = this->root();
  {
    RangesToCome ranges(file_, counters);
    root.cells.for_each(
        filter.box, [&](const DirectoryCells::Cell& c) { ranges.add(range_of(root, c.number)); });
  }
  std::vector<DirectoryPage> named;
  root.cells.for_each(filter.box, [&](const DirectoryCells::Cell& cell) {
    read_node(root, cell, filter, counters, [&](const DirectoryPage& page) {
      // The part of the stars within the reach lies in some cell; regions are rounded outwards.
      const StarAttributes cut{grown(page.box), kAllHeights, short_value(page.error_max),
                               -kInfinity};
      if (meets(page.box, filter.box) && (filter.also == nullptr || filter.also->may_hold(cut))) {
        named.push_back(page);
      }
    });
  });
  file_.settle(counters);
  std::sort(named.begin(), named.end(),
            [](const DirectoryPage& a, const DirectoryPage& b) { return a.id < b.id; });
  for (const DirectoryPage& page : named) {
    if (!pages.empty() && pages.back().id == page.id) {
      pages.back().box = united(pages.back().box, page.box);
    } else {
      pages.push_back(page);
    }
  }
}

}  // namespace ptin
