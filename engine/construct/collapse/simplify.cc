// SPDX-License-Identifier: GPL-3.0-or-later
//
// The loop of construction (engine/DESIGN.md, section 5.1): which vertex goes next, and what
// follows.
//
// A Simplifier borrows the tile for one run, alone. It owns the queue, what it knows of each vertex
// (state_, target_), and one star (star_), which evaluate() gathers and collapse() uses up.
// 1. fill_queue() measures the star of every vertex that is not locked: the best w, its error, and
//    from that a priority.
// 2. take_top() looks at the least entry. A clean one is collapsed into the w that it was measured
//    with. A stale one is measured again: it is collapsed if it is still the least, and else goes
//    back as a clean one. So a star that changes several times is measured once, when its turn
//    comes.
// 3. collapse() has the record made, the samples handed over and the mesh changed (RecordMaker), in
//    this order, since the record is measured on the star. Then it sets the degrees, and makes the
//    entries of the link stale. A link vertex that no collapse was allowed for gets a new chance at
//    once.
// 4. compact_when_sparse() comes before a vertex is taken, when nobody holds an id but state_,
//    target_ and the queue, which get the new ones.
// 5. prefetch_upcoming() asks for the memory of the stars whose turn is near; it decides nothing.
// With carried samples (no full surface) the loop is the same, but lists are cut down at each
// compaction.
#include "engine/construct/collapse/simplify.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/check.h"
#include "engine/construct/collapse/carried_samples.h"
#include "engine/construct/collapse/collapse_choice.h"
#include "engine/construct/collapse/collapse_queue.h"
#include "engine/construct/collapse/grid_stars.h"
#include "engine/construct/collapse/record_maker.h"
#include "engine/construct/collapse/tile_compact.h"
#include "engine/construct/measure/saturation.h"
#include "engine/large_array.h"
#include "engine/prefetch.h"
#include "engine/stop.h"

namespace ptin {

namespace {

/// What is known about the entry of a vertex in the queue.
enum class QueueState : std::uint8_t {
  kAbsent,  ///< No collapse was allowed when it was last measured, or it is locked or gone.
  kClean,   ///< In the queue, with the measure of its star.
  kStale,   ///< In the queue, but its star has changed since.
};

class Simplifier {
 public:
  Simplifier(Tile& tile, const FullSurface* full, const SimplifyOptions& options)
      : tile_(tile),
        options_(options),
        full_(full),
        is_capped_(full == nullptr),
        first_samples_(tile.samples.used()),
        maker_(tile, full),
        scale_(scale_of(tile, options.cost)) {}

  void run();

 private:
  struct Evaluation {
    CollapseChoice choice;
    std::uint64_t priority = 0;
  };
  struct FirstMeasure {
    VertexId w;
    std::uint64_t priority;
  };
  [[nodiscard]] static PriorityScale scale_of(const Tile& tile, CostModel cost);
  [[nodiscard]] std::optional<FirstMeasure> measure_on_grid(const GridStars& grid,
                                                            VertexId u) const;
  void count();
  void fill_queue();
  void check_in();
  [[nodiscard]] Evaluation evaluate(VertexId u);
  void take_top();
  void collapse(VertexId u, std::size_t j);
  [[nodiscard]] std::size_t most_samples() const;
  void compact_when_sparse();
  void prefetch_upcoming() const;
  void prefetch_beside(VertexId v) const;
  void prefetch_beyond(VertexId v) const;
  void prefetch_star(VertexId v) const;
  void prefetch_samples(VertexId v) const;
  template <class Visit>
  void for_each_around(VertexId v, const Visit& visit) const;

  Tile& tile_;
  const SimplifyOptions& options_;
  const FullSurface* full_;
  bool is_capped_;             ///< Lists are cut down at each compaction: no `full`.
  std::size_t first_samples_;  ///< Samples in all lists at the beginning.
  RecordMaker maker_;
  CollapseChooser chooser_;
  PriorityScale scale_;
  CollapseQueue queue_;
  StarSamples star_;
  std::vector<QueueState> state_;
  std::vector<VertexId> target_;  ///< The chosen w of a clean vertex.
  std::uint64_t left_ = 0;        ///< Vertices that are neither locked nor gone.
  std::uint64_t alive_ = 0;       ///< Vertices that are not gone.
  std::uint64_t collapsed_ = 0;
  std::uint64_t steps_ = 0;
};

PriorityScale Simplifier::scale_of(const Tile& tile, CostModel cost) {
  GridBox bounds;
  std::uint64_t alive = 0;
  for (const Vertex& v : tile.tin.vertices) {
    if (v.triangle != kNone) {
      bounds = united(bounds, v.position);
      ++alive;
    }
  }
  return {cost, bounds, alive};
}

/// Looks at the stop token and reports, every few thousand steps.
void Simplifier::check_in() {
  if ((++steps_ & 0xfff) != 0) {
    return;
  }
  stop_if_asked(options_.stop, "the build");
  if (options_.progress) {
    options_.progress(collapsed_);
  }
}

/// Measures the star of `u`, which stays in star_.
Simplifier::Evaluation Simplifier::evaluate(VertexId u) {
  gather_star(tile_, u, star_);
  Evaluation e;
  e.choice = chooser_.choose(tile_, full_, star_);
  if (e.choice.j == CollapseChoice::kNoNeighbour) {
    return e;
  }
  CollapseMeasure measure;
  measure.vertex = tile_.tin.position(u);
  measure.error_quanta = e.choice.error / tile_.units.quantum_code;
  measure.roi = saturated_box(tile_, star_.star);
  measure.chain = saturated_chain(tile_, star_.star);
  if (options_.cost == CostModel::kElevation) {
    const Interval heights = saturated_heights(tile_, star_.star);
    measure.height_quanta =
        is_empty(heights) ? 0.0 : (heights.hi - heights.lo) / tile_.units.quantum_code;
  }
  e.priority = scale_(measure);
  return e;
}

/// The first measure of a star of the full TIN of a raster; nothing where the table does not say.
std::optional<Simplifier::FirstMeasure> Simplifier::measure_on_grid(const GridStars& grid,
                                                                    VertexId u) const {
  const auto choice = grid.choose(u);
  if (!choice) {
    return std::nullopt;
  }
  const GridPoint p = tile_.tin.position(u);
  CollapseMeasure measure;
  measure.vertex = p;
  measure.error_quanta = choice->error / tile_.units.quantum_code;
  measure.roi = {p.x - 1, p.y - 1, p.x + 1, p.y + 1};
  return FirstMeasure{choice->w, scale_(measure)};
}

/// Counts the vertices that are there.
void Simplifier::count() {
  for (VertexId v = 0; v < tile_.tin.vertices.size(); ++v) {
    if (tile_.tin.vertices[v].triangle != kNone) {
      ++alive_;
      left_ += tile_.vertex_state[v].locked ? 0 : 1;
    }
  }
}

void Simplifier::fill_queue() {
  std::optional<GridStars> grid;
  if (options_.full_raster && options_.cost == CostModel::kError) {
    grid.emplace(tile_, *options_.full_raster);
  }
  const std::size_t n = tile_.tin.vertices.size();
  state_.assign(n, QueueState::kAbsent);
  target_.assign(n, kNone);
  for (VertexId v = 0; v < n; ++v) {
    if (tile_.tin.vertices[v].triangle == kNone || tile_.vertex_state[v].locked) {
      continue;
    }
    check_in();
    std::optional<FirstMeasure> first = grid ? measure_on_grid(*grid, v) : std::nullopt;
    if (!first) {
      const Evaluation e = evaluate(v);
      if (e.choice.j == CollapseChoice::kNoNeighbour) {
        continue;
      }
      first = FirstMeasure{star_.star.link[e.choice.j], e.priority};
    }
    queue_.push({first->priority, v});
    state_[v] = QueueState::kClean;
    target_[v] = first->w;
  }
}

/// Collapses the centre u of star_ into link[j], and makes the stars of its link stale: they have
/// changed.
void Simplifier::collapse(VertexId u, std::size_t j) {
  const auto degree = static_cast<std::uint16_t>(star_.star.degree());
  const bool closed = star_.star.closed;
  const VertexId w = star_.star.link[j];
  const CollapseSite site = collapse_site(star_.star, j);
  maker_.collapse_and_record(star_, j);
  state_[u] = QueueState::kAbsent;
  // w takes over the link but for itself and its two neighbours there (one at a border). These
  // neighbours lose u, and had w already.
  std::vector<VertexState>& vertices = tile_.vertex_state;
  vertices[w].degree = static_cast<std::uint16_t>(vertices[w].degree + degree - (closed ? 4 : 3));
  if (site.left != kNone) {
    --vertices[site.vl].degree;
  }
  if (site.right != kNone) {
    --vertices[site.vr].degree;
  }
  for (const VertexId v : star_.star.link) {
    if (state_[v] == QueueState::kClean) {
      state_[v] = QueueState::kStale;
    } else if (state_[v] == QueueState::kAbsent && !vertices[v].locked) {
      state_[v] = QueueState::kStale;
      queue_.push({0, v});  // measured at once: its priority is not known
    }
  }
  --left_;
  --alive_;
  ++collapsed_;
}

/// How many samples a triangle keeps at a compaction: so many that all lists together hold hardly
/// more than at the beginning.
std::size_t Simplifier::most_samples() const {
  if (!is_capped_) {
    return kAllSamples;
  }
  return std::clamp(first_samples_ / static_cast<std::size_t>(2 * alive_ + 1), kCarriedInWork,
                    kMostCarriedInWork);
}

void Simplifier::compact_when_sparse() {
  const std::size_t length = tile_.tin.vertices.size();
  const bool is_worthwhile = length > options_.compact_above && 2 * alive_ <= length;
  const bool never = options_.compact_above == std::numeric_limits<std::size_t>::max();
  if (never || (!is_worthwhile && !tile_.samples.is_sparse())) {
    return;
  }
  const Renumbering place = compact(tile_, most_samples());
  for (std::size_t v = 0; v < length; ++v) {
    if (place[v] != kNone) {
      state_[place[v]] = state_[v];
      target_[place[v]] = target_[v] == kNone ? kNone : place[target_[v]];
    }
  }
  state_.resize(tile_.tin.vertices.size());
  target_.resize(tile_.tin.vertices.size());
  queue_.rename(place);
}

/// Calls visit(triangle id, place of v in it) for each triangle around v, in the order of its star.
template <class Visit>
void Simplifier::for_each_around(VertexId v, const Visit& visit) const {
  const Tin& tin = tile_.tin;
  const TriangleId first = tin.vertices[v].triangle;
  TriangleId t = first;
  do {
    const Triangle& triangle = tin.triangles[t];
    const int c = corner_of(triangle, v);
    visit(t, c);
    t = triangle.n[next_corner(c)];
  } while (t != first && t != kNone);
}

/// Asks for the triangles beside the first one of a star, which was asked for earlier.
void Simplifier::prefetch_beside(VertexId v) const {
  const Tin& tin = tile_.tin;
  const Triangle& first = tin.triangles[tin.vertices[v].triangle];
  const int c = corner_of(first, v);
  for (const TriangleId t : {first.n[next_corner(c)], first.n[previous_corner(c)]}) {
    if (t != kNone) {
      prefetch(&tin.triangles[t]);
    }
  }
}

/// Asks for the triangles beyond those that prefetch_beside() asked for.
void Simplifier::prefetch_beyond(VertexId v) const {
  const Tin& tin = tile_.tin;
  const Triangle& first = tin.triangles[tin.vertices[v].triangle];
  const int c = corner_of(first, v);
  const auto prefetch_next = [&](TriangleId t, int (*side)(int)) {
    if (t != kNone) {
      const TriangleId next = tin.triangles[t].n[side(corner_of(tin.triangles[t], v))];
      if (next != kNone) {
        prefetch(&tin.triangles[next]);
      }
    }
  };
  prefetch_next(first.n[next_corner(c)], next_corner);
  prefetch_next(first.n[previous_corner(c)], previous_corner);
}

void Simplifier::prefetch_star(VertexId v) const {
  for_each_around(v, [this](TriangleId t, int c) {
    prefetch(&tile_.carried[t]);
    const VertexId link = tile_.tin.triangles[t].v[next_corner(c)];
    prefetch(&tile_.tin.vertices[link]);
    prefetch(&tile_.vertex_state[link]);
  });
}

void Simplifier::prefetch_samples(VertexId v) const {
  constexpr std::uint32_t kLine = 64;
  static constexpr std::uint32_t kSamplesAtMost = 32;
  for_each_around(v, [this](TriangleId t, int) {
    const SampleSlot slot = tile_.carried[t].samples;
    const auto* bytes = reinterpret_cast<const char*>(tile_.samples.data(slot));
    const std::size_t length = std::min(slot.count, kSamplesAtMost) * sizeof(Sample);
    for (std::size_t i = 0; i < length; i += kLine) {
      prefetch(bytes + i);
    }
  });
}

/// Most of the time would go by waiting for memory, and the queue says what will be wanted. Asks
/// for it some steps ahead, in the order in which one thing leads to the next: vertex, first
/// triangle, those beside it, those beyond, what the star refers to, samples.
void Simplifier::prefetch_upcoming() const {
  const Tin& tin = tile_.tin;
  if (const QueueEntry* e = queue_.upcoming(16)) {
    prefetch(&tin.vertices[e->vertex]);
    prefetch(&state_[e->vertex]);
  }
  if (const QueueEntry* e = queue_.upcoming(12)) {
    prefetch(&tin.triangles[tin.vertices[e->vertex].triangle]);
  }
  if (const QueueEntry* e = queue_.upcoming(9)) {
    prefetch_beside(e->vertex);
  }
  if (const QueueEntry* e = queue_.upcoming(6)) {
    prefetch_beyond(e->vertex);
  }
  if (const QueueEntry* e = queue_.upcoming(4)) {
    prefetch_star(e->vertex);
  }
  if (const QueueEntry* e = queue_.upcoming(1)) {
    prefetch_samples(e->vertex);
  }
}

void Simplifier::take_top() {
  const QueueEntry top = queue_.top();
  queue_.pop();
  if (state_[top.vertex] == QueueState::kClean) {
    gather_star(tile_, top.vertex, star_);
    std::size_t j = 0;
    while (star_.star.link[j] != target_[top.vertex]) {
      ++j;
      PTIN_DCHECK(j < star_.star.degree());
    }
    collapse(top.vertex, j);
    return;
  }
  const Evaluation e = evaluate(top.vertex);
  if (e.choice.j == CollapseChoice::kNoNeighbour) {
    state_[top.vertex] = QueueState::kAbsent;
    return;
  }
  const QueueEntry measured{e.priority, top.vertex};
  if (queue_.empty() || measured < queue_.top()) {
    collapse(top.vertex, e.choice.j);
    return;
  }
  queue_.push(measured);
  state_[top.vertex] = QueueState::kClean;
  target_[top.vertex] = star_.star.link[e.choice.j];
}

void Simplifier::run() {
  count();
  if (left_ <= options_.keep) {  // as of leaves of which a first pass left less
    return;
  }
  fill_queue();
  tile_.stars.reserve(left_ - options_.keep);
  while (!queue_.empty() && left_ > options_.keep) {
    check_in();
    compact_when_sparse();
    prefetch_upcoming();
    take_top();
  }
}

}  // namespace

void simplify(Tile& tile, const FullSurface& full, const SimplifyOptions& options) {
  Simplifier(tile, &full, options).run();
}

void simplify_carried_samples(Tile& tile, const SimplifyOptions& options) {
  Simplifier(tile, nullptr, options).run();
}

}  // namespace ptin
