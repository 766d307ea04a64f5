// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/delaunay/growing_delaunay.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "engine/check.h"
#include "engine/construct/delaunay/unseen_region.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin::delaunay_internal {

namespace {

/// Width of the first margin around a tile, in mean distances between its points.
constexpr double kMargin = 6.0;

/// The round in which a point is inserted, counted back from the last one, by a hash of the point.
/// The last round has 7 of 8 points, the round before it 7 of 8 of the others, and so on. In one
/// round along the curve, points in rows would take quadratic work.
int rounds_before_last(GridPoint p) noexcept {
  std::uint64_t h = key_of(p) * 0x9e3779b97f4a7c15U;
  h = (h ^ (h >> 31)) * 0xbf58476d1ce4e5b9U;
  return std::countl_zero(h | 1) / 3;
}

}  // namespace

GrowingDelaunay::GrowingDelaunay(const PointBuckets& buckets, std::uint64_t first,
                                 std::uint64_t count, std::size_t cache_bytes,
                                 const std::stop_token& stop)
    : buckets_(buckets),
      first_(first),
      end_(first + count),
      stop_(stop),
      fixed_(buckets.fixed_edges()),
      plain_(fixed_.is_empty() ? std::make_unique<Delaunay>() : nullptr),
      constrained_(fixed_.is_empty() ? nullptr : std::make_unique<ConstrainedDelaunay>()),
      delaunay_(plain_ ? static_cast<Triangulation&>(*plain_) : *constrained_),
      cache_(buckets, first, first + count, cache_bytes) {}

void GrowingDelaunay::insert(const BucketPoint& p, bool own) {
  if (handles_.size() % kStopInterval == 0) {
    stop_if_asked(stop_, "the triangulation");
  }
  const GridKernel::Point_2 point(p.position.x, p.position.y);
  const Vertex_handle v =
      plain_ ? plain_->insert(point, hint_) : constrained_->insert(point, hint_);
  if (delaunay_.number_of_vertices() == handles_.size()) {
    return;  // the end of a fixed edge, which came before the other points around it
  }
  v->info() = static_cast<VertexId>(handles_.size());
  hint_ = v->face();
  handles_.push_back(v);
  heights_.push_back(p.height);
  own_.push_back(own ? 1 : 0);
  inserted_.push_back(v->info());
}

Vertex_handle GrowingDelaunay::insert_fixed(std::uint32_t vertex) {
  const GridPoint p = fixed_.vertices()[vertex].position;
  insert({p, buckets_.fixed_height(vertex)}, false);
  return constrained_->insert(GridKernel::Point_2(p.x, p.y), hint_);  // finds it
}

template <class Meets>
bool GrowingDelaunay::force_edges(const Meets& meets) {
  std::vector<std::uint32_t> found;
  fixed_.visit(meets, [&](std::uint32_t edge) {
    if (forced_.insert(edge).second) {
      found.push_back(edge);
    }
  });
  std::sort(found.begin(), found.end());
  for (const std::uint32_t edge : found) {
    const LineEdge& e = fixed_.edges()[edge];
    const Vertex_handle a = insert_fixed(e.a);
    const Vertex_handle b = insert_fixed(e.b);
    constrained_->force_edge(a, b, changed_);
    hint_ = b->face();  // the one before may have been crossed, and so is gone
  }
  return !found.empty();
}

/// Chooses the box: that of the own points, and a margin around it. The margin is quartered until
/// the box meets no more than about twice the buckets of the tile.
void GrowingDelaunay::choose_box(const std::vector<BucketPoint>& own) {
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

void GrowingDelaunay::triangulate() {
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
    gather(buckets_.begin_of(bucket), buckets_.begin_of(bucket + 1));
    if (contains(box_, buckets_.box(bucket))) {
      cache_.set_used_up(bucket);
    }
  }
  insert_all(all);
  span_area();
  force_edges([&](const GridBox& b) { return meets(b, box_); });
  inserted_.clear();
  changed_.clear();
}

/// Where all points so far lie on one line there is no face yet: inserts the nearest points around
/// them until there is one.
void GrowingDelaunay::span_area() {
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

/// Inserts points that are given in the order of the curve: round by round, each along the curve
/// (Amenta, Choi, Rote: incremental constructions con BRIO, 2003).
void GrowingDelaunay::insert_all(const std::vector<NewPoint>& points) {
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
bool GrowingDelaunay::take_from(BucketCache::Bucket& loaded, const UnseenRegion& region) {
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

/// Forces the fixed edges of the region that are not in yet; or else looks for points in it that are
/// not in yet, from `near` outwards, and inserts those of the first bucket that has any. True when
/// there was neither. Edges come first: they hide points.
bool GrowingDelaunay::see(const UnseenRegion& region, GridPoint near) {
  if (force_edges([&](const GridBox& b) { return region.may_meet(b); })) {
    return false;
  }
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

/// What can be seen of a disc from its face past fixed edges: the faces that are reached over sides
/// which meet the disc and are not fixed. A line of sight lies in the disc, and goes through such
/// faces alone. None, where there are too many: all of the disc then.
std::vector<Part> GrowingDelaunay::visible_parts(const Face_handle& face,
                                                 const Circumdisc& disc) const {
  constexpr std::size_t kMost = 48;
  std::vector<Face_handle> reached = {face};
  std::vector<Part> parts;
  for (std::size_t next = 0; next < reached.size(); ++next) {
    const Face_handle f = reached[next];
    if (reached.size() > kMost) {
      return {};
    }
    if (delaunay_.is_infinite(f)) {
      const int i = f->index(delaunay_.infinite_vertex());
      parts.emplace_back(position_of(f->vertex(next_corner(i))),
                         position_of(f->vertex(previous_corner(i))));
      continue;
    }
    parts.emplace_back(position_of(f->vertex(0)), position_of(f->vertex(1)),
                       position_of(f->vertex(2)));
    for (int i = 0; i < 3; ++i) {
      const GridBox side = united(box_of(position_of(f->vertex(next_corner(i)))),
                                  position_of(f->vertex(previous_corner(i))));
      const Face_handle g = f->neighbor(i);
      if (!f->is_constrained(i) && disc.may_meet(side) &&
          std::find(reached.begin(), reached.end(), g) == reached.end()) {
        reached.push_back(g);
      }
    }
  }
  return parts;
}

/// True when a face is final. False when points were inserted instead: the face may be gone.
bool GrowingDelaunay::is_final(const Face_handle& face) {
  if (delaunay_.is_infinite(face)) {
    const int i = face->index(delaunay_.infinite_vertex());
    const Vertex_handle a = face->vertex(next_corner(i)), b = face->vertex(previous_corner(i));
    const Corners side{{a->info(), b->info(), kNone}};
    if (final_.contains(side)) {
      return true;
    }
    // Counter-clockwise about the outside: the hull lies to the right of a -> b.
    const GridPoint pa = position_of(a), pb = position_of(b);
    if (!see(UnseenRegion(pb, pa), pa)) {
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
  const Circumdisc disc(p[0], p[1], p[2]);
  if (!see(plain_ ? UnseenRegion(disc) : UnseenRegion(disc, visible_parts(face, disc)), p[0])) {
    return false;
  }
  final_.insert(corners);
  return true;
}

/// True when all faces at a vertex are final. False when points were inserted instead: its faces
/// are to be looked at again.
bool GrowingDelaunay::settle_star(VertexId v) {
  auto face = delaunay_.incident_faces(handles_[v]);
  const auto first = face;
  do {
    if (!is_final(face)) {
      return false;
    }
  } while (++face != first);
  return true;
}

void GrowingDelaunay::settle(std::vector<VertexId> vertices) {
  std::vector<std::uint8_t> wanted(handles_.size(), 0);
  for (const VertexId v : vertices) {
    wanted[v] = 1;
  }
  const std::vector<std::uint8_t> of_interest = wanted;
  while (!vertices.empty()) {
    const VertexId v = vertices.back();
    stop_if_asked(stop_, "the triangulation");
    inserted_.clear();
    changed_.clear();
    if (settle_star(v)) {
      vertices.pop_back();
      wanted[v] = 0;
      continue;
    }
    const auto look_again = [&](VertexId u) {
      if (u < own_.size() && u < wanted.size() && (own_[u] != 0 || of_interest[u] != 0) &&
          wanted[u] == 0) {
        wanted[u] = 1;
        vertices.push_back(u);
      }
    };
    for (const VertexId u : changed_) {
      look_again(u);
    }
    // Every new face has a new point as a corner. Its other corners have to be looked at again
    // where they are own vertices or vertices of interest.
    for (const VertexId q : inserted_) {
      auto n = delaunay_.incident_vertices(handles_[q]);
      const auto begin = n;
      do {
        if (!delaunay_.is_infinite(n)) {
          look_again(n->info());
        }
      } while (++n != begin);
    }
  }
}

std::vector<VertexId> GrowingDelaunay::own_vertices_to_settle() {
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

}  // namespace ptin::delaunay_internal
