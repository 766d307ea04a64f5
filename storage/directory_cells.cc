// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/directory_cells.h"

#include <algorithm>
#include <cstring>

#include "engine/check.h"

namespace ptin {

DirectoryCells::Halves DirectoryCells::halves_of(const Part& part) const noexcept {
  const std::uint32_t middle = part.begin + (part.end - part.begin) / 2;
  const std::uint32_t line = lines_[middle];
  Halves h{{part.begin, middle, part.box},
           {middle, part.end, part.box},
           (line & layout::kLineOfEqualY) != 0,
           static_cast<std::int32_t>(line & ~layout::kLineOfEqualY)};
  (h.is_of_y ? h.low.box.max_y : h.low.box.max_x) = h.line;
  (h.is_of_y ? h.high.box.min_y : h.high.box.min_x) = h.line;
  return h;
}

bool DirectoryCells::is_sound() const {
  return count() > 0 && lines_[0] == 0 && is_sound({0, count(), bounds_});
}

bool DirectoryCells::is_sound(const Part& part) const {
  if (part.end - part.begin == 1) {
    return true;
  }
  const Halves h = halves_of(part);
  return !is_empty(h.low.box) && !is_empty(h.high.box) && is_sound(h.low) && is_sound(h.high);
}

DirectoryCells::Cell DirectoryCells::cell_of(GridPoint p) const noexcept {
  Part part{0, count(), bounds_};
  while (part.end - part.begin > 1) {
    const Halves h = halves_of(part);
    part = (h.is_of_y ? p.y : p.x) < h.line ? h.low : h.high;
  }
  return {part.begin, part.box};
}

namespace {

/// Sets the lines of the cells [begin, end), in whose box these points lie.
void cut(std::vector<std::uint32_t>& lines, std::uint32_t begin, std::uint32_t end,
         const GridBox& box, std::span<GridPoint> points) {
  if (end - begin == 1) {
    return;
  }
  const std::uint32_t middle = begin + (end - begin) / 2;
  GridBox around;  // A box of the points: the domain may be empty for the most part.
  for (const GridPoint p : points) {
    around = united(around, p);
  }
  if (points.empty()) {
    around = box;
  }
  const bool is_of_y = std::int64_t{around.max_y} - around.min_y >  //
                       std::int64_t{around.max_x} - around.min_x;
  const auto at = [&](GridPoint p) { return is_of_y ? p.y : p.x; };
  const std::size_t below = points.size() * (middle - begin) / (end - begin);
  std::int32_t line = is_of_y ? box.min_y : box.min_x;
  if (!points.empty()) {
    const auto cut_at = points.begin() + static_cast<std::ptrdiff_t>(below);
    std::nth_element(points.begin(), cut_at, points.end(), [&](GridPoint a, GridPoint b) {
      return at(a) != at(b) ? at(a) < at(b) : (is_of_y ? a.x < b.x : a.y < b.y);
    });
    line = std::clamp(at(*cut_at), line, is_of_y ? box.max_y : box.max_x);
  }
  lines[middle] = static_cast<std::uint32_t>(line) | (is_of_y ? layout::kLineOfEqualY : 0U);
  GridBox low = box, high = box;
  (is_of_y ? low.max_y : low.max_x) = line;
  (is_of_y ? high.min_y : high.min_x) = line;
  cut(lines, begin, middle, low, points.first(below));
  cut(lines, middle, end, high, points.subspan(below));
}

constexpr std::int64_t kCellWidth = 255;

}  // namespace

DirectoryCells make_cells(const GridBox& bounds, std::uint32_t count, std::span<GridPoint> points) {
  std::vector<std::uint32_t> lines(count);
  cut(lines, 0, count, bounds, points);
  return {bounds, std::move(lines)};
}

std::array<std::uint8_t, 4> box_in_cell(const GridBox& box, const GridBox& cell) noexcept {
  const auto low = [](std::int64_t v, std::int64_t min, std::int64_t max) {
    const std::int64_t width = std::max<std::int64_t>(max - min, 1);
    return static_cast<std::uint8_t>((std::clamp(v, min, max) - min) * kCellWidth / width);
  };
  const auto high = [](std::int64_t v, std::int64_t min, std::int64_t max) {
    const std::int64_t width = std::max<std::int64_t>(max - min, 1);
    return static_cast<std::uint8_t>(((std::clamp(v, min, max) - min) * kCellWidth + width - 1) /
                                     width);
  };
  return {low(box.min_x, cell.min_x, cell.max_x), low(box.min_y, cell.min_y, cell.max_y),
          high(box.max_x, cell.min_x, cell.max_x), high(box.max_y, cell.min_y, cell.max_y)};
}

GridBox box_of_bytes(const std::array<std::uint8_t, 4>& bytes, const GridBox& cell) noexcept {
  const auto low = [](std::int64_t byte, std::int64_t min, std::int64_t max) {
    return static_cast<std::int32_t>(min + byte * (max - min) / kCellWidth);
  };
  const auto high = [](std::int64_t byte, std::int64_t min, std::int64_t max) {
    return static_cast<std::int32_t>(min + (byte * (max - min) + kCellWidth - 1) / kCellWidth);
  };
  return {low(bytes[0], cell.min_x, cell.max_x), low(bytes[1], cell.min_y, cell.max_y),
          high(bytes[2], cell.min_x, cell.max_x), high(bytes[3], cell.min_y, cell.max_y)};
}

namespace {

GridBox star_box_of(const layout::NodeEntry& e) {
  return {e.star_min_x, e.star_min_y, e.star_max_x, e.star_max_y};
}

/// Where entry `i` of a node of `count` lies in each of its columns.
struct Columns {
  std::size_t page, checksum, box, error, death;
  Columns(std::size_t count, std::size_t i)
      : page(4 * i),
        checksum(4 * (count + i)),
        box(4 * (2 * count + i)),
        error(12 * count + i),
        death(13 * count + i) {}
};

void put(std::byte* node, std::size_t count, std::size_t i, const layout::DirectoryEntry& e) {
  const Columns at(count, i);
  std::memcpy(node + at.page, &e.page, sizeof e.page);
  std::memcpy(node + at.checksum, &e.checksum, sizeof e.checksum);
  std::memcpy(node + at.box, e.box.data(), e.box.size());
  node[at.error] = static_cast<std::byte>(e.error_max);
  node[at.death] = static_cast<std::byte>(e.death_min);
}

}  // namespace

layout::DirectoryEntry DirectoryNode::entry(std::size_t i) const noexcept {
  const Columns at(count_, i);
  layout::DirectoryEntry e{};
  std::memcpy(&e.page, bytes_.data() + at.page, sizeof e.page);
  std::memcpy(&e.checksum, bytes_.data() + at.checksum, sizeof e.checksum);
  std::memcpy(e.box.data(), bytes_.data() + at.box, e.box.size());
  e.error_max = static_cast<std::uint8_t>(bytes_[at.error]);
  e.death_min = static_cast<std::uint8_t>(bytes_[at.death]);
  return e;
}

std::vector<std::uint64_t> count_entries(const DirectoryCells& cells, const PageWalk& walk) {
  std::vector<std::uint64_t> entries(cells.count());
  walk([&](std::uint64_t, const layout::NodeEntry& d) {
    cells.for_each(star_box_of(d), [&](const DirectoryCells::Cell& c) { ++entries[c.number]; });
  });
  return entries;
}

void make_directory_nodes(
    const DirectoryCells& cells, std::span<const std::uint64_t> entries,
    const DirectoryScale& scale, const PageWalk& walk,
    const std::function<void(std::uint32_t cell, std::span<const std::byte> node)>& take) {
  std::vector<std::byte> bytes;
  std::vector<std::size_t> begin, filled;  // of each cell of the run
  for (std::uint32_t first = 0; first < cells.count();) {
    std::uint32_t last = first;
    std::size_t total = 0;
    begin.clear();
    do {
      begin.push_back(total);
      total += entries[last] * layout::kDirectoryEntryBytes;
      ++last;
    } while (last < cells.count() &&
             total + entries[last] * layout::kDirectoryEntryBytes <= kDirectoryRunBytes);
    bytes.assign(total, std::byte{0});
    filled.assign(last - first, 0);
    walk([&](std::uint64_t page, const layout::NodeEntry& d) {
      cells.for_each(star_box_of(d), [&](const DirectoryCells::Cell& c) {
        if (c.number < first || c.number >= last) {
          return;
        }
        std::size_t& next = filled[c.number - first];
        PTIN_CHECK(next < entries[c.number]);
        put(bytes.data() + begin[c.number - first], entries[c.number], next++,
            {static_cast<std::uint32_t>(page),
             static_cast<std::uint32_t>(d.checksum),
             box_in_cell(star_box_of(d), c.box),
             scale.byte_of_error(d.error_max),
             scale.byte_of_death(d.death_min),
             {}});
      });
    });
    for (std::uint32_t cell = first; cell < last; ++cell) {
      take(cell, std::span(bytes).subspan(begin[cell - first],
                                          entries[cell] * layout::kDirectoryEntryBytes));
    }
    first = last;
  }
}

}  // namespace ptin
