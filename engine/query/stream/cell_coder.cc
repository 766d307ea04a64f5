// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/cell_coder.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "engine/geometry/hilbert.h"
#include "engine/query/stream/split_symbols.h"
#include "engine/query/stream/stream_format.h"

namespace ptin {

namespace {

std::uint64_t place_on_curve(GridPoint p) noexcept {
  return hilbert_position(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y));
}

/// A vertex or a split, and what it is sorted by.
struct Sorted {
  std::uint64_t by;
  std::uint32_t index;
  friend bool operator<(const Sorted& a, const Sorted& b) noexcept { return a.by < b.by; }
};

/// Puts `things[order[i].index]` at i. Clears the order.
void arrange(std::vector<PendingSplit>& things, std::vector<Sorted>& order) {
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    if (order[i].index == i) continue;
    const PendingSplit first = things[i];
    std::uint32_t at = i;
    while (order[at].index != i) {
      things[at] = things[order[at].index];
      at = std::exchange(order[at].index, at);
    }
    things[at] = first;
    order[at].index = at;
  }
  order.clear();
}

}  // namespace

CellCoder::CellCoder(const Tin& base, std::vector<PendingSplit> splits, const FrameCuts& cuts,
                     const GridCell& cell, std::uint32_t number, HeightType type,
                     const QueryContext& context)
    : cell_(cell),
      number_(number),
      context_(context),
      code_(type),
      splits_(std::move(splits)),
      ranks_(put_in_places(base, cuts)),
      mesh_(base, splits_.size()),
      ahead_(base, splits_.size()) {
  reserve_large(marks_, base.triangles.size() + 2 * splits_.size());
  marks_.resize(base.triangles.size(), 0);
  for (const std::uint32_t along : along_) {
    if (is_inside(along)) ranks_.add(along);
    base_vertices_ += is_inside(along) ? 1 : 0;
  }
}

std::uint64_t CellCoder::bytes_of(std::uint64_t base_vertices, std::uint64_t splits) noexcept {
  // Of each vertex two places along the curve, marks of two triangles, and a bit; of a frame what puts
  // it in order.
  constexpr std::uint64_t kOfVertex = 2 * 4 + 2 * 4 + 1;
  constexpr std::uint64_t kOfFrame = 64;
  const std::uint64_t all = base_vertices + splits;
  const std::uint64_t frame = FrameCuts::most_of_frame(base_vertices, splits);
  return 2 * GrowingMesh::bytes_of(all) + kOfVertex * all + splits * sizeof(PendingSplit) +
         kOfFrame * frame;
}

/// Places vertices along the curve, and sorts the splits, before there are meshes: that takes memory too.
/// @return the number of places
std::size_t CellCoder::put_in_places(const Tin& base, const FrameCuts& cuts) {
  place_along_curve(base);
  sort(cuts);
  return base.vertices.size() + splits_.size();
}

/// Numbers the vertices of the base and of all splits along the curve.
void CellCoder::place_along_curve(const Tin& base) {
  const std::size_t base_size = base.vertices.size();
  std::vector<Sorted> all;
  reserve_large(all, base_size + splits_.size());
  for (VertexId v = 0; v < base_size; ++v) all.push_back({place_on_curve(base.position(v)), v});
  for (const PendingSplit& s : splits_) {
    all.push_back({place_on_curve(point_of(s.u)), static_cast<std::uint32_t>(all.size())});
  }
  std::sort(all.begin(), all.end());
  const auto is_of_cell = [&](const Sorted& s) {
    const std::uint32_t i = s.index;
    return cell_.holds(i < base_size ? base.position(i) : point_of(splits_[i - base_size].u));
  };
  const auto first = std::find_if(all.begin(), all.end(), is_of_cell);
  const auto end = std::find_if_not(first, all.end(), is_of_cell);
  inside_ = static_cast<std::uint32_t>(first - all.begin());
  inside_end_ = static_cast<std::uint32_t>(end - all.begin());
  along_.reserve(base_size + splits_.size());
  along_.resize(base_size);
  split_along_.resize(splits_.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    const std::uint32_t index = all[i].index;
    (index < base_size ? along_[index] : split_along_[index - base_size]) = i;
  }
}

/// Sorts the splits by frame, falling rank, and along the curve, where the mesh is in the caches.
void CellCoder::sort(const FrameCuts& cuts) {
  std::vector<Sorted> order;
  reserve_large(order, splits_.size());
  for (std::uint32_t i = 0; i < splits_.size(); ++i) {
    const std::uint64_t frame = cuts.frame_of(place_of(splits_[i]));
    order.push_back({frame << 48 |
                         std::uint64_t{static_cast<std::uint16_t>(~splits_[i].rank)} << 32 |
                         split_along_[i],
                     i});
  }
  std::sort(order.begin(), order.end());
  begins_.reserve(cuts.frames() + 1);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    split_along_[i] = static_cast<std::uint32_t>(order[i].by);
    while (begins_.size() <= order[i].by >> 48) begins_.push_back(i);
  }
  begins_.resize(cuts.frames() + 1, static_cast<std::uint32_t>(order.size()));
  arrange(splits_, order);
}

void CellCoder::code(std::vector<std::byte>& out) {
  const std::uint32_t begin = begins_[frame_], end = begins_[frame_ + 1];
  ++frame_;
  born_ = 0;
  if (begin == end) return;
  context_.check_stop();
  ranks_.count();
  const auto frame = std::span(splits_).subspan(begin, end - begin);
  const VertexId first = mesh_.next();
  std::vector<SplitTurn> turns = turns_of(frame);
  if (!put_in_order(turns)) {
    throw_refused(frame.front(), "a record of its frame does not come after the one that it needs",
                  context_);
  }
  std::size_t done = 0;
  for (const SplitTurn& turn : turns) {
    if (++done % kStopInterval == 0) context_.check_stop();
    const PendingSplit& s = frame[turn.at];
    const SplitSite site = mesh_.site(s, context_);
    if (cell_.holds(point_of(s.w))) code_one(s, turn, site, out);
    mesh_.apply(s, site, context_);
    along_.push_back(split_along_[begin + turn.at]);
  }
  for (VertexId v = first; v < mesh_.next(); ++v) {
    if (!is_inside(along_[v])) continue;
    ranks_.add(along_[v]);
    ++born_;
  }
}

/// Applies a frame on the mesh ahead, and finds what orders its splits.
std::vector<SplitTurn> CellCoder::turns_of(std::span<const PendingSplit> frame) {
  std::vector<SplitTurn> turns;
  turns.reserve(frame.size());
  const VertexId first = ahead_.next();
  std::uint32_t most = 0;
  for (const PendingSplit& s : frame) {
    if (turns.size() % kStopInterval == 0) context_.check_stop();
    const SplitSite site = ahead_.site(s, context_);
    const std::uint32_t level = level_of(s, site);
    most = std::max(most, level);
    turns.push_back({site.w >= first ? SplitTurn::kMadeHere + (site.w - first) : 0, s.u, level,
                     static_cast<std::uint32_t>(turns.size())});
  }
  mark_ += most + 1;
  for (SplitTurn& turn : turns) {
    if (turn.w < SplitTurn::kMadeHere) turn.w = along_[mesh_.find(frame[turn.at].w)];
  }
  return turns;
}

/// The level of a split: the longest chain of splits of its frame that it depends on. Applies it on
/// the mesh ahead.
std::uint32_t CellCoder::level_of(const PendingSplit& s, const SplitSite& site) {
  const SplitResult made = ahead_.apply(s, site, context_);
  marks_.resize(ahead_.tin().triangles.size(), 0);
  walk_star(ahead_.tin(), site.u, star_);
  std::uint32_t mark = mark_;
  for (const TriangleId t : star_.triangles) {
    mark = t == made.left || t == made.right ? mark : std::max(mark, marks_[t]);
  }
  for (const TriangleId t : star_.triangles) marks_[t] = mark + 1;
  return mark - mark_;
}

void CellCoder::code_one(const PendingSplit& s, const SplitTurn& turn, const SplitSite& site,
                         std::vector<std::byte>& out) {
  const std::size_t head = out.size();
  out.resize(head + CodedSplit::kBytes);
  RecordedSymbols symbols(out);
  const LocalSplit local{site.w, site.vl, site.vr, point_of(s.u), s.height, s.flags};
  if (const char* fault = code_.record(symbols, mesh_.tin(), local); fault != nullptr) {
    throw_refused(s, std::string("it ") + fault, context_);
  }
  const std::uint64_t w = turn.w < SplitTurn::kMadeHere
                              ? number_ << 32 | ranks_.before(along_[site.w])
                              : SplitTurn::kMadeHere | s.w;
  const auto level = static_cast<std::uint16_t>(turn.level);
  const auto bytes = static_cast<std::uint8_t>(out.size() - head - CodedSplit::kBytes);
  std::memcpy(&out[head], &w, 8);
  std::memcpy(&out[head + 8], &s.u, 8);
  std::memcpy(&out[head + 16], &level, 2);
  std::memcpy(&out[head + 18], &bytes, 1);
  digest_ += stream::digest_of(point_of(s.u), s.height, (s.flags & VertexSplit::kVertexVoid) == 0);
}

}  // namespace ptin
