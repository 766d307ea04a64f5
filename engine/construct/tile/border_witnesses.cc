// SPDX-License-Identifier: GPL-3.0-or-later
//
// 1. find_nearest() spreads the vertices of the border over the mesh, as Dijkstra's algorithm
//    spreads distances: each vertex takes over what its neighbours know, and measures it itself. So
//    a distance is that of some point of the border, thus an upper bound of the depth.
// 2. Each triangle of the leaf gets its witness, and the witness the depth of the triangle.
// 3. Forest joins the witnesses of triangles that share a side, by a tree in each connected region:
//    the deepest witness first, then always the deepest that borders on the tree (Prim's algorithm),
//    hung below the deepest neighbour in it. From the leaves of the trees on, the border of each
//    witness's triangles is collected in boxes, whose farthest points give the reach.
#include "engine/construct/tile/border_witnesses.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>
#include <unordered_map>

#include "engine/construct/tile/ground_place.h"
#include "engine/construct/tile/witnessed_triangle.h"
#include "engine/geometry/box.h"
#include "engine/geometry/infinity.h"
#include "engine/geometry/rounding.h"

namespace ptin {

namespace {

/// The farthest distance on the ground from `p` to a point of the box.
double farthest(const GridBox& box, GroundPlace p, GroundStep step) noexcept {
  if (is_empty(box)) {
    return 0.0;
  }
  const double x = std::max(std::abs(p.x - box.min_x), std::abs(p.x - box.max_x)) * step.x;
  const double y = std::max(std::abs(p.y - box.min_y), std::abs(p.y - box.max_y)) * step.y;
  return std::sqrt(x * x + y * y);
}

/// A bound of a length that a few roundings made.
float length_bound(double length) noexcept { return rounded_up(length * (1.0 + 0x1p-48)); }

class Finder {
 public:
  explicit Finder(const PartOfTerrain& part)
      : part_(part), tin_(part.tin), n_(part.tin.vertices.size()) {}

  BorderWitnesses run();

 private:
  using Kind = BorderWitnesses::Kind;
  [[nodiscard]] bool is_inner(TriangleId t) const {
    return part_.inner.empty() || part_.inner[t] != 0;
  }
  [[nodiscard]] double depth_of(VertexId v) const {
    return found_.nearest[v] == BorderWitnesses::kNoBorder
               ? kInfinity
               : distance(tin_.position(v), found_.nearest[v], part_.step);
  }
  void find_kinds();
  void list_triangles();
  template <class Visit>
  void for_each_neighbour(VertexId v, const Visit& visit) const;
  void find_nearest();
  void find_regions();
  void find_doubts();
  void measure_triangles();

  const PartOfTerrain& part_;
  const Tin& tin_;
  std::size_t n_;
  BorderWitnesses found_;
  std::vector<std::uint32_t> first_, around_;  ///< Triangles of each vertex.
  std::vector<std::uint8_t> on_seam_;          ///< 1 for a vertex that other leaves have too.

  // The forest. A node is a witness that is not far, or is beside one that is not.
  struct Node {
    std::uint32_t at = kNone;       ///< A vertex, or n_ + a triangle with a witness at a corner.
    float depth = 0.0F;             ///< The greatest of its triangles.
    GridBox border;                 ///< The border that it stands for.
    double key = 0.0;               ///< Its own depth.
    std::uint32_t parent = kNone;   ///< The next node on the way; kNone for the last.
    std::uint32_t parent_side = 0;  ///< The side that the way crosses, as Link::side.
    bool queued = false, taken = false;
  };
  /// A node beside another one, over side `side` % 3 of triangle `side` / 3.
  struct Link {
    std::uint32_t node, side;
  };
  /// Farther from any border than counts: an infinite reach, and the end of all ways.
  [[nodiscard]] bool is_far(std::uint32_t at) const {
    return at < n_ && found_.nearest[at] == BorderWitnesses::kNoBorder;
  }
  [[nodiscard]] GroundPlace place_of_node(const Node& node) const;
  [[nodiscard]] GroundPlace middle_of(std::uint32_t side) const;
  [[nodiscard]] WayIn way_of(TriangleId t) const;
  /// What nodes are ordered by: deeper ones first.
  struct Depth {
    double key;
    std::uint32_t at, node;
    [[nodiscard]] bool is_deeper(const Depth& other) const noexcept {
      return key != other.key ? key > other.key : at < other.at;
    }
  };
  [[nodiscard]] Depth depth_of_node(std::uint32_t node) const {
    return {nodes_[node].key, nodes_[node].at, node};
  }
  std::uint32_t node_at(std::uint32_t at);
  template <class Visit>
  void for_each_link(const Visit& visit);
  void link_nodes();
  void grow_trees();
  void find_reaches();

  std::vector<std::uint32_t> witness_;  ///< Each triangle's, as Node::at; kNone in the margin.
  std::vector<std::uint32_t> node_of_vertex_;
  std::unordered_map<TriangleId, std::uint32_t> node_of_triangle_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> first_link_;
  std::vector<Link> links_;
  std::vector<std::uint32_t> order_;  ///< Nodes, parents before their children.
};

/// A vertex with a height has surface somewhere: one that has voids alone in the part, and is on its
/// side, is on the border. One without a height has voids all around, wherever it is.
void Finder::find_kinds() {
  std::vector<std::uint8_t> seen(n_, 0);
  constexpr std::uint8_t kSurface = 1, kVoid = 2, kOpen = 4, kInside = 8, kOutside = 16;
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    const Triangle& triangle = tin_.triangles[t];
    const std::uint8_t own = (tin_.classes[t] == TriangleClass::kSurface ? kSurface : kVoid) |
                             (is_inner(t) ? kInside : kOutside);
    for (int i = 0; i < 3; ++i) {
      seen[triangle.v[i]] |= own;
      const VertexId a = triangle.v[next_corner(i)], b = triangle.v[previous_corner(i)];
      if (triangle.n[i] == kNone && part_.goes_on(tin_.position(a), tin_.position(b))) {
        seen[a] |= kOpen;
        seen[b] |= kOpen;
      }
    }
  }
  found_.kind.resize(n_);
  on_seam_.resize(n_);
  for (std::size_t v = 0; v < n_; ++v) {
    const bool surface = (seen[v] & kSurface) != 0, is_void = (seen[v] & kVoid) != 0;
    const bool open = (seen[v] & kOpen) != 0, height = tin_.has_height[v] != 0;
    const bool border = (surface && is_void) || (open && is_void && height);
    found_.kind[v] = border ? Kind::kBorder : (open && height ? Kind::kUnknown : Kind::kInner);
    const std::uint8_t both = kInside | kOutside;
    on_seam_[v] = (open && (seen[v] & kInside) != 0) || (seen[v] & both) == both ? 1 : 0;
  }
}

void Finder::list_triangles() {
  first_.assign(n_ + 1, 0);
  for (const Triangle& t : tin_.triangles) {
    for (const VertexId v : t.v) {
      ++first_[v + 1];
    }
  }
  for (std::size_t v = 0; v < n_; ++v) {
    first_[v + 1] += first_[v];
  }
  around_.resize(first_[n_]);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    for (const VertexId v : tin_.triangles[t].v) {
      around_[next[v]++] = t;
    }
  }
}

/// Calls visit(vertex) once for each neighbour: the next corner of each triangle around v, and the
/// previous one where nothing lies beyond the side between it and v.
template <class Visit>
void Finder::for_each_neighbour(VertexId v, const Visit& visit) const {
  for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i) {
    const Triangle& triangle = tin_.triangles[around_[i]];
    const int c = corner_of(triangle, v);
    visit(triangle.v[next_corner(c)]);
    if (triangle.n[next_corner(c)] == kNone) {
      visit(triangle.v[previous_corner(c)]);
    }
  }
}

void Finder::find_nearest() {
  found_.nearest.assign(n_, BorderWitnesses::kNoBorder);
  std::vector<double> best(n_, kInfinity);
  using Entry = std::tuple<double, VertexKey, VertexId>;  // distance, point of the border, vertex
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (VertexId v = 0; v < n_; ++v) {
    if (found_.kind[v] == Kind::kBorder) {
      best[v] = 0.0;
      found_.nearest[v] = tin_.position(v);
      queue.emplace(0.0, key_of(tin_.position(v)), v);
    }
  }
  if (queue.empty()) {
    return;
  }
  while (!queue.empty()) {
    const auto [reached, key, v] = queue.top();
    queue.pop();
    // A path may come nearer to its source again, so a vertex can be improved after its turn. It is
    // queued once more then, and entries that are out of date are passed over.
    if (reached != best[v] || key != key_of(found_.nearest[v])) {
      continue;
    }
    const GridPoint source = found_.nearest[v];
    for_each_neighbour(v, [&](VertexId to) {
      const double there = distance(tin_.position(to), source, part_.step);
      // What is farther than counts is left unknown, which is an infinite depth.
      if (there <= part_.farthest &&
          (there < best[to] || (there == best[to] && key < key_of(found_.nearest[to])))) {
        best[to] = there;
        found_.nearest[to] = source;
        queue.emplace(there, key, to);
      }
    });
  }
}

/// Two leaves with a region each on their side of a seam may both take its vertices to be near their
/// own. The distances from such a vertex to both regions add up to that of the regions at least, so
/// one of the leaves charges as much when it charges twice its own.
void Finder::find_doubts() {
  found_.doubt.assign(n_, 0.0F);
  for (VertexId v = 0; v < n_; ++v) {
    // Up to `known` another leaf can know of no border that this one does not.
    if (on_seam_[v] != 0 && found_.nearest[v] != BorderWitnesses::kNoBorder &&
        depth_of(v) > part_.known) {
      found_.doubt[v] = length_bound(2.0 * depth_of(v));
    }
  }
}

/// Regions are connected by sides and by vertices.
void Finder::find_regions() {
  std::array<std::vector<VertexId>, 2> leader;
  for (std::vector<VertexId>& l : leader) {
    l.resize(n_);
    std::iota(l.begin(), l.end(), 0U);
  }
  const auto find = [](std::vector<VertexId>& l, VertexId v) {
    while (l[v] != v) {
      v = l[v] = l[l[v]];
    }
    return v;
  };
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    std::vector<VertexId>& l = leader[static_cast<std::size_t>(tin_.classes[t])];
    const Triangle& triangle = tin_.triangles[t];
    // All three corners are joined: triangles that share no more than a vertex are one region.
    const VertexId first = find(l, triangle.v[0]);
    l[find(l, triangle.v[1])] = first;
    l[find(l, triangle.v[2])] = first;
  }
  // Vertices are in the order of their keys.
  const auto vertex_at = [&](GridPoint p) {
    const auto at =
        std::lower_bound(tin_.vertices.begin(), tin_.vertices.end(), key_of(p),
                         [](const Vertex& v, VertexKey key) { return key_of(v.position) < key; });
    return static_cast<VertexId>(at - tin_.vertices.begin());
  };
  found_.region.assign(n_, {kNone, kNone});
  for (VertexId v = 0; v < n_; ++v) {
    if (found_.nearest[v] != BorderWitnesses::kNoBorder) {
      const VertexId source = vertex_at(found_.nearest[v]);
      // A vertex of the border touches a region of either class, so v is near to both.
      found_.region[v] = {find(leader[0], source), find(leader[1], source)};
    }
  }
}

std::uint32_t Finder::node_at(std::uint32_t at) {
  const auto next = static_cast<std::uint32_t>(nodes_.size());
  std::uint32_t* known = nullptr;
  if (at < n_) {
    known = &node_of_vertex_[at];
  } else {
    known = &node_of_triangle_.try_emplace(static_cast<TriangleId>(at - n_), kNone).first->second;
  }
  if (*known == kNone) {
    *known = next;
    Node& node = nodes_.emplace_back();
    node.at = at;
    // A witness at a corner has no depth of its own: it comes behind those that have.
    node.key = at < n_ ? depth_of(at) : 0.0;
  }
  return *known;
}

WayIn Finder::way_of(TriangleId t) const {
  const Triangle& triangle = tin_.triangles[t];
  return way_into(
      {tin_.position(triangle.v[0]), tin_.position(triangle.v[1]), tin_.position(triangle.v[2])});
}

/// Gives each triangle its witness, and each witness what its triangles ask of it.
void Finder::measure_triangles() {
  witness_.assign(tin_.triangles.size(), kNone);
  node_of_vertex_.assign(n_, kNone);
  found_.reach.assign(n_, 0.0F);
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    if (!is_inner(t)) {
      continue;
    }
    const WitnessedTriangle w = witnessed_triangle(part_, found_, t);
    witness_[t] = w.witness == WitnessedTriangle::kCornerWitness
                      ? static_cast<std::uint32_t>(n_ + t)
                      : tin_.triangles[t].v[w.witness];
    if (is_far(witness_[t])) {
      // A far witness becomes a node only beside one that is not: as the end of that one's way.
      found_.reach[witness_[t]] = std::numeric_limits<float>::infinity();
      continue;
    }
    Node& node = nodes_[node_at(witness_[t])];
    const std::array<GroundPlace, 3> whole{place_of(w.corners[0]), place_of(w.corners[1]),
                                           place_of(w.corners[2])};
    node.depth =
        std::max(node.depth, length_bound(std::max(w.gap, greatest_depth(w, whole, part_.step))));
    // A box stands for the sides, so that all the border of a branch is one box as well. What the
    // box holds besides only makes the reach larger.
    for (int i = 0; i < 3; ++i) {
      if (w.is_border_side[i]) {
        node.border = united(node.border, w.corners[(i + 1) % 3]);
        node.border = united(node.border, w.corners[(i + 2) % 3]);
      }
    }
  }
}

GroundPlace Finder::place_of_node(const Node& node) const {
  if (node.at < n_) {
    return place_of(tin_.position(node.at));
  }
  const auto t = static_cast<TriangleId>(node.at - n_);
  return place_of(tin_.position(tin_.triangles[t].v[way_of(t).corner]));
}

GroundPlace Finder::middle_of(std::uint32_t side) const {
  const Triangle& triangle = tin_.triangles[side / 3];
  const int i = static_cast<int>(side % 3);
  const GroundPlace a = place_of(tin_.position(triangle.v[next_corner(i)]));
  const GroundPlace b = place_of(tin_.position(triangle.v[previous_corner(i)]));
  return {(a.x + b.x) / 2.0, (a.y + b.y) / 2.0};
}

/// Visits, from both sides, witnesses of triangles of one class that share a side.
template <class Visit>
void Finder::for_each_link(const Visit& visit) {
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    for (int i = 0; i < 3 && witness_[t] != kNone; ++i) {
      const TriangleId other = tin_.triangles[t].n[i];
      // A side is seen from both triangles; the lower number takes it. Two far witnesses need no
      // link, since both have an infinite reach anyhow.
      if (other == kNone || other < t || witness_[other] == kNone ||
          witness_[other] == witness_[t] || tin_.classes[t] != tin_.classes[other] ||
          (is_far(witness_[t]) && is_far(witness_[other]))) {
        continue;
      }
      const std::uint32_t a = node_at(witness_[t]), b = node_at(witness_[other]);
      const auto side = static_cast<std::uint32_t>(3 * t + static_cast<std::uint32_t>(i));
      visit(a, Link{b, side});
      visit(b, Link{a, side});
    }
  }
}

void Finder::link_nodes() {
  std::vector<std::uint32_t> count;
  for_each_link([&](std::uint32_t from, const Link& link) {
    // The first pass makes the nodes of far witnesses, so the number of nodes is not known before.
    count.resize(std::max<std::size_t>(count.size(), std::max(from, link.node) + 1));
    ++count[from];
  });
  first_link_.assign(nodes_.size() + 1, 0);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    first_link_[i + 1] = first_link_[i] + (i < count.size() ? count[i] : 0);
  }
  links_.resize(first_link_.back());
  // From here on `count` is where the next link of each node goes.
  std::copy(first_link_.begin(), first_link_.begin() + static_cast<std::ptrdiff_t>(count.size()),
            count.begin());
  for_each_link([&](std::uint32_t from, const Link& link) { links_[count[from]++] = link; });
}

void Finder::grow_trees() {
  const auto after = [](const Depth& a, const Depth& b) { return b.is_deeper(a); };
  std::priority_queue<Depth, std::vector<Depth>, decltype(after)> queue(after);
  const auto put = [&](std::uint32_t node) {
    if (!nodes_[node].queued) {
      nodes_[node].queued = true;
      queue.push(depth_of_node(node));
    }
  };
  const auto grow = [&] {
    while (!queue.empty()) {
      const std::uint32_t id = queue.top().node;
      queue.pop();
      Node& node = nodes_[id];
      node.taken = true;
      order_.push_back(id);
      for (std::uint32_t i = first_link_[id]; i < first_link_[id + 1]; ++i) {
        const Link& link = links_[i];
        // Only a node that was taken before can be the next one, so ways never run in a circle. The
        // deepest of these is chosen, since ways are to lead away from the border.
        if (!nodes_[link.node].taken) {
          put(link.node);
        } else if (!is_far(node.at) && (node.parent == kNone || depth_of_node(link.node).is_deeper(
                                                                    depth_of_node(node.parent)))) {
          node.parent = link.node;
          node.parent_side = link.side;
        }
      }
    }
  };
  std::vector<Depth> roots;
  roots.reserve(nodes_.size());
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    roots.push_back(depth_of_node(i));
  }
  std::sort(roots.begin(), roots.end(),
            [](const Depth& a, const Depth& b) { return a.is_deeper(b); });
  // Far nodes have infinite keys and come first. Each is a root of its own, for all ways that reach
  // one end there; what is left then has no far node in its region, and its deepest node is the
  // root.
  const auto near =
      std::find_if(roots.begin(), roots.end(), [&](const Depth& root) { return !is_far(root.at); });
  std::for_each(roots.begin(), near, [&](const Depth& root) { put(root.node); });
  grow();
  std::for_each(near, roots.end(), [&](const Depth& root) {
    put(root.node);
    grow();
  });
}

void Finder::find_reaches() {
  // Children come behind their parents in the order, so backwards each has all of its branch.
  for (std::size_t i = order_.size(); i-- > 0;) {
    const Node& node = nodes_[order_[i]];
    float reach = std::numeric_limits<float>::infinity();
    if (node.parent != kNone) {
      Node& next = nodes_[node.parent];
      // The way is two straight pieces, to the middle of the side and on to the next node. The
      // distance to the farthest point of a box is convex, so it is greatest at an end of a piece.
      double most = 0.0;
      for (const GroundPlace p :
           {place_of_node(node), middle_of(node.parent_side), place_of_node(next)}) {
        most = std::max(most, farthest(node.border, p, part_.step));
      }
      reach = std::max(node.depth, length_bound(most));
      if (!is_empty(node.border)) {
        next.border = united(next.border, node.border);
      }
    }
    if (node.at < n_) {
      found_.reach[node.at] = reach;
    } else {
      const auto t = static_cast<TriangleId>(node.at - n_);
      found_.corners.push_back({t, way_of(t), reach});
    }
  }
  std::sort(found_.corners.begin(), found_.corners.end(),
            [](const CornerWitness& a, const CornerWitness& b) { return a.triangle < b.triangle; });
}

BorderWitnesses Finder::run() {
  find_kinds();
  list_triangles();
  find_nearest();
  find_regions();
  find_doubts();
  measure_triangles();
  link_nodes();
  grow_trees();
  find_reaches();
  return std::move(found_);
}

}  // namespace

BorderWitnesses find_border_witnesses(const PartOfTerrain& part) { return Finder(part).run(); }

}  // namespace ptin
