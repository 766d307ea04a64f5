// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/hierarchy_check.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/key_table.h"
#include "engine/large_array.h"
#include "engine/mesh/split.h"
#include "engine/mesh/star.h"
#include "engine/mesh/validate.h"
#include "engine/query/refine/floor_check.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/refine/split_site.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/retrieval.h"
#include "engine/query/shape/grid_cell.h"
#include "engine/stop.h"

namespace ptin {

namespace {

struct EnoughFaults {};  // thrown by report(), caught by check_hierarchy()

/// A record of a cell.
struct CellRecord {
  VertexSplit split;
  std::uint32_t page;          ///< Modulo 2^32, for faults.
  std::uint32_t degree;        ///< Corners of its ring.
  std::uint64_t first_corner;  ///< First corner of its ring, among all of the cell.
};

/// The most that the check of a cell takes.
struct CellLoad {
  std::uint64_t records, bytes;
};

/// About so many corners have rings at most, over a page.
constexpr std::uint64_t kMostCorners = 8;

/// Cells are cut until they take no more than this, so that their mesh stays in the caches.
constexpr std::uint64_t kCellBytes = std::uint64_t{64} << 20;

/// validate() keeps a set of the keys, and two numbers, for each vertex.
constexpr std::uint64_t kValidationBytes = 64;

/// Bytes that a cell of so many records takes at most, beside T0.
std::uint64_t cell_bytes(std::uint64_t records) {
  constexpr std::uint64_t kVertexBytes = sizeof(Vertex) + 1 + kValidationBytes;
  constexpr std::uint64_t kTriangleBytes =
      sizeof(Triangle) + sizeof(TriangleClass) + sizeof(std::uint32_t);
  return records * (sizeof(CellRecord) + kMostCorners * sizeof(RingCorner) + sizeof(std::uint32_t) +
                    kVertexBytes + 2 * kTriangleBytes) +
         KeyTable::bytes_for(records);
}

std::string text_of(GridPoint p) {
  return "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ")";
}
std::string text_of(const GridBox& b) {
  return text_of(GridPoint{b.min_x, b.min_y}) + " to " + text_of(GridPoint{b.max_x, b.max_y});
}
std::string text_of(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", v);
  return text;
}
std::string text_of(const Interval& codes, const HeightEncoding& heights) {
  return is_empty(codes) ? "none"
                         : text_of(heights.height_of_code(codes.lo)) + " to " +
                               text_of(heights.height_of_code(codes.hi));
}

/// "page 17, record of vertex (3, 4)".
std::string name_of(const CellRecord& r) {
  return "page " + std::to_string(r.page) + ", record of vertex " + text_of(r.split.u);
}

class HierarchyCheck {
 public:
  HierarchyCheck(const OpenedTerrain& terrain, const HierarchyRequest& request,
                 HierarchyReport& report)
      : terrain_(terrain),
        heights_(terrain.store().facts().heights),
        request_(request),
        context_(request.limits, terrain.store().path()),
        report_(report) {
    if (const Floor* const floor = terrain.store().floor()) {
      floor_.emplace(*floor, terrain.store().facts());
    }
  }

  void run();

 private:
  void report(std::string what, std::string where);
  [[nodiscard]] CellLoad load_of(const GridBox& box);
  [[nodiscard]] std::uint64_t bytes_for(std::uint64_t records) const;
  [[nodiscard]] std::uint64_t reaching_into(const GridBox& box, std::span<const PageId> pages);
  void look_into(const GridCell& cell);
  void read(const GridBox& box, std::uint64_t most);
  void apply_all(const GridCell& cell);
  void look_at_floor(const GridCell& cell);
  [[nodiscard]] std::string apply(const VertexSplit& r, Star& star, SplitResult& made);
  [[nodiscard]] std::string fault_in_needs(const VertexSplit& r, const Star& star,
                                           const SplitResult& made) const;
  [[nodiscard]] std::string fault_against(const VertexSplit& r, const CellRecord& needed) const;
  [[nodiscard]] std::string fault_in_star(const CellRecord& r, const Star& star) const;
  [[nodiscard]] std::string fault_in_deaths(const VertexSplit& r, const Star& star,
                                            const SplitResult& made);
  [[nodiscard]] float death_of(TriangleId t, const VertexSplit& r, const Star& star,
                               std::size_t i) const;
  void count_deaths(const CellRecord& r);
  void compare_deaths();
  [[nodiscard]] std::span<const RingCorner> ring_of(const CellRecord& r) const {
    return std::span(corners_).subspan(r.first_corner, r.degree);
  }

  const OpenedTerrain& terrain_;
  const HeightEncoding& heights_;
  const HierarchyRequest& request_;
  QueryContext context_;
  HierarchyReport& report_;
  std::set<std::string> told_;       ///< A record that is not applied is met in many cells.
  std::uint64_t dying_ = 0;          ///< Triangles of stars and T0 that are said to die.
  std::uint64_t deaths_ = 0;         ///< Triangles that a record replaces.
  std::optional<FloorCheck> floor_;  ///< None: the file has no heights of a raster.

  // The cell at hand:
  std::vector<CellRecord> records_;
  std::vector<RingCorner> corners_;
  std::vector<std::uint32_t> order_;
  Tin tin_;
  KeyTable ids_;
  std::vector<std::uint32_t> makers_;  ///< For each triangle its maker in records_; kNone: T0.
};

void HierarchyCheck::report(std::string what, std::string where) {
  if (report_.faults.size() >= request_.max_faults) {
    report_.stopped_early = true;
    throw EnoughFaults{};
  }
  report_.faults.push_back({std::move(what), std::move(where)});
}

void HierarchyCheck::run() {
  const StoreFile& store = terrain_.store();
  const std::uint64_t limit = request_.limits.memory_bytes;
  const auto is_small_enough = [&](const GridCell& cell, double share) {
    const std::uint64_t even =
        cell_bytes(static_cast<std::uint64_t>(static_cast<double>(store.record_count()) * share));
    // A search of the index lists all pages: not worth it for cells that are far too large anyway.
    if (even / 16 > std::min(limit, kCellBytes)) return false;
    const std::uint64_t bytes = load_of(cell.box()).bytes;
    // Four times the share: mostly records that reach beyond the cell, and would be applied again
    // in each of its parts.
    return bytes <= std::min(limit, kCellBytes) || (bytes <= limit && bytes / 4 > even);
  };
  work_on_cells(store.facts().bounds, [&](const GridCell& cell, double share, double done) {
    context_.check_stop();
    if (cell.level > 0 && !is_small_enough(cell, share)) return false;
    look_into(cell);
    if (request_.progress) request_.progress(done);
    return true;
  });
  store.pages().check_unchanged();
  if (report_.is_sound() && report_.records != store.record_count()) {
    report("records lie in no part of the domain: " + std::to_string(store.record_count()) +
               " are counted, " + std::to_string(report_.records) + " found",
           "the records");
  }
  compare_deaths();
}

/// Every triangle that a record replaces was found to die at its error. No star has more triangles
/// that die when there are no more in all.
void HierarchyCheck::compare_deaths() {
  for (const CoarsestTin::T& t : terrain_.store().t0().triangles) {
    dying_ += t.death != kLivesOn ? 1 : 0;
  }
  if (report_.is_sound() && dying_ != deaths_) {
    report(std::to_string(dying_) + " triangles are said to die, and records replace " +
               std::to_string(deaths_),
           "the stars");
  }
}

CellLoad HierarchyCheck::load_of(const GridBox& box) {
  std::vector<PageId> pages;
  terrain_.index().search(MeetsBox(box), pages, context_.cost.io);
  std::uint64_t records = most_records(terrain_.store(), pages);
  // Pages of a small cell hold mostly records that do not reach into it. To count them takes as long as
  // to read them, so it is done where it may decide.
  const std::uint64_t limit = request_.limits.memory_bytes;
  if (bytes_for(records) > limit && bytes_for(records / 4) <= limit) {
    records = reaching_into(box, pages);
  }
  return {records, bytes_for(records)};
}

/// Bytes that the check of a cell of so many records takes, with T0.
std::uint64_t HierarchyCheck::bytes_for(std::uint64_t records) const {
  const Tin& t0 = terrain_.t0();
  // Every sample is a vertex. The rim of a cell is far less than the cell, or less than a page.
  const std::uint64_t floor_bytes =
      floor_ ? FloorCheck::kPositionBytes * (records + t0.vertices.size()) : 0;
  return bytes_of(t0) + t0.vertices.size() * kValidationBytes + cell_bytes(records) + floor_bytes;
}

std::uint64_t HierarchyCheck::reaching_into(const GridBox& box, std::span<const PageId> pages) {
  const MeetsBox meets_box(box);
  std::uint64_t records = 0;
  std::vector<PendingSplit> of_page;
  for (const PageId page : pages) {
    of_page.clear();
    try {
      read_pages(terrain_.store(), std::span(&page, 1), meets_box, context_, of_page);
      records += of_page.size();
    } catch (const Error& e) {
      // A page that is broken is told by the check of the cell, which reads it again.
      if (e.code() != ErrorCode::corruption) throw;
      records += most_records(terrain_.store(), std::span(&page, 1));
    }
  }
  return records;
}

void HierarchyCheck::look_into(const GridCell& cell) {
  ++report_.cells;
  const GridBox box = cell.box();
  const CellLoad load = load_of(box);
  if (load.bytes > request_.limits.memory_bytes) {
    throw Error(ErrorCode::resource_exhausted,
                "the records around position " + text_of(GridPoint{box.min_x, box.min_y}) +
                    " take " + std::to_string((load.bytes + 0xFFFFF) >> 20) +
                    " MiB to check, more than the limit of " +
                    std::to_string(request_.limits.memory_bytes >> 20) + " MiB: give more memory",
                terrain_.store().path());
  }
  try {
    read(box, load.records);
    apply_all(cell);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::corruption) throw;
    if (told_.insert(e.message()).second) report(e.message(), e.context());
  }
}

/// Fills `records_` with the records whose roi meets the box, and `order_` with their places by
/// falling rank; those of one rank keep the order of the file. There are `most` at most.
void HierarchyCheck::read(const GridBox& box, std::uint64_t most) {
  const StoreFile& store = terrain_.store();
  const MeetsBox meets_box(box);
  std::vector<PageId> pages;
  terrain_.index().search(meets_box, pages, context_.cost.io);
  store.announce(pages, context_.heights(), context_.cost.io);
  records_.clear();
  corners_.clear();
  reserve_large(records_, most);
  StarredRecords of_page;
  for (const PageId page : pages) {
    context_.check_stop();
    of_page.clear();
    store.read_starred(page, of_page, context_.heights(), context_.cost.io);
    for (std::size_t i = 0; i < of_page.size(); ++i) {
      const VertexSplit& r = of_page.splits[i];
      if (!meets_box.holds(attributes_of(r, heights_))) continue;
      const auto ring = of_page.ring(i);
      records_.push_back({r, static_cast<std::uint32_t>(index_of(page)),
                          static_cast<std::uint32_t>(ring.size()), corners_.size()});
      corners_.insert(corners_.end(), ring.begin(), ring.end());
    }
  }
  std::vector<std::uint32_t> next(std::size_t{UINT16_MAX} + 2, 0);
  for (const CellRecord& r : records_) ++next[UINT16_MAX - r.split.rank + std::size_t{1}];
  for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
  order_.resize(records_.size());
  for (std::uint32_t i = 0; i < records_.size(); ++i) {
    order_[next[UINT16_MAX - records_[i].split.rank]++] = i;
  }
}

/// Applies the records of the cell up to the first that is refused, since nothing can be said of
/// those that need it, and validates the mesh.
void HierarchyCheck::apply_all(const GridCell& cell) {
  const Tin& t0 = terrain_.t0();
  tin_ = t0;
  reserve_large(tin_.vertices, t0.vertices.size() + records_.size());
  tin_.has_height.reserve(t0.vertices.size() + records_.size());
  reserve_large(tin_.triangles, t0.triangles.size() + 2 * records_.size());
  tin_.classes.reserve(t0.triangles.size() + 2 * records_.size());
  makers_.assign(t0.triangles.size(), kNone);
  reserve_large(makers_, t0.triangles.size() + 2 * records_.size());
  ids_.reset(t0.vertices.size() + records_.size());
  for (VertexId v = 0; v < t0.vertices.size(); ++v) ids_.insert(key_of(t0.position(v)), v);
  Star star;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    if (i % kStopInterval == 0) context_.check_stop();
    const CellRecord& r = records_[order_[i]];
    SplitResult made;
    if (std::string fault = apply(r.split, star, made); !fault.empty()) {
      if (told_.insert(name_of(r)).second) report(std::move(fault), name_of(r));
      return;
    }
    if (cell.holds(r.split.w)) {
      ++report_.records;
      std::string fault = fault_in_needs(r.split, star, made);
      if (fault.empty()) fault = fault_in_star(r, star);
      if (fault.empty()) fault = fault_in_deaths(r.split, star, made);
      count_deaths(r);
      if (!fault.empty()) report(std::move(fault), name_of(r));
    }
    makers_.resize(tin_.triangles.size());
    for (const TriangleId t : star.triangles) makers_[t] = order_[i];
  }
  if (std::string broken = validate(tin_); !broken.empty()) {
    if (told_.insert(broken).second) report(std::move(broken), "the full TIN");
    return;
  }
  look_at_floor(cell);
}

/// Holds the full TIN of a cell against the heights of the raster. In a file whose vertices are not as
/// many as its samples, which verify_store() tells, a cell may have any number of these.
void HierarchyCheck::look_at_floor(const GridCell& cell) {
  const StoreFile& store = terrain_.store();
  const FloorShape* const shape = floor_ ? &store.floor()->facts().shape : nullptr;
  const std::uint64_t vertices = store.record_count() + terrain_.t0().vertices.size();
  if (shape == nullptr || vertices != std::uint64_t{shape->width} * shape->height) return;
  if (auto fault = floor_->fault_in(tin_, cell, context_.cost.io)) {
    report(std::move(fault->what), std::move(fault->where));
  }
}

/// Applies one record and walks the star of its vertex. @returns why it is refused, or nothing
std::string HierarchyCheck::apply(const VertexSplit& r, Star& star, SplitResult& made) {
  const auto u = static_cast<VertexId>(tin_.vertices.size());
  if (!ids_.insert(key_of(r.u), u)) return "its vertex is there already when its turn comes";
  for (const GridPoint p : {r.w, r.vl, r.vr}) {
    if (ids_.find(key_of(p)) == KeyTable::kAbsent) {
      return "it names " + text_of(p) +
             ", where no record that comes before it, by falling rank, makes a vertex";
    }
  }
  tin_.vertices.push_back({r.u, r.height, kNone});
  tin_.has_height.push_back((r.flags & VertexSplit::kVertexVoid) == 0 ? 1 : 0);
  made = split(tin_, site_of(u, ids_.find(key_of(r.w)), ids_.find(key_of(r.vl)),
                             ids_.find(key_of(r.vr)), r.flags));
  if (!made.applied) {
    return "it does not find its fan: w, vl and vr are no neighbours in that order when its turn "
           "comes, by falling rank, or a triangle would not be counter-clockwise";
  }
  walk_star(tin_, u, star);
  return {};
}

/// Holds a record against the makers of its fan, which it needs.
std::string HierarchyCheck::fault_in_needs(const VertexSplit& r, const Star& star,
                                           const SplitResult& made) const {
  std::uint32_t last = kNone;
  for (const TriangleId t : star.triangles) {
    if (t == made.left || t == made.right) continue;
    const std::uint32_t maker = makers_[t];
    if (maker == kNone || maker == last) continue;
    last = maker;
    if (std::string fault = fault_against(r, records_[maker]); !fault.empty()) return fault;
  }
  return {};
}

std::string HierarchyCheck::fault_against(const VertexSplit& r, const CellRecord& needed) const {
  const Attributes own = attributes_of(r, heights_);
  const Attributes its = attributes_of(needed.split, heights_);
  const auto fault = [&](const std::string& what, const std::string& theirs,
                         const std::string& relation, const std::string& ours) {
    return "it needs the record of vertex " + text_of(needed.split.u) + " on page " +
           std::to_string(needed.page) + ", whose " + what + ", " + theirs + ", " + relation +
           " its own, " + ours;
  };
  if (!contains(its.roi, own.roi)) {
    return fault("region of influence", text_of(its.roi), "does not hold", text_of(own.roi));
  }
  if (!contains(its.heights, own.heights)) {
    return fault("heights", text_of(its.heights, heights_), "do not hold",
                 text_of(own.heights, heights_));
  }
  if (its.error < own.error) {
    return fault("error", text_of(its.error), "is below", text_of(own.error));
  }
  if (its.deviation < own.deviation) {
    return fault("deviation", text_of(its.deviation), "is below", text_of(own.deviation));
  }
  if (needed.split.rank <= r.rank) {
    return fault("rank", std::to_string(needed.split.rank), "is not above", std::to_string(r.rank));
  }
  return {};
}

/// Holds the ring of a record against the star that its split makes.
std::string HierarchyCheck::fault_in_star(const CellRecord& r, const Star& star) const {
  const std::span<const RingCorner> ring = ring_of(r);
  const std::string fault = "its star is not the one that its split makes: ";
  if (ring.size() != star.link.size() || star.closed != has_closed_ring(r.split)) {
    return fault + std::to_string(ring.size()) + " corners, and there are " +
           std::to_string(star.link.size());
  }
  std::size_t first = 0;  // of a closed star w comes first, of an open one as it is walked
  while (star.closed && !(tin_.position(star.link[first]) == r.split.w)) ++first;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const std::size_t i = (first + k) % ring.size();
    const VertexId v = star.link[i];
    const bool has_height = tin_.has_height[v] != 0;
    if (!(ring[k].position == tin_.position(v)) ||
        has_height != ((ring[k].flags & RingCorner::kNoHeight) == 0) ||
        (has_height && heights_.code(ring[k].height) != heights_.code(tin_.vertices[v].height))) {
      return fault + "its corner " + text_of(ring[k].position) + " differs from the vertex " +
             text_of(tin_.position(v));
    }
    const bool is_void =
        i < star.triangles.size() && tin_.classes[star.triangles[i]] == TriangleClass::kVoid;
    if (is_void != ((ring[k].flags & RingCorner::kVoid) != 0)) {
      return fault + "the class of a triangle at " + text_of(ring[k].position) + " differs";
    }
  }
  return {};
}

/// Looks whether the triangles of the fan of a record die at its error.
std::string HierarchyCheck::fault_in_deaths(const VertexSplit& r, const Star& star,
                                            const SplitResult& made) {
  for (std::size_t i = 0; i < star.triangles.size(); ++i) {
    const TriangleId t = star.triangles[i];
    if (t == made.left || t == made.right) continue;
    ++deaths_;
    if (const float death = death_of(t, r, star, i); !(death == r.error)) {
      return "a triangle that it replaces, at " + text_of(tin_.position(star.link[i])) +
             ", is said to " +
             (death == kLivesOn ? std::string("live on") : "die at " + text_of(death)) +
             ", and its error is " + text_of(r.error);
    }
  }
  return {};
}

/// The death of a triangle of the fan as its star, or T0, has it. `t` is triangle i of the star of
/// u now; before the split it had w in the place of u.
float HierarchyCheck::death_of(TriangleId t, const VertexSplit& r, const Star& star,
                               std::size_t i) const {
  if (makers_[t] == kNone) {
    return terrain_.store().t0().triangles[t].death;
  }
  const CellRecord& maker = records_[makers_[t]];
  const std::array<GridPoint, 3> corner{
      r.w, tin_.position(star.link[i]),
      tin_.position(star.link[i + 1 == star.link.size() ? 0 : i + 1])};
  const auto own = static_cast<std::size_t>(std::find(corner.begin(), corner.end(), maker.split.u) -
                                            corner.begin());
  const std::span<const RingCorner> ring = ring_of(maker);
  for (const RingCorner& c : ring) {
    if (own < 3 && c.position == corner[(own + 1) % 3]) return c.death;
  }
  return kLivesOn;  // its star is another than its split makes, which is reported of the maker
}

void HierarchyCheck::count_deaths(const CellRecord& r) {
  for (const RingCorner& c : ring_of(r)) dying_ += c.death != kLivesOn ? 1 : 0;
}

}  // namespace

HierarchyReport check_hierarchy(const OpenedTerrain& terrain, const HierarchyRequest& request) {
  HierarchyReport report;
  try {
    HierarchyCheck(terrain, request, report).run();
  } catch (const EnoughFaults&) {
    // The report says so.
  }
  return report;
}

}  // namespace ptin
