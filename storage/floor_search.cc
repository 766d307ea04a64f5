// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pages of heights hold what is wanted: by the squares of the curve of tiles that their ranges of keys are.
#include <algorithm>
#include <bit>
#include <optional>
#include <queue>

#include "engine/error.h"
#include "storage/file/range_joiner.h"
#include "storage/floor.h"

namespace ptin {

namespace {

/// A square of tiles that is a run of the curve: 2^side_log2 tiles a side.
struct Square {
  std::uint64_t key;  ///< Of its first tile.
  std::uint32_t side_log2;

  [[nodiscard]] std::uint64_t end() const noexcept {
    return key + (std::uint64_t{1} << (2 * side_log2));
  }
  [[nodiscard]] Square quarter(std::uint32_t i) const noexcept {
    return {key + (std::uint64_t{i} << (2 * (side_log2 - 1))), side_log2 - 1};
  }
  /// Those of its tiles that a raster has.
  [[nodiscard]] std::optional<TileRange> tiles(const FloorShape& shape) const noexcept {
    const HilbertCell cell = hilbert_cell(key);
    const std::uint32_t rest = (1U << side_log2) - 1;
    const TileRange range{cell.x & ~rest, cell.y & ~rest,
                          std::min(cell.x | rest, shape.columns() - 1),
                          std::min(cell.y | rest, shape.rows() - 1)};
    if (range.first_column > range.last_column || range.first_row > range.last_row) {
      return std::nullopt;
    }
    return range;
  }
};

/// The smallest square that holds all tiles of a raster.
Square square_of(const FloorShape& shape) noexcept {
  const std::uint32_t most = std::max(shape.columns(), shape.rows());
  return {0, static_cast<std::uint32_t>(std::bit_width(most - 1))};
}

/// Whether the raster has a tile of a square whose key is not below `from`, and below `to`.
bool has_tile(const FloorShape& shape, Square square, std::uint64_t from, std::uint64_t to) {
  if (square.end() <= from || to <= square.key || !square.tiles(shape)) return false;
  if (from <= square.key && square.end() <= to) return true;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (has_tile(shape, square.quarter(i), from, to)) return true;
  }
  return false;
}

bool is_wanted(const Merit& merit, const Merit& cut_off) noexcept {
  return merit.value > -kInfinity && !merit.is_below(cut_off);
}

/// Finds the entries of a node that hold something above a cut-off. The keys of an entry fill few squares,
/// and of those that are large for a window the quarters tell more.
class EntriesOfNode {
 public:
  /// @param end    Key behind the node's tiles.
  /// @param merit_of  merit_of(tiles of a square, bounds of their heights): an upper bound of what is there.
  template <class MeritOf>
  EntriesOfNode(const FloorShape& shape, const layout::FloorNode& node, std::uint64_t end,
                Merit cut_off, const MeritOf& merit_of)
      : shape_(shape), node_(node), end_(std::min(end, square_of(shape).end())), cut_off_(cut_off) {
    descend(square_of(shape), 0, node.entries, merit_of);
  }
  struct Wanted {
    std::size_t entry;
    Merit merit;
  };
  /// Ascending.
  [[nodiscard]] const std::vector<Wanted>& wanted() const noexcept { return wanted_; }

 private:
  [[nodiscard]] std::uint64_t begin_of(std::size_t i) const noexcept {
    return node_.entry[i].first;
  }
  [[nodiscard]] std::uint64_t end_of(std::size_t i) const noexcept {
    return i + 1 < node_.entries ? node_.entry[i + 1].first : end_;
  }
  /// @param low, high  Entries among which are all that have tiles in the square.
  template <class MeritOf>
  void descend(Square square, std::size_t low, std::size_t high, const MeritOf& merit_of) {
    while (low < high && end_of(low) <= square.key) ++low;
    while (low < high && begin_of(high - 1) >= square.end()) --high;
    const std::optional<TileRange> tiles = low < high ? square.tiles(shape_) : std::nullopt;
    if (!tiles) return;
    FloorBounds heights;
    for (std::size_t i = low; i < high; ++i) {
      heights.join({node_.entry[i].least, node_.entry[i].greatest});
    }
    const Merit merit = merit_of(*tiles, heights);
    if (!is_wanted(merit, cut_off_)) return;
    const bool is_of_one =
        high - low == 1 && begin_of(low) <= square.key && square.end() <= end_of(low);
    if (is_of_one || square.side_log2 == 0) {
      take(low, merit);
      return;
    }
    for (std::uint32_t i = 0; i < 4; ++i) descend(square.quarter(i), low, high, merit_of);
  }
  void take(std::size_t entry, Merit merit) {
    if (wanted_.empty() || wanted_.back().entry != entry) {
      wanted_.push_back({entry, merit});
    } else if (wanted_.back().merit.is_below(merit)) {
      wanted_.back().merit = merit;
    }
  }

  const FloorShape& shape_;
  const layout::FloorNode& node_;
  std::uint64_t end_;
  Merit cut_off_;
  std::vector<Wanted> wanted_;
};

}  // namespace

Floor::Bounds Floor::bounds_of(const TileRange& tiles, OrderedHeight least,
                               OrderedHeight greatest) const {
  Bounds bounds{facts_.shape.samples_of(tiles), {}};
  if (least <= greatest) {
    bounds.codes = {heights_.code(numbers_.bits(least)), heights_.code(numbers_.bits(greatest))};
  }
  return bounds;
}

void Floor::expand(const Found& found, const Bound& bound, Merit cut_off, std::vector<Found>& below,
                   Recent& recent, IoCounters& counters) const {
  const layout::FloorNode& here = node(found, recent, counters);
  const EntriesOfNode entries(facts_.shape, here, found.end, cut_off,
                              [&](const TileRange& tiles, const FloorBounds& heights) {
                                return bound(bounds_of(tiles, heights.least, heights.greatest));
                              });
  for (const EntriesOfNode::Wanted& wanted : entries.wanted()) {
    const std::size_t next = wanted.entry + 1;
    below.push_back({found.number * layout::kFloorFanOut + wanted.entry,
                     next < here.entries ? here.entry[next].first : found.end,
                     here.entry[wanted.entry], found.level + 1, wanted.merit});
  }
}

void Floor::announce(const std::vector<Found>& found, const Recent& recent, IoCounters& counters,
                     Coming coming) const {
  const auto is_recent = [&](const Found& f) {
    return f.level == tree_.levels() &&
           recent.pages_[f.number % recent.pages_.size()].number == f.number;
  };
  RangesToCome ranges(file_, counters, coming);
  for (const bool is_page : {false, true}) {
    RangeJoiner joiner(is_page ? place_.pages.offset : place_.nodes.offset, layout::kFloorPageBytes,
                       ranges);
    for (const Found& f : found) {
      if ((f.level == tree_.levels()) == is_page && !is_recent(f)) {
        joiner.add(is_page ? f.number : tree_.position(f.level, f.number) - 1);
      }
    }
  }
}

std::vector<Floor::Found> Floor::find_pages(const Bound& bound, Merit cut_off, Recent& recent,
                                            IoCounters& counters) const {
  std::vector<Found> found{root()}, below;
  for (std::size_t level = 0; level < tree_.levels(); ++level) {
    below.clear();
    for (const Found& node : found) expand(node, bound, cut_off, below, recent, counters);
    found.swap(below);
    const bool are_pages = level + 1 == tree_.levels();
    // Nodes of a near file are at hand, most of them verified before.
    if (are_pages || file_.is_far()) announce(found, recent, counters);
  }
  return found;
}

/// A tile that is not there would be taken for one without heights: where the raster has tiles whose keys
/// are passed over, the file is damaged.
void Floor::check_none(std::uint64_t from, std::uint64_t to) const {
  if (from < to && has_tile(facts_.shape, square_of(facts_.shape), from, to)) {
    damaged("a page of heights lacks a tile of the raster");
  }
}

template <class Visit>
bool Floor::visit_tiles(const Recent::Page& page, const Visit& visit) const {
  const FloorPageView view = page.view();
  std::uint64_t next = page.first;
  for (std::size_t i = 0; i < view.tiles(); ++i) {
    const std::uint64_t key = page.first + view.key(i);
    check_none(next, key);
    next = key + 1;
    const HilbertCell cell = hilbert_cell(key);
    if (cell.x >= facts_.shape.columns() || cell.y >= facts_.shape.rows()) {
      damaged("a page of heights has a tile beside the raster");
    }
    const FloorBounds heights = view.heights(i);
    if (!visit(i, TileAt{cell.x, cell.y,
                         bounds_of({cell.x, cell.y, cell.x, cell.y}, heights.least,
                                   heights.greatest)})) {
      return false;
    }
  }
  check_none(next, page.end);
  return true;
}

bool Floor::visit(const std::function<bool(const Bounds&)>& wants, const TakeTile& take,
                  Recent& recent, IoCounters& counters) const {
  const auto bound = [&](const Bounds& b) { return wants(b) ? kBestMerit : kNoMerit; };
  FloorTile tile;
  for (const Found& found : find_pages(bound, kNoMerit, recent, counters)) {
    const Recent::Page& page = read_page(found, recent, counters);
    const bool goes_on = visit_tiles(page, [&](std::size_t i, const TileAt& at) {
      if (!wants(at.bounds)) return true;
      decode(page, i, at.column, at.row, tile);
      return take(at, tile);
    });
    if (!goes_on) return false;
  }
  return true;
}

void Floor::visit_best_first(BestVisitor& visitor, Merit cut_off, Recent& recent,
                             IoCounters& counters) const {
  const auto bound = [&](const Bounds& b) { return visitor.bound(b); };
  const auto is_worse = [](const Found& a,
                           const Found& b) {  // among equal ones the first of the file
    return a.merit.is_below(b.merit) || (!b.merit.is_below(a.merit) && a.number > b.number);
  };
  std::vector<Found> first{root()}, below;
  first.front().merit = kBestMerit;
  if (visitor.wants_all()) first = find_pages(bound, cut_off, recent, counters);
  std::priority_queue queue(is_worse, std::move(first));
  FloorTile tile;
  for (; !queue.empty() && is_wanted(queue.top().merit, cut_off);) {
    const Found found = queue.top();
    queue.pop();
    if (found.level < tree_.levels()) {
      below.clear();
      expand(found, bound, cut_off, below, recent, counters);
      for (const Found& f : below) queue.push(f);
      continue;
    }
    const Recent::Page& page = read_page(found, recent, counters);
    visit_tiles(page, [&](std::size_t i, const TileAt& at) {
      if (is_wanted(visitor.bound(at.bounds), cut_off)) {
        decode(page, i, at.column, at.row, tile);
        cut_off = visitor.visit(at, tile, found.merit);
      }
      return true;
    });
  }
}

}  // namespace ptin
