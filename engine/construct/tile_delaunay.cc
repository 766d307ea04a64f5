// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_delaunay.h"

#include <array>
#include <bit>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "engine/check.h"
#include "engine/construct/bucket_cache.h"
#include "engine/construct/delaunay_kernel_internal.h"
#include "engine/error.h"
#include "engine/geometry/circumdisc.h"
#include "engine/geometry/orient.h"

namespace ptin {

namespace {

using namespace delaunay_internal;
using Vertex_handle = Delaunay::Vertex_handle;
using Face_handle = Delaunay::Face_handle;

/// Spacings of points that the first margin is wide.
constexpr double kMargin = 6.0;
constexpr std::size_t kBetweenStops = 4096;

/// What must be empty of unseen points for a face to be final: the closed circumdisc of a finite
/// one; beyond an edge of the hull the open half-plane and the edge itself.
class Region {
 public:
  explicit Region(const Circumdisc& disc) : disc_(disc) {}
  /// To the right of a -> b.
  Region(GridPoint a, GridPoint b) : a_(a), b_(b) {}

  [[nodiscard]] bool holds(GridPoint p) const noexcept {
    if (disc_) {
      return disc_->holds(p);
    }
    const std::int64_t side = orient(a_, b_, p);
    return side < 0 || (side == 0 && contains(united(box_of(a_), b_), p));
  }
  [[nodiscard]] bool may_meet(const GridBox& box) const noexcept {
    if (disc_) {
      return disc_->may_meet(box);
    }
    const GridPoint corner{b_.y - a_.y > 0 ? box.max_x : box.min_x,
                           b_.x - a_.x > 0 ? box.min_y : box.max_y};
    const std::int64_t side = orient(a_, b_, corner);  // the corner farthest to the right
    return side < 0 || (side == 0 && meets(united(box_of(a_), b_), box));
  }

 private:
  std::optional<Circumdisc> disc_;
  GridPoint a_, b_;
};

/// True when the closed circumdisc of a triangle lies in the box, for certain; computed in doubles.
bool disc_lies_in(const GridBox& box, GridPoint a, GridPoint b, GridPoint c) noexcept {
  const double bx = static_cast<double>(b.x) - a.x, by = static_cast<double>(b.y) - a.y;
  const double cx = static_cast<double>(c.x) - a.x, cy = static_cast<double>(c.y) - a.y;
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const double twice = 2.0 * static_cast<double>(orient(a, b, c));
  const double ux = (b2 * cy - c2 * by) / twice, uy = (c2 * bx - b2 * cx) / twice;
  // Each of b2, c2, the products and their difference, and the quotient is rounded once: below
  // 2^-50 of the sizes of the terms.
  const double slack =
      0x1p-49 * (b2 + c2) * (std::abs(bx) + std::abs(by) + std::abs(cx) + std::abs(cy)) / twice;
  const double radius = std::sqrt(ux * ux + uy * uy) * (1.0 + 0x1p-50) + 2.0 * slack + 0x1p-20;
  return a.x + ux - radius > box.min_x && a.x + ux + radius < box.max_x &&
         a.y + uy - radius > box.min_y && a.y + uy + radius < box.max_y;
}

/// Which triangles are void. The same from whichever tile an edge is looked at.
struct LongestEdge {
  double length;  ///< On the ground.
  const GroundMetric& ground;

  [[nodiscard]] bool is_within(GridPoint a, GridPoint b) const noexcept {
    const GroundStep step = ground.at((static_cast<double>(a.y) + b.y) / 2.0);
    const double dx = (static_cast<double>(a.x) - b.x) * step.x;
    const double dy = (static_cast<double>(a.y) - b.y) * step.y;
    // Decimal steps are rounded to binary: an edge of just this length is not longer.
    constexpr double kJust = 1.0 + 1e-12;
    return dx * dx + dy * dy <= length * length * kJust;
  }
  [[nodiscard]] bool is_within(GridPoint a, GridPoint b, GridPoint c) const noexcept {
    return is_within(a, b) && is_within(b, c) && is_within(c, a);
  }
  [[nodiscard]] bool is_within(const Face_handle& f) const {
    return is_within(position_of(f->vertex(0)), position_of(f->vertex(1)),
                     position_of(f->vertex(2)));
  }
};

/// One tile in the making.
class TileMaker {
 public:
  TileMaker(const PointBuckets& buckets, std::uint64_t first, std::uint64_t count,
            std::size_t cache_bytes, const std::stop_token& stop)
      : buckets_(buckets),
        first_(first),
        end_(first + count),
        stop_(stop),
        cache_(buckets, first, first + count, cache_bytes) {}

  void triangulate();
  /// Makes every face at the given vertices final.
  void settle(std::vector<VertexId> vertices);
  [[nodiscard]] std::vector<VertexId> own_vertices_to_settle();
  [[nodiscard]] std::vector<Face_handle> own_faces();
  [[nodiscard]] bool holds_everything() const noexcept {
    return first_ == 0 && end_ == buckets_.size();
  }
  /// The corners of faces that are no points of the tile.
  [[nodiscard]] std::vector<VertexId> other_corners(const std::vector<Face_handle>& faces) const;
  [[nodiscard]] DelaunayTile cut_out(const std::vector<Face_handle>& faces);
  void make_voids(DelaunayTile& tile, const LongestEdge& longest) const;

  [[nodiscard]] bool is_own(VertexId v) const noexcept { return own_[v] != 0; }
  [[nodiscard]] const Delaunay& delaunay() const noexcept { return delaunay_; }
  [[nodiscard]] Vertex_handle handle(VertexId v) const noexcept { return handles_[v]; }

 private:
  void choose_box(const std::vector<BucketPoint>& own);
  struct NewPoint {
    BucketPoint point;
    bool own;
  };
  void insert(const BucketPoint& p, bool own);
  void insert_all(const std::vector<NewPoint>& points);
  void span_area();
  [[nodiscard]] std::uint64_t bucket_of(std::uint64_t point) const noexcept {
    return point / buckets_.bucket_points();
  }
  [[nodiscard]] bool settle_star(VertexId v);
  [[nodiscard]] bool is_final(const Face_handle& face);
  [[nodiscard]] bool take_from(BucketCache::Bucket& loaded, const Region& region);
  [[nodiscard]] bool see(const Region& region, GridPoint near);
  void check_stop() const {
    if (stop_.stop_requested()) {
      throw Error(ErrorCode::cancelled, "the triangulation was cancelled");
    }
  }

  const PointBuckets& buckets_;
  std::uint64_t first_, end_;
  std::stop_token stop_;
  GridBox box_;  ///< Everything inside of it is in.
  Delaunay delaunay_;
  Face_handle hint_;
  std::vector<Vertex_handle> handles_;
  std::vector<HeightBits> heights_;
  std::vector<std::uint8_t> own_;
  BucketCache cache_;               ///< Of what lies around the box.
  std::vector<VertexId> inserted_;  ///< Since it was last cleared.
  struct Corners {
    std::array<VertexId, 3> v;
    friend bool operator==(const Corners&, const Corners&) = default;
  };
  struct HashCorners {
    std::size_t operator()(const Corners& c) const noexcept {
      std::uint64_t h = 0;
      for (const VertexId v : c.v) {
        h = (h ^ v) * 0x9e3779b97f4a7c15U;
        h ^= h >> 29;
      }
      return h;
    }
  };
  std::unordered_set<Corners, HashCorners>
      final_;  ///< Faces that took more than a look at the box.
};

void TileMaker::insert(const BucketPoint& p, bool own) {
  if (handles_.size() % kBetweenStops == 0) {
    check_stop();
  }
  const Vertex_handle v = delaunay_.insert(GridKernel::Point_2(p.position.x, p.position.y), hint_);
  v->info() = static_cast<VertexId>(handles_.size());
  hint_ = v->face();
  handles_.push_back(v);
  heights_.push_back(p.height);
  own_.push_back(own ? 1 : 0);
  inserted_.push_back(v->info());
}

/// The box of the tile's points, and a margin around it, as wide as does not double the work.
void TileMaker::choose_box(const std::vector<BucketPoint>& own) {
  GridBox tight;
  for (const BucketPoint& p : own) {
    tight = united(tight, p.position);
  }
  const double width = static_cast<double>(tight.max_x) - tight.min_x + 1.0;
  const double height = static_cast<double>(tight.max_y) - tight.min_y + 1.0;
  double margin = kMargin * std::sqrt(width * height / static_cast<double>(own.size())) + 1.0;
  const std::uint64_t most =
      bucket_of(end_ - 1) - bucket_of(first_) + 16 + own.size() / buckets_.bucket_points();
  for (;; margin = margin < 1.0 ? 0.0 : margin / 4.0) {
    const auto m = static_cast<std::int64_t>(std::min(margin, static_cast<double>(kGridMax)));
    const auto bounded = [](std::int64_t v) {
      return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, -1, kGridMax + 1));
    };
    box_ = {bounded(tight.min_x - m), bounded(tight.min_y - m), bounded(tight.max_x + m),
            bounded(tight.max_y + m)};
    std::uint64_t touched = 0;
    buckets_.visit_nearest(
        {tight.min_x, tight.min_y}, [&](const GridBox& b) { return meets(b, box_); },
        [&](std::uint64_t) { return ++touched <= most; });
    if (touched <= most || margin == 0.0) {
      cache_.set_box(box_);
      return;
    }
  }
}

void TileMaker::triangulate() {
  std::vector<BucketPoint> points;
  buckets_.take(first_, end_ - first_, points);
  choose_box(points);
  // Everything in the order of the curve, which makes each point next to the one before.
  std::vector<std::uint64_t> around;
  buckets_.visit_nearest(
      points.front().position, [&](const GridBox& b) { return meets(b, box_); },
      [&](std::uint64_t bucket) {
        around.push_back(bucket);
        return true;
      });
  std::sort(around.begin(), around.end());
  std::vector<NewPoint> all;
  const auto gather = [&](std::uint64_t begin, std::uint64_t end) {
    buckets_.take(begin, end - begin, points);
    for (std::uint64_t i = begin; i < end; ++i) {
      const BucketPoint& p = points[i - begin];
      const bool own = i >= first_ && i < end_;
      if (own || contains(box_, p.position)) {
        all.push_back({p, own});
      }
    }
  };
  for (const std::uint64_t bucket : around) {
    const std::uint64_t begin = bucket * buckets_.bucket_points();
    gather(begin, std::min(begin + buckets_.bucket_points(), buckets_.size()));
    if (contains(box_, buckets_.box(bucket))) {
      cache_.set_used_up(bucket);
    }
  }
  insert_all(all);
  span_area();
  inserted_.clear();
}

/// Points on one line have no triangles: goes on with the nearest ones around until they have.
void TileMaker::span_area() {
  if (delaunay_.dimension() == 2) {
    return;
  }
  buckets_.visit_nearest(
      position_of(handles_.front()), [](const GridBox&) { return true; },
      [&](std::uint64_t bucket) {
        BucketCache::Bucket& loaded = cache_.load(bucket);
        for (std::size_t i = 0; i < loaded.points.size() && delaunay_.dimension() < 2; ++i) {
          if (loaded.is_in[i] == 0) {
            insert(loaded.points[i], false);
            loaded.is_in[i] = 1;
            loaded.has_more = true;
          }
        }
        cache_.tidy();
        return delaunay_.dimension() < 2;
      });
  PTIN_CHECK(delaunay_.dimension() == 2);  // the terrain has an area
}

/// The round in which a point is inserted: the last with 7 of 8 points, the one before it with 7 of
/// 8 of the others, and so on. Points in the order of the curve would make quadratic work of rows.
int rounds_before_last(GridPoint p) noexcept {
  std::uint64_t h = key_of(p) * 0x9e3779b97f4a7c15U;
  h = (h ^ (h >> 31)) * 0xbf58476d1ce4e5b9U;
  return std::countl_zero(h | 1) / 3;
}

/// Inserts points that are given in the order of the curve: round by round, each along the curve
/// (Amenta, Choi, Rote: incremental constructions con BRIO, 2003).
void TileMaker::insert_all(const std::vector<NewPoint>& points) {
  static constexpr std::size_t kRounds = 22;
  std::array<std::vector<std::uint32_t>, kRounds> rounds;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    rounds[static_cast<std::size_t>(rounds_before_last(points[i].point.position))].push_back(i);
  }
  for (std::size_t r = kRounds; r-- > 0;) {
    for (const std::uint32_t i : rounds[r]) {
      insert(points[i].point, points[i].own);
    }
  }
}

/// Inserts the points of a bucket that lie in the region and are not in yet. True when there are
/// any.
bool TileMaker::take_from(BucketCache::Bucket& loaded, const Region& region) {
  constexpr std::size_t kBlock = BucketCache::kBlock;
  std::vector<NewPoint> found;
  for (std::size_t block = 0; block < loaded.boxes.size(); ++block) {
    if (is_empty(loaded.boxes[block]) || !region.may_meet(loaded.boxes[block])) {
      continue;
    }
    GridBox left;
    const std::size_t end = std::min((block + 1) * kBlock, loaded.points.size());
    for (std::size_t i = block * kBlock; i < end; ++i) {
      const BucketPoint& p = loaded.points[i];
      if (loaded.is_in[i] != 0) {
        continue;
      }
      if (region.holds(p.position)) {
        found.push_back({p, false});
        loaded.is_in[i] = 1;
        loaded.has_more = true;
      } else {
        left = united(left, p.position);
      }
    }
    loaded.boxes[block] = left;
  }
  insert_all(found);
  return !found.empty();
}

/// Looks for points in the region that are not in yet, from `near` outwards, and inserts those of
/// the first bucket that has any. True when there was none.
bool TileMaker::see(const Region& region, GridPoint near) {
  bool found = false;
  buckets_.visit_nearest(
      near, [&](const GridBox& b) { return region.may_meet(b); },
      [&](std::uint64_t bucket) {
        if (cache_.is_used_up(bucket)) {
          return true;
        }
        BucketCache::Bucket& loaded = cache_.load(bucket);
        found = take_from(loaded, region);
        if (loaded.is_used_up()) {
          cache_.set_used_up(bucket);
        }
        cache_.tidy();
        return !found;
      });
  return !found;
}

/// True when nothing unseen lies in the face's disc; else points were inserted, and the face may be
/// gone.
bool TileMaker::is_final(const Face_handle& face) {
  if (delaunay_.is_infinite(face)) {
    const int i = face->index(delaunay_.infinite_vertex());
    const Vertex_handle a = face->vertex(next_corner(i)), b = face->vertex(previous_corner(i));
    const Corners side{{a->info(), b->info(), kNone}};
    if (final_.contains(side)) {
      return true;
    }
    // Counter-clockwise about the outside: the hull lies to the right of a -> b.
    const GridPoint pa = position_of(a), pb = position_of(b);
    if (!see(Region(pb, pa), pa)) {
      return false;
    }
    final_.insert(side);
    return true;
  }
  std::array<GridPoint, 3> p;
  Corners corners;
  for (int i = 0; i < 3; ++i) {
    p[i] = position_of(face->vertex(i));
    corners.v[i] = face->vertex(i)->info();
  }
  if (disc_lies_in(box_, p[0], p[1], p[2])) {
    return true;
  }
  std::rotate(corners.v.begin(), std::min_element(corners.v.begin(), corners.v.end()),
              corners.v.end());
  if (final_.contains(corners)) {
    return true;
  }
  if (!see(Region(Circumdisc(p[0], p[1], p[2])), p[0])) {
    return false;
  }
  final_.insert(corners);
  return true;
}

bool TileMaker::settle_star(VertexId v) {
  auto face = delaunay_.incident_faces(handles_[v]);
  const auto first = face;
  do {
    if (!is_final(face)) {
      return false;
    }
  } while (++face != first);
  return true;
}

void TileMaker::settle(std::vector<VertexId> vertices) {
  std::vector<std::uint8_t> wanted(handles_.size(), 0);
  for (const VertexId v : vertices) {
    wanted[v] = 1;
  }
  const std::vector<std::uint8_t> of_interest = wanted;
  while (!vertices.empty()) {
    const VertexId v = vertices.back();
    check_stop();
    inserted_.clear();
    if (settle_star(v)) {
      vertices.pop_back();
      wanted[v] = 0;
      continue;
    }
    // Faces at the new points are new: those of them at vertices of interest are to be looked at.
    for (const VertexId q : inserted_) {
      auto n = delaunay_.incident_vertices(handles_[q]);
      const auto begin = n;
      do {
        if (!delaunay_.is_infinite(n)) {
          const VertexId u = n->info();
          if (u < own_.size() && u < wanted.size() && (own_[u] != 0 || of_interest[u] != 0) &&
              wanted[u] == 0) {
            wanted[u] = 1;
            vertices.push_back(u);
          }
        }
      } while (++n != begin);
    }
  }
}

std::vector<VertexId> TileMaker::own_vertices_to_settle() {
  std::vector<std::uint8_t> marked(handles_.size(), 0);
  std::vector<VertexId> vertices;
  for (auto f = delaunay_.all_faces_begin(); f != delaunay_.all_faces_end(); ++f) {
    bool own = false;
    const bool infinite = delaunay_.is_infinite(f);
    for (int i = 0; i < 3; ++i) {
      const Vertex_handle v = f->vertex(i);
      own = own || (!(infinite && delaunay_.is_infinite(v)) && own_[v->info()] != 0);
    }
    if (!own || (!infinite && disc_lies_in(box_, position_of(f->vertex(0)),
                                           position_of(f->vertex(1)), position_of(f->vertex(2))))) {
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const Vertex_handle v = f->vertex(i);
      if (!(infinite && delaunay_.is_infinite(v)) && own_[v->info()] != 0 &&
          marked[v->info()] == 0) {
        marked[v->info()] = 1;
        vertices.push_back(v->info());
      }
    }
  }
  return vertices;
}

/// The finite faces whose smallest vertex is one of the tile's own.
std::vector<Face_handle> TileMaker::own_faces() {
  std::vector<Face_handle> faces;
  faces.reserve(2 * (end_ - first_));
  for (auto f = delaunay_.all_faces_begin(); f != delaunay_.all_faces_end(); ++f) {
    f->info() = kNone;
    if (delaunay_.is_infinite(f)) {
      continue;
    }
    int smallest = 0;
    for (const int i : {1, 2}) {
      if (key_of(position_of(f->vertex(i))) < key_of(position_of(f->vertex(smallest)))) {
        smallest = i;
      }
    }
    if (own_[f->vertex(smallest)->info()] != 0) {
      faces.push_back(f);
    }
  }
  return faces;
}

/// Numbers the vertices of the faces by key, and makes the tile.
DelaunayTile TileMaker::cut_out(const std::vector<Face_handle>& faces) {
  DelaunayTile tile;
  tile.own_points = end_ - first_;
  tile.other_points = handles_.size() - tile.own_points;
  std::vector<std::uint8_t> used(handles_.size(), 0);
  for (const Face_handle& f : faces) {
    for (int i = 0; i < 3; ++i) {
      used[f->vertex(i)->info()] = 1;
    }
  }
  std::vector<std::pair<VertexKey, VertexId>> order;
  order.reserve(handles_.size());
  for (VertexId v = 0; v < handles_.size(); ++v) {
    if (used[v] != 0) {
      order.emplace_back(key_of(position_of(handles_[v])), v);
    }
  }
  std::sort(order.begin(), order.end());
  Tin& tin = tile.tin;
  tin.vertices.reserve(order.size());
  for (const auto& [key, v] : order) {
    handles_[v]->info() = static_cast<VertexId>(tin.vertices.size());
    tin.vertices.push_back({point_of(key), heights_[v], kNone});
  }
  tin.has_height.assign(order.size(), 1);
  add_faces(number_faces(faces, order.size()), tin);
  return tile;
}

std::vector<VertexId> TileMaker::other_corners(const std::vector<Face_handle>& faces) const {
  std::vector<std::uint8_t> marked(handles_.size(), 0);
  std::vector<VertexId> corners;
  for (const Face_handle& f : faces) {
    for (int i = 0; i < 3; ++i) {
      const VertexId v = f->vertex(i)->info();
      if (own_[v] == 0 && marked[v] == 0) {
        marked[v] = 1;
        corners.push_back(v);
      }
    }
  }
  return corners;
}

/// Triangles with long edges become void, and vertices that have no others lose their height.
void TileMaker::make_voids(DelaunayTile& tile, const LongestEdge& longest) const {
  Tin& tin = tile.tin;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t].v;
    if (!longest.is_within(tin.position(v[0]), tin.position(v[1]), tin.position(v[2]))) {
      tin.classes[t] = TriangleClass::kVoid;
    }
  }
  for (std::size_t id = 0; id < handles_.size(); ++id) {
    const Vertex_handle& handle = handles_[id];
    const VertexId v = handle->info();
    if (v >= tin.vertices.size() || tin.position(v) != position_of(handle)) {
      continue;  // not one of the tile's
    }
    auto f = delaunay_.incident_faces(handle);
    const auto first = f;
    bool surface = false;
    do {
      surface = surface || (!delaunay_.is_infinite(f) && longest.is_within(f));
    } while (++f != first);
    tin.has_height[v] = surface ? 1 : 0;
    tile.lone_points += !surface && own_[id] != 0 ? 1 : 0;
  }
}

}  // namespace

DelaunayTiler::DelaunayTiler(const PointBuckets& buckets, std::optional<double> longest_edge,
                             std::size_t cache_bytes)
    : buckets_(buckets),
      longest_edge_(longest_edge),
      ground_(buckets.frame()),
      cache_bytes_(cache_bytes) {}

DelaunayTile DelaunayTiler::make(std::uint64_t first, std::uint64_t count,
                                 const std::stop_token& stop) {
  if (count > kNone / 8) {
    throw Error(ErrorCode::resource_exhausted, "more points than one mesh in memory counts");
  }
  TileMaker maker(buckets_, first, count, cache_bytes_, stop);
  maker.triangulate();
  if (!maker.holds_everything()) {
    maker.settle(maker.own_vertices_to_settle());
  }
  const std::vector<Face_handle> faces = maker.own_faces();
  if (!longest_edge_) {
    return maker.cut_out(faces);
  }
  // Whether a vertex has a surface at all depends on all triangles around it.
  if (!maker.holds_everything()) {
    maker.settle(maker.other_corners(faces));
  }
  DelaunayTile tile = maker.cut_out(maker.own_faces());
  maker.make_voids(tile, {*longest_edge_, ground_});
  return tile;
}

}  // namespace ptin
