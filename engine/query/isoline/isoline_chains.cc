// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_chains.h"

#include <algorithm>
#include <bit>

#include "engine/prefetch.h"
#include "engine/stop.h"

namespace ptin {

namespace {

/// How far ahead of a look-up its slot is fetched.
constexpr std::uint32_t kAhead = 16;

}  // namespace

void ChainSet::clear() noexcept {
  chains_.grow(0);
  points_.grow(0);
}

void ChainSet::begin(const Step& step, std::uint32_t level) {
  push({.begin = step.edge, .end = step.edge, .smallest = step.edge, .level = level, .count = 1},
       {&step.point, 1});
}

void ChainSet::extend(const Step& step) {
  Chain& last = chains_.data()[chains_.size() - 1];
  last.end = step.edge;
  if (step.edge < last.smallest) {
    last.smallest = step.edge;
    last.smallest_at = last.count;
  }
  ++last.count;
  const std::size_t at = points_.size();
  points_.grow(at + 1);
  points_.data()[at] = step.point;
}

void ChainSet::add(const IsolinePiece& piece, std::span<const MapPoint> points) {
  push({.begin = piece.begin,
        .end = piece.end,
        .smallest = piece.smallest,
        .level = piece.level,
        .count = piece.count,
        .smallest_at = piece.smallest_at},
       points);
}

void ChainSet::push(const Chain& chain, std::span<const MapPoint> points) {
  const std::size_t chains = chains_.size();
  const std::size_t at = points_.size();
  chains_.grow(chains + 1);
  points_.grow(at + points.size());
  chains_.data()[chains] = chain;
  chains_.data()[chains].first = static_cast<std::uint32_t>(at);
  std::copy(points.begin(), points.end(), points_.data() + at);
}

std::uint64_t ChainSet::hash_of(const CutEdge& edge, std::uint32_t level) noexcept {
  constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;  // 2^64 / phi, odd
  const std::uint64_t both =
      (edge.below * kGoldenRatio) ^ std::rotl(edge.above * kGoldenRatio, 29) ^ level;
  return (both ^ (both >> 31)) * kGoldenRatio;
}

void ChainSet::note_begin(std::uint32_t chain) noexcept {
  const std::uint64_t hash = hash_of(this->chain(chain).begin, this->chain(chain).level);
  std::size_t i = home(hash);
  while (slots_[i].chain != kNone) {
    i = i + 1 == slots_.size() ? 0 : i + 1;
  }
  slots_[i] = {static_cast<std::uint32_t>(hash), chain};
}

/// The chain that begins on an edge at a level, or kNone.
std::uint32_t ChainSet::chain_from(const CutEdge& edge, std::uint32_t level) const noexcept {
  const std::uint64_t hash = hash_of(edge, level);
  for (std::size_t i = home(hash); slots_[i].chain != kNone;
       i = i + 1 == slots_.size() ? 0 : i + 1) {
    const std::uint32_t chain = slots_[i].chain;
    if (slots_[i].tag == static_cast<std::uint32_t>(hash) && this->chain(chain).level == level &&
        this->chain(chain).begin == edge) {
      return chain;
    }
  }
  return kNone;
}

/// Finds the chain behind each.
void ChainSet::link(const QueryContext& context) {
  slots_.assign(chains_.size() + chains_.size() * 3 / 5 + 2, {});
  const auto fetch = [&](std::uint32_t i, CutEdge Chain::*edge) {
    if (i < chains_.size()) {
      prefetch(&slots_[home(hash_of(chain(i).*edge, chain(i).level))]);
    }
  };
  for (std::uint32_t i = 0; i < chains_.size(); ++i) {
    fetch(i + kAhead, &Chain::begin);
    note_begin(i);
  }
  context.check_stop();
  for (std::uint32_t i = 0; i < chains_.size(); ++i) {
    fetch(i + kAhead, &Chain::end);
    chain(i).next = chain_from(chain(i).end, chain(i).level);
    if (chain(i).next != kNone) {
      chain(chain(i).next).is_next = true;
    }
  }
}

/// Takes the line that begins with a chain: its points are those of the line at hand.
IsolinePiece ChainSet::take_line(std::uint32_t start, bool ring) {
  IsolinePiece piece;
  piece.level = chain(start).level;
  piece.ring = ring;
  piece.smallest = {kNoVertexKey, kNoVertexKey};
  std::uint32_t holder = start;  // of the smallest edge
  std::uint32_t last = start;
  std::size_t points = 1;
  for (std::uint32_t i = start; i != kNone && !chain(i).is_taken;) {
    Chain& c = chain(i);
    c.is_taken = true;
    points += c.count;
    if (c.smallest < piece.smallest) {
      piece.smallest = c.smallest;
      holder = i;
    }
    last = i;
    i = c.next;
  }
  line_.grow(points);
  line_points_ = 0;
  if (ring) {
    copy_ring(holder);
  } else {
    piece.begin = chain(start).begin;
    piece.end = chain(last).end;
    piece.smallest_at = copy_line(start, holder);
  }
  piece.count = static_cast<std::uint32_t>(line_points_);
  return piece;
}

/// Copies a ring from its smallest edge on, which chain `holder` crosses, and back to it.
void ChainSet::copy_ring(std::uint32_t holder) {
  const Chain& first = chain(holder);
  copy_points(first, first.smallest_at, first.count);
  for (std::uint32_t i = first.next; i != holder; i = chain(i).next) {
    copy_points(chain(i), 1, chain(i).count);
  }
  copy_points(first, 1, first.smallest_at + 1);
}

/// Copies an open line, and returns which of its points lies on its smallest edge.
std::uint32_t ChainSet::copy_line(std::uint32_t start, std::uint32_t holder) {
  std::uint32_t smallest_at = 0;
  for (std::uint32_t i = start; i != kNone; i = chain(i).next) {
    const Chain& c = chain(i);
    std::uint32_t at = i == start ? 0 : 1;  // a chain begins where the one before it ends
    if (i == holder) {
      copy_points(c, at, c.smallest_at + 1);
      smallest_at = static_cast<std::uint32_t>(line_points_ - 1);
      at = c.smallest_at + 1;
    }
    copy_points(c, at, c.count);
  }
  return smallest_at;
}

/// Copies points [from, to) of a chain, of which no two are equal in a row then.
void ChainSet::copy_points(const Chain& chain, std::uint32_t from, std::uint32_t to) noexcept {
  const MapPoint* const points = points_.data() + chain.first;
  MapPoint* const out = line_.data();
  for (std::uint32_t k = from; k < to; ++k) {
    if (line_points_ == 0 || out[line_points_ - 1] != points[k]) {
      out[line_points_++] = points[k];
    }
  }
}

}  // namespace ptin
