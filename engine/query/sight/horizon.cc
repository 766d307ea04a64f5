// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/horizon.h"

#include <algorithm>
#include <cmath>

namespace ptin {

namespace {

/// A number in [0, 4) that grows with the direction, counter-clockwise from the x axis: the way
/// along the diamond |x| + |y| = 1.
double diamond_of(double x, double y) noexcept {
  if (y >= 0) {
    return x >= 0 ? y / (x + y) : 1 - x / (y - x);
  }
  return x < 0 ? 2 - y / (-x - y) : 3 + x / (x - y);
}

/// Share of a bucket by which all borders are turned, so that none lies in a direction of the grid.
constexpr double kFirst = 0.3819660112501051;

}  // namespace

Horizon::Horizon(std::size_t buckets) : buckets_(buckets) {
  const double step = 4.0 / static_cast<double>(buckets);
  for (std::size_t i = 0; i < buckets; ++i) {
    const double at = (static_cast<double>(i) + kFirst) * step;
    const double f = at - std::floor(at);
    switch (static_cast<int>(at) & 3) {
      case 0:
        borders_.push_back({1 - f, f});
        break;
      case 1:
        borders_.push_back({-f, 1 - f});
        break;
      case 2:
        borders_.push_back({f - 1, -f});
        break;
      default:
        borders_.push_back({f, f - 1});
        break;
    }
    buckets_[i].push_back({borders_[i], {}});
  }
  pieces_ = buckets;
}

/// The bucket of a direction: guessed by diamond_of(), which rounding may put one bucket off, then
/// checked against the borders.
std::size_t Horizon::bucket_of(Direction d) const noexcept {
  const auto count = static_cast<double>(buckets_.size());
  const double at = diamond_of(d.x, d.y) * count / 4 - kFirst;
  std::size_t i =
      at < 0 ? buckets_.size() - 1 : std::min(static_cast<std::size_t>(at), buckets_.size() - 1);
  if (turn(borders_[i], d) < 0) {
    i = i == 0 ? buckets_.size() - 1 : i - 1;
  } else if (turn(borders_[after(i)], d) >= 0 && turn(borders_[i], borders_[after(i)]) > 0) {
    i = after(i);
  }
  return i;
}

void Horizon::raise(const Offset& a, const Offset& b) {
  const Plane plane{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  const Direction from{a.x, a.y};
  const Direction to{b.x, b.y};
  const std::size_t last = bucket_of(to);
  std::size_t i = bucket_of(from);
  for (Direction begin = from; i != last; begin = borders_[i]) {
    raise_in(i, begin, borders_[after(i)], plane);
    i = after(i);
    if (i == last) {
      raise_in(i, borders_[i], to, plane);
      return;
    }
  }
  raise_in(i, from, to, plane);
}

/// Appends a piece. It takes the place of a last piece of no width, where planes meet in the
/// direction in which that piece begins.
void Horizon::add(Direction start, const Plane& plane) {
  if (!scratch_.empty() && !(turn(scratch_.back().start, start) > 0)) {
    start = scratch_.back().start;
    scratch_.pop_back();
  }
  if (scratch_.empty() || !(scratch_.back().plane == plane)) {
    scratch_.push_back({start, plane});
  }
}

/// Raises one bucket to a plane between two directions. Most edges are hidden, so nothing is
/// written until a piece is found above which the plane rises. In direction d the plane's slope
/// exceeds the piece's by m . d over the product of both z.
void Horizon::raise_in(std::size_t bucket, Direction from, Direction to, const Plane& plane) {
  std::vector<Piece>& pieces = buckets_[bucket];
  const Direction end = borders_[after(bucket)];
  const auto end_of = [&](std::size_t k) {
    return k + 1 < pieces.size() ? pieces[k + 1].start : end;
  };
  if (!(turn(from, to) > 0)) {
    return;
  }
  std::size_t first = 0;
  while (first + 1 < pieces.size() && turn(pieces[first + 1].start, from) >= 0) {
    ++first;
  }
  bool changed = false;
  std::size_t k = first;
  for (; k < pieces.size(); ++k) {
    const Piece piece = pieces[k];
    const Direction a = k == first ? from : piece.start;
    if (!(turn(a, to) > 0)) {
      break;
    }
    const Direction piece_end = end_of(k);
    const Direction b = turn(piece_end, to) < 0 ? to : piece_end;
    const Direction m{piece.plane.x * plane.z - plane.x * piece.plane.z,
                      piece.plane.y * plane.z - plane.y * piece.plane.z};
    const double at_a = piece.plane.z > 0 ? m.x * a.x + m.y * a.y : 1.0;
    const double at_b = piece.plane.z > 0 ? m.x * b.x + m.y * b.y : 1.0;
    if (!changed) {
      if (!(at_a > 0 || at_b > 0)) {
        continue;
      }
      changed = true;
      scratch_.assign(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(k));
    }
    if (turn(piece.start, a) > 0) {
      add(piece.start, piece.plane);
    }
    const Direction crossing =
        turn(a, {-m.y, m.x}) > 0 ? Direction{-m.y, m.x} : Direction{m.y, -m.x};
    if (at_a > 0) {
      add(a, plane);
      if (at_b < 0) {
        add(crossing, piece.plane);
      }
    } else {
      add(a, piece.plane);
      if (at_b > 0) {
        add(turn(a, crossing) > 0 ? crossing : a, plane);
      }
    }
    if (turn(b, piece_end) > 0) {
      add(b, piece.plane);
    }
  }
  if (changed) {
    for (; k < pieces.size(); ++k) {
      add(pieces[k].start, pieces[k].plane);
    }
    pieces_ += scratch_.size() - pieces.size();
    pieces.assign(scratch_.begin(), scratch_.end());
  }
}

bool Horizon::sees(const Offset& p, Side side, const Offset& along) const noexcept {
  const Direction d{along.x, along.y};
  const std::size_t bucket = bucket_of(d);
  const std::vector<Piece>& pieces = buckets_[bucket];
  std::size_t k = 0;
  while (k + 1 < pieces.size() && turn(pieces[k + 1].start, d) >= 0) {
    ++k;
  }
  const bool meets = k > 0 && turn(pieces[k].start, d) == 0;
  if (!meets) {
    return !hides(pieces[k].plane, p);
  }
  return (side == Side::kRight || !hides(pieces[k].plane, p)) &&
         (side == Side::kLeft || !hides(pieces[k - 1].plane, p));
}

}  // namespace ptin
