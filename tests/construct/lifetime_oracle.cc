// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/lifetime_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include "tests/construct/surface_oracle.h"

namespace ptin::oracle {

namespace {

constexpr std::size_t kNobody = SIZE_MAX;

std::string place_of(GridPoint p) { return std::to_string(p.x) + " " + std::to_string(p.y); }

struct Soup {
  struct Held {
    std::array<VertexKey, 3> keys{};
    bool is_void = false;
    std::size_t maker = kNobody, successor = kNobody;  ///< Records, in the order given.
    std::size_t ring_place = 0;  ///< In the star of its maker; in T0's triangles where it has none.
  };
  struct Height {
    HeightBits bits = 0;
    bool is_there = false;
  };
  std::vector<Held> triangles;  ///< All that ever were.
  /// The present triangle to the left of the edge, and the corner opposite.
  std::map<std::pair<VertexKey, VertexKey>, std::pair<std::size_t, VertexKey>> left_of;
  std::map<VertexKey, Height> heights;

  void add(const Held& t) {
    for (std::size_t i = 0; i < 3; ++i) {
      left_of[{t.keys[i], t.keys[(i + 1) % 3]}] = {triangles.size(), t.keys[(i + 2) % 3]};
    }
    triangles.push_back(t);
  }
  void end(std::size_t t, std::size_t successor) {
    triangles[t].successor = successor;
    for (std::size_t i = 0; i < 3; ++i) {
      left_of.erase({triangles[t].keys[i], triangles[t].keys[(i + 1) % 3]});
    }
  }
};

/// The ring that a split makes, and the classes of its triangles.
struct Ring {
  std::vector<VertexKey> keys;
  std::vector<bool> voids;
};

class StarReplay {
 public:
  explicit StarReplay(const BuiltStars& built) : built_(built) {}
  std::string run();

 private:
  void take_t0();
  std::string split(std::size_t i);
  std::optional<Ring> replace_fan(std::size_t i);
  std::string check_ring(std::size_t i, const Ring& ring) const;
  std::string check_deaths() const;
  [[nodiscard]] float error_of(std::size_t record) const {
    return record == kNobody ? kLivesOn : built_.records.splits[record].error;
  }

  const BuiltStars& built_;
  Soup soup_;
};

void StarReplay::take_t0() {
  const Tin& t0 = built_.t0;
  for (TriangleId t = 0; t < t0.triangles.size(); ++t) {
    if (t0.is_alive(t)) {
      Soup::Held held;
      for (std::size_t i = 0; i < 3; ++i) {
        const VertexId v = t0.triangles[t].v[i];
        held.keys[i] = key_of(t0.position(v));
        soup_.heights[held.keys[i]] = {t0.vertices[v].height, t0.has_height[v] != 0};
      }
      held.is_void = t0.classes[t] == TriangleClass::kVoid;
      held.ring_place = t;
      soup_.add(held);
    }
  }
}

/// Ends the triangles of the fan. Returns the ring of the star that takes their place; none where
/// the fan is not there.
std::optional<Ring> StarReplay::replace_fan(std::size_t i) {
  const VertexSplit& r = built_.records.splits[i];
  const VertexKey w = key_of(r.w), vr = key_of(r.vr);
  Ring ring;
  const bool has_left = (r.flags & VertexSplit::kNoLeft) == 0;
  const bool has_right = (r.flags & VertexSplit::kNoRight) == 0;
  if (has_left) {
    ring.keys.push_back(w);
    ring.voids.push_back((r.flags & VertexSplit::kLeftVoid) != 0);
  }
  VertexKey at = key_of(r.vl);
  ring.keys.push_back(at);
  while (at != vr) {
    const auto found = soup_.left_of.find({w, at});
    if (found == soup_.left_of.end()) {
      return std::nullopt;
    }
    const auto [triangle, next] = found->second;
    ring.voids.push_back(soup_.triangles[triangle].is_void);
    ring.keys.push_back(next);
    soup_.end(triangle, i);
    at = next;
  }
  if (has_right) {
    ring.voids.push_back((r.flags & VertexSplit::kRightVoid) != 0);
    if (!has_left) {
      ring.keys.push_back(w);
    }
  }
  return ring;
}

std::string StarReplay::split(std::size_t i) {
  const VertexSplit& r = built_.records.splits[i];
  const std::optional<Ring> ring = replace_fan(i);
  if (!ring) {
    return "the fan is not there";
  }
  const VertexKey u = key_of(r.u);
  soup_.heights[u] = {r.height, (r.flags & VertexSplit::kVertexVoid) == 0};
  for (std::size_t k = 0; k < ring->voids.size(); ++k) {
    Soup::Held held;
    held.keys = {u, ring->keys[k], ring->keys[(k + 1) % ring->keys.size()]};
    held.is_void = ring->voids[k];
    held.maker = i;
    held.ring_place = k;
    soup_.add(held);
  }
  return check_ring(i, *ring);
}

std::string StarReplay::check_ring(std::size_t i, const Ring& ring) const {
  const std::span<const RingCorner> corners = built_.records.ring(i);
  if (corners.size() != ring.keys.size()) {
    return "the ring has " + std::to_string(corners.size()) + " corners, not " +
           std::to_string(ring.keys.size());
  }
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Soup::Height height = soup_.heights.at(ring.keys[k]);
    const bool is_triangle = k < ring.voids.size();
    const unsigned flags = (height.is_there ? 0U : unsigned{RingCorner::kNoHeight}) |
                           (is_triangle && ring.voids[k] ? unsigned{RingCorner::kVoid} : 0U);
    if (key_of(corners[k].position) != ring.keys[k]) {
      return "a corner of the ring is at " + place_of(corners[k].position);
    }
    if (corners[k].height != (height.is_there ? height.bits : 0)) {
      return "the height of a corner is another";
    }
    if (corners[k].flags != flags) {
      return "the flags of a corner are others";
    }
    if (!is_triangle && corners[k].death != kLivesOn) {
      return "the last corner of an open ring has a death";
    }
  }
  return {};
}

std::string StarReplay::check_deaths() const {
  for (const Soup::Held& t : soup_.triangles) {
    const float death = t.maker == kNobody ? built_.t0_deaths[t.ring_place]
                                           : built_.records.ring(t.maker)[t.ring_place].death;
    const std::string what = "a triangle made at " + place_of(point_of(t.keys[0]));
    if (death != error_of(t.successor)) {
      return what + " dies at " + std::to_string(death) + ", not at " +
             std::to_string(error_of(t.successor));
    }
    if (t.maker != kNobody && death > error_of(t.maker)) {
      return what + " dies above its maker's error";
    }
  }
  return {};
}

std::string StarReplay::run() {
  const StarredRecords& records = built_.records;
  if (built_.t0_deaths.size() != built_.t0.triangles.size() ||
      records.ring_end.size() != records.splits.size() ||
      (records.empty() ? 0 : records.ring_end.back()) != records.corners.size()) {
    return "arrays have other lengths than those that they lie beside";
  }
  take_t0();
  std::vector<std::size_t> order(records.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return records.splits[a].rank > records.splits[b].rank;
  });
  for (const std::size_t i : order) {
    if (const std::string fault = split(i); !fault.empty()) {
      return "the record at " + place_of(records.splits[i].u) + ": " + fault;
    }
  }
  return check_deaths();
}

/// Calls visit(triangle's corners, is void, death, error of the maker) for every triangle.
template <class Visit>
void for_each_lifetime(const BuiltStars& built, const Visit& visit) {
  const Tin& t0 = built.t0;
  for (TriangleId t = 0; t < t0.triangles.size(); ++t) {
    const Triangle& c = t0.triangles[t];
    if (t0.is_alive(t)) {
      visit(std::array{t0.position(c.v[0]), t0.position(c.v[1]), t0.position(c.v[2])},
            t0.classes[t] == TriangleClass::kVoid, built.t0_deaths[t],
            std::numeric_limits<double>::infinity());
    }
  }
  for (std::size_t i = 0; i < built.records.size(); ++i) {
    const VertexSplit& r = built.records.splits[i];
    const std::span<const RingCorner> ring = built.records.ring(i);
    for (std::size_t k = 0; k + (has_closed_ring(r) ? 0 : 1) < ring.size(); ++k) {
      visit(std::array{r.u, ring[k].position, ring[(k + 1) % ring.size()].position},
            (ring[k].flags & RingCorner::kVoid) != 0, ring[k].death, static_cast<double>(r.error));
    }
  }
}

/// @param error  None: the finest TIN.
std::vector<NamedTriangle> living_at(const BuiltStars& built, std::optional<double> error) {
  std::vector<NamedTriangle> living;
  for_each_lifetime(
      built, [&](const std::array<GridPoint, 3>& corners, bool is_void, float death, double born) {
        const bool lives =
            error ? static_cast<double>(death) <= *error && *error < born : death == kLivesOn;
        if (lives) {
          std::array<VertexKey, 3> k{key_of(corners[0]), key_of(corners[1]), key_of(corners[2])};
          std::rotate(k.begin(), std::min_element(k.begin(), k.end()), k.end());
          living.emplace_back(k[0], k[1], k[2],
                              is_void ? TriangleClass::kVoid : TriangleClass::kSurface);
        }
      });
  std::sort(living.begin(), living.end());
  return living;
}

/// Errors of records, each also a step above and below, and some between.
std::vector<double> errors_to_try(const StarredRecords& records, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> errors{0.0, std::numeric_limits<double>::max()};
  for (int i = 0; i < 2 && !records.empty(); ++i) {
    const float e = records.splits[random() % records.size()].error;
    if (std::isfinite(e)) {
      errors.insert(errors.end(), {e, std::nextafter(e, 0.0F), std::nextafter(e, 1e30F), 0.7 * e});
    }
  }
  return errors;
}

}  // namespace

std::string check_stars(const BuiltStars& built) { return StarReplay(built).run(); }

std::string check_intervals(const BuiltStars& built, std::uint64_t seed) {
  std::vector<std::optional<double>> errors{std::nullopt};
  for (const double e : errors_to_try(built.records, seed)) {
    errors.emplace_back(e);
  }
  Tin coarse = built.t0;  // with every vertex in its place
  for (const VertexSplit& r : built.records.splits) {
    coarse.vertices.push_back({r.u, r.height, kNone});
    coarse.has_height.push_back((r.flags & VertexSplit::kVertexVoid) == 0 ? 1 : 0);
  }
  for (const std::optional<double> error : errors) {
    std::string fault;
    const Tin tin = refined(
        coarse, built.records.splits,
        [&](const VertexSplit& r) { return !error || static_cast<double>(r.error) > *error; },
        fault);
    if (fault.empty() && living_at(built, error) != named_triangles(tin)) {
      fault = "the living triangles are not those of the TIN";
    }
    if (!fault.empty()) {
      return "at " + (error ? std::to_string(*error) : "no error") + ": " + fault;
    }
  }
  return {};
}

}  // namespace ptin::oracle
