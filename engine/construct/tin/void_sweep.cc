// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the sweep works. sweep_voids() owns the events, which are both ends of each border edge,
// sorted on disk by key: so vertices come from the lowest up. `Sweep` owns the line: the edges that
// it crosses, from left to right. An edge on the line owns the gap on its right, and a gap of void
// holds the ends of its chain. `Chains` owns the nodes of all chains, and makes the triangles. At a
// vertex Sweep::pass()
//   1. finds the edges on the line that hold it; all must end there, else it is a T-junction;
//   2. closes the gaps between them, whose chains become triangles, and adds the vertex to the
//      chains on both sides; where no edge ends, it splits the chain of the gap that it lies in;
//   3. takes these edges off the line, and only then puts on it those that begin, since an edge
//      that ends at a vertex has no order with one that begins there; a gap between two new edges
//      begins a chain, and where no edge begins the chains on both sides are joined;
//   4. compares edges that have become neighbours: edges that cross are neighbours just before, so
//      no crossing is missed. The first fault ends the work, since beyond it the line has no order.
// Nodes that triangles cut off are used again, so memory grows with the line, not with the border.
#include "engine/construct/tin/void_sweep.h"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/orient.h"

namespace ptin {

namespace {

using Triangles = std::function<void(const std::array<GridVertex, 3>&)>;

/// The line meets one end of a border edge.
struct Event {
  VertexKey at = 0, other = 0;  ///< Keys of this end and of the other one.
  double height = 0.0, other_height = 0.0;
  std::uint32_t is_upward = 0;  ///< 1: the edge goes from its lower to its upper end.

  [[nodiscard]] bool begins_edge() const noexcept { return at < other; }
  friend bool operator<(const Event& a, const Event& b) noexcept {
    return a.at != b.at         ? a.at < b.at
           : a.other != b.other ? a.other < b.other
                                : a.is_upward < b.is_upward;
  }
};

/// The chains of all gaps. A chain runs from left to right, with the void above it on its left
/// hand. A vertex *sees* an edge of a chain when it lies to the left of the edge.
class Chains {
 public:
  /// The nodes at the ends of a chain; kNone for no chain.
  struct Chain {
    std::uint32_t first = kNone, last = kNone;
    std::uint32_t newest = kNone;  ///< The node that was added last: the highest vertex.
  };

  explicit Chains(const Triangles& visit) : visit_(visit) {}

  /// A new chain of one vertex.
  [[nodiscard]] Chain of(const GridVertex& v) {
    const std::uint32_t n = make(v);
    return {n, n, n};
  }
  /// Makes triangles of `v` and the edges that it sees from the right end of a chain on; then `v`
  /// is the right end. push_front() does the same at the left end.
  void push_back(Chain& chain, const GridVertex& v) {
    std::uint32_t at = chain.last;
    while (nodes_[at].previous != kNone && sees(v, nodes_[at].previous, at)) {
      at = drop(at, nodes_[at].previous, v, true);
    }
    const std::uint32_t n = make(v);
    link(at, n);
    chain.last = chain.newest = n;
  }
  void push_front(Chain& chain, const GridVertex& v) {
    std::uint32_t at = chain.first;
    while (nodes_[at].next != kNone && sees(v, at, nodes_[at].next)) {
      at = drop(at, nodes_[at].next, v, false);
    }
    const std::uint32_t n = make(v);
    link(n, at);
    chain.first = chain.newest = n;
  }
  /// Cuts a chain at its highest vertex, which `v` above the chain sees. Then `v` is the right end
  /// of the left part and the left end of the right part. Without a chain both parts are `v` alone.
  [[nodiscard]] std::pair<Chain, Chain> split(const Chain& chain, const GridVertex& v) {
    if (chain.first == kNone) {
      return {of(v), of(v)};
    }
    const std::uint32_t twin = make(nodes_[chain.newest].vertex);
    Chain left{chain.first, chain.newest, chain.newest}, right{twin, chain.last, twin};
    if (chain.last == chain.newest) {
      right.last = twin;
    } else {
      link(twin, nodes_[chain.newest].next);
    }
    nodes_[chain.newest].next = kNone;
    push_back(left, v);
    push_front(right, v);
    return {left, right};
  }
  /// Joins two chains: `left` ends with the vertex with which `right` begins.
  [[nodiscard]] Chain joined(const Chain& left, const Chain& right) {
    const std::uint32_t after = nodes_[right.first].next;
    free_.push_back(right.first);
    if (after == kNone) {
      return {left.first, left.last, left.last};
    }
    link(left.last, after);
    return {left.first, right.last, left.last};
  }
  /// Makes triangles of `v` and all of a chain, when the edges on both sides of its gap end in `v`.
  /// False when `v` does not see all of the chain.
  [[nodiscard]] bool close(const Chain& chain, const GridVertex& v) {
    std::uint32_t at = chain.first;
    for (; nodes_[at].next != kNone; at = drop(at, nodes_[at].next, v, false)) {
      if (!sees(v, at, nodes_[at].next)) {
        return false;
      }
    }
    free_.push_back(at);
    return true;
  }
  /// Nodes in memory, in use or free.
  [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }

 private:
  struct Node {
    GridVertex vertex;
    std::uint32_t previous = kNone, next = kNone;
  };

  std::uint32_t make(const GridVertex& v) {
    if (free_.empty()) {
      nodes_.push_back({v, kNone, kNone});
      return static_cast<std::uint32_t>(nodes_.size() - 1);
    }
    const std::uint32_t n = free_.back();
    free_.pop_back();
    nodes_[n] = {v, kNone, kNone};
    return n;
  }
  void link(std::uint32_t left, std::uint32_t right) {
    nodes_[left].next = right;
    nodes_[right].previous = left;
  }
  [[nodiscard]] bool sees(const GridVertex& v, std::uint32_t a, std::uint32_t b) const {
    return orient(nodes_[a].vertex.position, nodes_[b].vertex.position, v.position) > 0;
  }
  /// Makes a triangle of `v` and the edge between two nodes, and frees the first of them, which is
  /// an end of what is left of its chain.
  /// @param goes_left  `neighbour` is to the left of `node`.
  /// @return  `neighbour`
  std::uint32_t drop(std::uint32_t node, std::uint32_t neighbour, const GridVertex& v,
                     bool goes_left) {
    const GridVertex &a = nodes_[node].vertex, &b = nodes_[neighbour].vertex;
    visit_(goes_left ? std::array{b, a, v} : std::array{a, b, v});
    (goes_left ? nodes_[neighbour].next : nodes_[neighbour].previous) = kNone;
    free_.push_back(node);
    return neighbour;
  }

  const Triangles& visit_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> free_;  ///< Nodes to be used again.
};

/// What lies between two edges next to each other on the line.
struct Gap {
  int cover = 0;        ///< How often the surface covers it: 0 is void, 1 surface.
  Chains::Chain chain;  ///< Below the gap, where it is void.
};

/// An edge that the line crosses, and the gap on its right.
struct ActiveEdge {
  GridVertex low, high;
  bool is_upward = false;
  mutable Gap right;  ///< Changes in the set, since the order does not look at it.
};

std::int64_t side(const ActiveEdge& e, GridPoint p) noexcept {
  return orient(e.low.position, e.high.position, p);
}

// The order of edges on the line is from left to right. A point that lies on an edge equals it.
bool operator<(const ActiveEdge& e, GridPoint p) noexcept { return side(e, p) < 0; }
bool operator<(GridPoint p, const ActiveEdge& e) noexcept { return side(e, p) > 0; }
bool operator<(const ActiveEdge& a, const ActiveEdge& b) noexcept {
  if (key_of(a.low.position) <= key_of(b.low.position)) {
    const std::int64_t at = side(a, b.low.position);
    return at != 0 ? at < 0 : side(a, b.high.position) < 0;
  }
  const std::int64_t at = side(b, a.low.position);
  return at != 0 ? at > 0 : side(b, a.high.position) > 0;
}

class Sweep {
 public:
  Sweep(const ExternalMemory& memory, const Triangles& visit, TinFaults& faults,
        const std::string& path)
      : most_(std::max<std::uint64_t>(memory.bytes / kBytes, 1024)),
        chains_(visit),
        faults_(faults),
        path_(path) {}

  /// Moves the line over a vertex.
  /// @param beginning  The lower ends of all edges that begin at `v`.
  /// @return  False when there is a fault, which `faults` has received: the work ends.
  [[nodiscard]] bool pass(const GridVertex& v, const std::vector<Event>& beginning);
  /// True when every edge has ended.
  [[nodiscard]] bool is_over() const noexcept { return line_.empty(); }

 private:
  static constexpr std::uint64_t kBytes = 192;  ///< Counted for an edge, and for four nodes.
  using Line = std::set<ActiveEdge, std::less<>>;

  [[nodiscard]] Gap& left_of(Line::iterator edge) {
    return edge == line_.begin() ? outside_ : std::prev(edge)->right;
  }
  [[nodiscard]] bool end_edges(const GridVertex& v, Line::iterator first, Line::iterator end,
                               Gap& left, Gap& right);
  [[nodiscard]] bool begin_edges(const GridVertex& v, const std::vector<Event>& beginning,
                                 Line::iterator before, const Gap& left, const Gap& right);
  [[nodiscard]] bool cross(Line::iterator right_edge);
  bool fault(TinFault& kind, GridPoint at) {
    kind.add(at);
    return false;
  }

  std::uint64_t most_;  ///< Edges on the line, with a quarter of one for each node.
  Chains chains_;
  TinFaults& faults_;
  const std::string& path_;
  Line line_;
  Gap outside_;  ///< To the left of all edges.
};

/// Ends the edges [first, end) of the line in `v`, and gives `v` to the chains beside them. Where
/// there are none, `v` lies inside the gap `left`, which is split in two.
/// @param left   The gap to the left of the edges; receives `v`.
/// @param right  Receives the gap to the right of the edges, with `v`.
bool Sweep::end_edges(const GridVertex& v, Line::iterator first, Line::iterator end, Gap& left,
                      Gap& right) {
  if (first == end) {
    if (left.cover == 0) {
      std::tie(left.chain, right.chain) = chains_.split(left.chain, v);
    }
    right.cover = left.cover;
    return true;
  }
  for (auto e = first; e != end; ++e) {
    if (e->high.position != v.position) {
      return fault(faults_.t_junctions, v.position);
    }
    if (std::next(e) != end && e->right.cover == 0 && !chains_.close(e->right.chain, v)) {
      return fault(faults_.crossings, v.position);
    }
  }
  right = std::prev(end)->right;
  if (left.cover == 0) {
    chains_.push_back(left.chain, v);
  }
  if (right.cover == 0) {
    chains_.push_front(right.chain, v);
  }
  return true;
}

/// True when an edge on the line and the one on its left cross.
bool Sweep::cross(Line::iterator right_edge) {
  if (right_edge == line_.end() || right_edge == line_.begin()) {
    return false;
  }
  const ActiveEdge &e = *std::prev(right_edge), &f = *right_edge;
  const auto sign = [](std::int64_t v) { return v > 0 ? 1 : (v < 0 ? -1 : 0); };
  return sign(side(e, f.low.position)) * sign(side(e, f.high.position)) < 0 &&
         sign(side(f, e.low.position)) * sign(side(f, e.high.position)) < 0;
}

/// Puts the edges that begin at `v` on the line, before the edge `before`.
/// @param left, right  The gaps on both sides of `v`, as end_edges() leaves them.
bool Sweep::begin_edges(const GridVertex& v, const std::vector<Event>& beginning,
                        Line::iterator before, const Gap& left, const Gap& right) {
  std::vector<ActiveEdge> edges;
  for (const Event& e : beginning) {
    edges.push_back({v, {point_of(e.other), e.other_height}, e.is_upward != 0, {}});
  }
  std::sort(edges.begin(), edges.end());
  int cover = left.cover;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    cover += edges[i].is_upward ? -1 : 1;  // the surface is on the left of an edge
    if (cover < 0 || cover > 1) {
      return fault(faults_.covered, v.position);
    }
    edges[i].right.cover = cover;
    if (i + 1 == edges.size()) {
      edges[i].right = right;
    } else if (cover == 0) {
      edges[i].right.chain = chains_.of(v);
    }
    const std::size_t size = line_.size();
    const auto put = line_.insert(before, edges[i]);
    if (line_.size() == size) {
      return fault(faults_.t_junctions, v.position);
    }
    if (cross(put)) {
      return fault(faults_.crossings, put->low.position);
    }
  }
  if (cover != right.cover) {
    return fault(faults_.crossings, v.position);
  }
  return true;
}

bool Sweep::pass(const GridVertex& v, const std::vector<Event>& beginning) {
  const auto [first, end] = line_.equal_range(v.position);
  Gap left = left_of(first), right;
  if (!end_edges(v, first, end, left, right)) {
    return false;
  }
  const auto before = line_.erase(first, end);
  if (!beginning.empty()) {
    left_of(before) = left;
    if (!begin_edges(v, beginning, before, left, right)) {
      return false;
    }
  } else if (left.cover != right.cover) {
    return fault(faults_.crossings, v.position);
  } else {
    left_of(before) = left.cover == 0 ? Gap{0, chains_.joined(left.chain, right.chain)} : left;
  }
  if (cross(before)) {
    return fault(faults_.crossings, before->low.position);
  }
  if (line_.size() + chains_.size() / 4 > most_) {
    throw Error(ErrorCode::resource_exhausted,
                "a line across this TIN meets " + std::to_string(line_.size()) +
                    " edges of its border, more than fit into the memory given; give more "
                    "--memory",
                path_);
  }
  return true;
}

}  // namespace

void sweep_voids(const RecordFile<GridEdge>& border, const ExternalMemory& memory,
                 const std::function<void(const std::array<GridVertex, 3>&)>& visit,
                 TinFaults& faults, const std::string& path, const std::stop_token& stop) {
  ExternalSorter<Event> events({memory.files, memory.folder, memory.bytes / 4}, "border", stop);
  border.visit(
      [&](const GridEdge& e) {
        const VertexKey from = key_of(e.from.position), to = key_of(e.to.position);
        const std::uint32_t is_upward = from < to ? 1 : 0;
        events.add({from, to, e.from.height, e.to.height, is_upward});
        events.add({to, from, e.to.height, e.from.height, is_upward});
      },
      stop);
  Sweep sweep({memory.files, memory.folder, memory.bytes / 2}, visit, faults, path);
  std::vector<Event> beginning;
  GridVertex at;
  bool has_vertex = false, is_sound = true;
  const auto pass = [&] {
    is_sound = is_sound && (!has_vertex || sweep.pass(at, beginning));
    beginning.clear();
  };
  events.merge(
      [&](std::span<const Event> batch) {
        for (const Event& e : batch) {
          if (!has_vertex || key_of(at.position) != e.at) {
            pass();
            at = {point_of(e.at), e.height};
            has_vertex = true;
          }
          if (e.begins_edge()) {
            beginning.push_back(e);
          }
        }
      },
      stop);
  pass();
  if (is_sound && !sweep.is_over()) {  // an edge went by its end: something crosses it
    faults.crossings.add(at.position);
  }
}

}  // namespace ptin
