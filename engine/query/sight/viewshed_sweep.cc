// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/viewshed_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "engine/error.h"
#include "engine/query/sight/horizon.h"
#include "engine/query/sight/viewshed_eye.h"
#include "engine/query/sight/viewshed_walk.h"

namespace ptin {

namespace {

constexpr std::uint64_t kVertexBytes = sizeof(Offset) + 1 + sizeof(VertexId);
constexpr std::uint64_t kTriangleBytes = 1 + 1 + sizeof(TriangleId);
/// A centre, an offset, differences and products of these round by 2^-53 of a coordinate each, and are not
/// more than eight.
constexpr double kCrossRoundings = 0x1p-50;
constexpr double kMostBuckets = 65536;
constexpr std::uint64_t kBucketBytes = 192;  // of the horizon, with a few pieces in each

/// Whether a target of a triangle is looked at from within the triangle, and by which pieces of the
/// horizon.
struct Approach {
  bool from_within = false;
  Horizon::Side side = Horizon::Side::kBoth;
};

/// Where a centre lies in a triangle, and how the ray comes to it.
struct PlaceInTriangle {
  double weights[3] = {};  ///< Of the corners; none is below 0.
  Horizon::Side side = Horizon::Side::kBoth;
  Offset along;  ///< In its direction the pieces of the horizon are looked up.
};

class Viewer {
 public:
  Viewer(const Tin& tin, const StoreFacts& facts, const ViewshedRequest& request,
         const QueryContext& context, const SightBias& bias, const HeldBySweeps& held)
      : tin_(tin), facts_(facts), request_(request), context_(context), bias_(bias), held_(held) {
    eye_ = find_eye(tin, facts, request);
    eye_at_ = grid_of(eye_.spot);
    ground_x_ = facts.map.step_x * request.ground_per_map_x;
    ground_y_ = facts.map.step_y * request.ground_per_map_y;
  }

  Viewshed run() {
    result_.eye_height = eye_.height;
    if (request_.pixels) {
      place_pixels();
    }
    admit();
    result_.pixels.assign(std::size_t{result_.width} * result_.height, Sight::kNothing);
    place_vertices();
    sweep();
    collect();
    return std::move(result_);
  }

 private:
  void admit() const;
  void place_vertices();
  void place_pixels();
  void sweep();
  void walk_to_others(const std::vector<std::uint8_t>& waits, Horizon& horizon);
  [[nodiscard]] std::vector<VertexId> seen_vertices() const;
  [[nodiscard]] int least_corner(TriangleId t) const noexcept;
  void collect();
  [[nodiscard]] bool sees(const Offset& at, Spot spot, Horizon::Side side, const Offset& along,
                          const Horizon& horizon);
  [[nodiscard]] std::size_t buckets() const noexcept {
    // The shortest edges are about a grid unit long, so four times the radius in grid units is what
    // Horizon advises. kMostBuckets keeps the horizon near 12 MiB, whatever the radius.
    const double across = std::max(request_.radius / ground_x_, request_.radius / ground_y_);
    return static_cast<std::size_t>(std::clamp(4 * across, 64.0, kMostBuckets));
  }
  [[nodiscard]] Spot spot_at(const Offset& p) const noexcept {
    return {eye_.spot.x + std::llround(std::ldexp(p.x, kSpotBits)),
            eye_.spot.y + std::llround(std::ldexp(p.y, kSpotBits))};
  }
  void look_at(TriangleId t, Horizon& horizon);
  void raise(TriangleId t, TriangleId n, Offset a, Offset b, Horizon& horizon) const;
  [[nodiscard]] double longest_side(TriangleId t) const noexcept;
  /// How far the full surface may be from the swept one at an offset. Rounded up.
  [[nodiscard]] double unknown_at(double x, double y) const noexcept {
    const double gx = x * ground_x_;
    const double gy = y * ground_y_;
    // Products, sum and root each round by 2^-53 of their value; 1e-12 is some thousand times that.
    return bias_.slope * std::sqrt(gx * gx + gy * gy) * (1 + 1e-12) + bias_.base;
  }
  void look_at_pixels(TriangleId t, const Horizon& horizon);
  void look_at_pixels_behind(TriangleId t, const Horizon& horizon);
  void look_at_box(TriangleId t, const Horizon& horizon, std::initializer_list<Offset> points);
  void look_at_pixel(TriangleId t, const Horizon& horizon, std::int64_t column, std::int64_t row);
  [[nodiscard]] bool is_on_line(const Offset& a, const Offset& b, const Offset& p) const noexcept;
  [[nodiscard]] std::optional<PlaceInTriangle> place_in(const std::array<Offset, 3>& o,
                                                        const Offset& p) const noexcept;
  [[nodiscard]] Approach approach_corner(const std::array<Offset, 3>& o, int corner) const noexcept;
  [[nodiscard]] double drop(double x, double y) const noexcept {
    const double gx = x * ground_x_;
    const double gy = y * ground_y_;
    return request_.curvature.drop_at_square(gx * gx + gy * gy);
  }
  [[nodiscard]] bool within(double x, double y) const noexcept {
    const double gx = x * ground_x_;
    const double gy = y * ground_y_;
    return gx * gx + gy * gy <= request_.radius * request_.radius;
  }
  [[nodiscard]] std::array<Offset, 3> offsets(TriangleId t) const noexcept {
    const auto& v = tin_.triangles[t].v;
    return {offsets_[v[0]], offsets_[v[1]], offsets_[v[2]]};
  }
  [[nodiscard]] bool is_surface(TriangleId t) const noexcept {
    return t != kNone && tin_.classes[t] == TriangleClass::kSurface;
  }
  /// Combines the answers for a target. A target in line with an edge is looked at along it from
  /// both sides, each when the triangle of that side comes: only then are the edges that were
  /// raised on that side in front of the target. It is visible when both sides see it.
  static void see(Sight& target, bool visible) noexcept {
    target = visible && target != Sight::kHidden ? Sight::kVisible : Sight::kHidden;
  }

  const Tin& tin_;
  const StoreFacts& facts_;
  const ViewshedRequest& request_;
  const QueryContext& context_;
  SightBias bias_;
  HeldBySweeps held_;
  ViewshedEye eye_;
  MapPoint eye_at_;  ///< Grid units.
  double ground_x_ = 1, ground_y_ = 1;
  std::vector<Offset> offsets_;  ///< For each vertex: x, y in grid units, z in the height's unit.
  std::vector<Sight> seen_;      ///< For each vertex; kNothing: not looked at yet.
  double pixel_x_ = 1, pixel_y_ = 1;  ///< Grid units.
  double first_x_ = 0, first_y_ = 0;  ///< Offset of pixel 0.
  bool pixels_on_grid_ = false;
  std::optional<WalkedView> walked_;  ///< Set once the triangles left have no order.
  Viewshed result_;
};

/// Asks for the memory of mesh, rasters and horizon together, before any of it is taken.
void Viewer::admit() const {
  const std::uint64_t a_vertex =
      kVertexBytes + (request_.list_vertices ? held_.results * sizeof(Viewshed::Target) : 0);
  context_.admit(held_.mesh_bytes + held_.results * result_.width * result_.height +
                 tin_.vertices.size() * a_vertex + tin_.triangles.size() * kTriangleBytes +
                 buckets() * kBucketBytes);
}

void Viewer::place_vertices() {
  offsets_.reserve(tin_.vertices.size());
  for (const Vertex& v : tin_.vertices) {
    if (offsets_.size() % kStopInterval == 0) {
      context_.check_stop();
    }
    const double x = v.position.x - eye_at_.x;
    const double y = v.position.y - eye_at_.y;
    offsets_.push_back({x, y, facts_.heights.height(v.height) - result_.eye_height - drop(x, y)});
  }
  seen_.assign(tin_.vertices.size(), Sight::kNothing);
}

void Viewer::place_pixels() {
  pixel_x_ = request_.pixel_size ? (*request_.pixel_size)[0] / facts_.map.step_x : 1.0;
  pixel_y_ = request_.pixel_size ? (*request_.pixel_size)[1] / facts_.map.step_y : 1.0;
  pixels_on_grid_ = !request_.pixel_size;
  const double reach_x = std::floor(request_.radius / (ground_x_ * pixel_x_));
  const double reach_y = std::floor(request_.radius / (ground_y_ * pixel_y_));
  // Counts must fit 32 bits, also where the radius over the pixel size is infinite.
  constexpr double kMostPixels = 1e5;
  if (reach_x > kMostPixels || reach_y > kMostPixels) {
    refuse("the raster has more than 200 000 pixels a side: give a larger pixel size");
  }
  // On the grid, centres are the grid points, wherever the eye is.
  const double centre_x = pixels_on_grid_ ? std::floor(eye_at_.x + 0.5) - eye_at_.x : 0.0;
  const double centre_y = pixels_on_grid_ ? std::floor(eye_at_.y + 0.5) - eye_at_.y : 0.0;
  result_.width = static_cast<std::uint32_t>(2 * reach_x) + 1;
  result_.height = static_cast<std::uint32_t>(2 * reach_y) + 1;
  first_x_ = centre_x - reach_x * pixel_x_;
  first_y_ = centre_y + reach_y * pixel_y_;
  result_.first = facts_.map.to_map(eye_at_.x + first_x_, eye_at_.y + first_y_);
  result_.step_x = pixel_x_ * facts_.map.step_x;
  result_.step_y = pixel_y_ * facts_.map.step_y;
}

/// Takes the triangles front to back: a triangle comes when all neighbours across the sides that
/// face the eye have come. The sides that turn their back to the eye are raised after their
/// triangle has been looked at.
void Viewer::sweep() {
  std::vector<std::uint8_t> waits(tin_.triangles.size());
  std::vector<TriangleId> ready;
  std::size_t left = 0;
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    if (t % kStopInterval == 0) {
      context_.check_stop();
    }
    if (!tin_.is_alive(t)) {
      continue;
    }
    ++left;
    const auto o = offsets(t);
    for (int i = 0; i < 3; ++i) {
      // Doubles give turn(b, a) as exactly -turn(a, b), so the triangles on both hands of a side
      // agree on which of them waits. A side in line with the eye hides neither from the other.
      const bool faces = turn(o[static_cast<std::size_t>(next_corner(i))],
                              o[static_cast<std::size_t>(previous_corner(i))]) < 0;
      if (faces && tin_.triangles[t].n[i] != kNone) {
        ++waits[t];
      }
    }
    if (waits[t] == 0) {
      ready.push_back(t);
    }
  }
  Horizon horizon(buckets());
  // The triangle that became ready last comes first. Any order that keeps front before back would
  // do; this one stays where the mesh and the horizon are in the caches.
  while (!ready.empty()) {
    if (left % kStopInterval == 0) {
      context_.check_stop();
    }
    const TriangleId t = ready.back();
    ready.pop_back();
    --left;
    look_at(t, horizon);
    const auto o = offsets(t);
    for (int i = 0; i < 3; ++i) {
      const Offset& a = o[static_cast<std::size_t>(next_corner(i))];
      const Offset& b = o[static_cast<std::size_t>(previous_corner(i))];
      if (!(turn(a, b) > 0)) {
        continue;
      }
      const TriangleId n = tin_.triangles[t].n[i];
      raise(t, n, a, b, horizon);
      if (n != kNone && --waits[n] == 0) {
        ready.push_back(n);
      }
    }
  }
  if (left != 0) {
    walk_to_others(waits, horizon);
  }
}

/// Raises the horizon to side a -> b of triangle `t`, beyond which lies `n`, moved by the bias.
/// What is not known grows with the distance in a straight line, so between two sides it changes no
/// slope by more than at these sides. Curvature does.
void Viewer::raise(TriangleId t, TriangleId n, Offset a, Offset b, Horizon& horizon) const {
  const bool surface = is_surface(t) || is_surface(n);
  if (bias_.sign == 0) {
    if (surface) {
      horizon.raise(a, b);
    }
    return;
  }
  const bool voids = bias_.voids && bias_.sign > 0;
  if (!surface && !voids) {
    return;
  }
  const double longest = std::max(longest_side(t), n == kNone ? 0.0 : longest_side(n));
  // A parabola c s^2 leaves a chord of length L by at most c L^2 / 4, a quarter of the drop: once
  // within the triangle, and as much again along the side.
  const double bent = request_.curvature.drop_at(longest) / 2;
  for (Offset* p : {&a, &b}) {
    p->z += bias_.sign * (unknown_at(p->x, p->y) + bent);
    if (voids && !(is_surface(t) && (n == kNone || is_surface(n)))) {
      // No drop is taken off: curvature only lowers, so without it the bound is higher and holds.
      p->z = std::max(p->z, facts_.max_height - result_.eye_height);
    }
  }
  horizon.raise(a, b);
}

double Viewer::longest_side(TriangleId t) const noexcept {
  const auto o = offsets(t);
  double square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = (o[(i + 1) % 3].x - o[i].x) * ground_x_;
    const double y = (o[(i + 1) % 3].y - o[i].y) * ground_y_;
    square = std::max(square, x * x + y * y);
  }
  return std::sqrt(square);
}

/// Looks at the triangles that hide one another in a circle, and at all behind them, by walks.
/// There are some only where the mesh is far from Delaunay.
void Viewer::walk_to_others(const std::vector<std::uint8_t>& waits, Horizon& horizon) {
  walked_.emplace(tin_, offsets_, eye_.spot);
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    if (tin_.is_alive(t) && waits[t] != 0) {
      context_.check_stop();
      look_at(t, horizon);
    }
  }
}

bool Viewer::sees(const Offset& at, Spot spot, Horizon::Side side, const Offset& along,
                  const Horizon& horizon) {
  if (bias_.sign != 0 && walked_) {
    return bias_.sign < 0;  // the answer that leaves the target undecided: the walk knows no bias
  }
  Offset p = at;
  p.z -= bias_.sign * unknown_at(p.x, p.y);
  if (!walked_) {
    // A target that is lower than twice what is not known may be hidden by the ground just before
    // it. An observer below ground that may lie beside it may see nothing.
    const bool stands_out =
        bias_.sign <= 0 ||
        (request_.target_height >= 2 * unknown_at(p.x, p.y) && eye_.above_ground >= bias_.base);
    return stands_out && horizon.sees(p, side, along);
  }
  ++result_.walked_targets;
  return walked_->sees(spot, p.z, eye_.triangle);
}

/// The ray to a corner comes through the triangle when the eye is on the inner side of both sides
/// at that corner. It comes along a side when the eye is in line with it.
Approach Viewer::approach_corner(const std::array<Offset, 3>& o, int corner) const noexcept {
  const Offset& at = o[static_cast<std::size_t>(corner)];
  const Offset& next = o[static_cast<std::size_t>(next_corner(corner))];
  const Offset& previous = o[static_cast<std::size_t>(previous_corner(corner))];
  const double leaving = turn(at, next);
  const double coming = turn(previous, at);
  if (leaving < 0 || coming < 0) {
    return {};
  }
  // Only edges on the triangle's side of the ray are sure to be raised by now (see()).
  if (leaving == 0) {
    return {true, turn(at, previous) > 0 ? Horizon::Side::kLeft : Horizon::Side::kRight};
  }
  if (coming == 0) {
    return {true, turn(at, next) > 0 ? Horizon::Side::kLeft : Horizon::Side::kRight};
  }
  return {true, Horizon::Side::kBoth};
}

void Viewer::look_at(TriangleId t, Horizon& horizon) {
  const auto o = offsets(t);
  for (int i = 0; i < 3; ++i) {
    const VertexId v = tin_.triangles[t].v[i];
    if (tin_.has_height[v] == 0) {
      continue;
    }
    Offset p = o[static_cast<std::size_t>(i)];
    if (!within(p.x, p.y)) {
      continue;
    }
    // The vertex below the eye has no direction; find_eye() refuses an eye below the surface.
    if (p.x == 0 && p.y == 0) {
      seen_[v] = Sight::kVisible;
      continue;
    }
    const Approach approach = approach_corner(o, i);
    if (approach.from_within) {
      p.z += request_.target_height;
      see(seen_[v], sees(p, spot_of(tin_.position(v)), approach.side, p, horizon));
    }
  }
  if (request_.pixels) {
    look_at_pixels(t, horizon);
  }
}

/// Looks at the pixel centres in the box of the triangle, except those on its corners, which are
/// vertices.
void Viewer::look_at_pixels(TriangleId t, const Horizon& horizon) {
  if (!is_surface(t)) {
    look_at_pixels_behind(t, horizon);
    return;
  }
  const auto& v = tin_.triangles[t].v;
  const GridPoint a = tin_.position(v[0]);
  const GridPoint b = tin_.position(v[1]);
  const GridPoint c = tin_.position(v[2]);
  if (pixels_on_grid_ && (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) -
                                 (std::int64_t{c.x} - a.x) * (std::int64_t{b.y} - a.y) ==
                             1) {
    return;  // the smallest triangle of a grid has no grid point but its corners
  }
  const auto o = offsets(t);
  look_at_box(t, horizon, {o[0], o[1], o[2]});
}

/// Looks at the targets on the rim of a void that are seen across the void. The ray to such a
/// target comes through a void triangle, so no surface triangle takes it.
void Viewer::look_at_pixels_behind(TriangleId t, const Horizon& horizon) {
  const auto o = offsets(t);
  for (int i = 0; i < 3; ++i) {
    const Offset& a = o[static_cast<std::size_t>(next_corner(i))];
    const Offset& b = o[static_cast<std::size_t>(previous_corner(i))];
    if (is_surface(tin_.triangles[t].n[i]) && !(turn(a, b) < 0)) {
      look_at_box(t, horizon, {a, b});
    }
    // A grid point at a corner is a vertex, which look_at() has looked at.
    if (!pixels_on_grid_ && approach_corner(o, i).from_within) {
      look_at_box(t, horizon, {o[static_cast<std::size_t>(i)]});
    }
  }
}

void Viewer::look_at_box(TriangleId t, const Horizon& horizon,
                         std::initializer_list<Offset> points) {
  double left = points.begin()->x, right = left;
  double low = points.begin()->y, high = low;
  for (const Offset& p : points) {
    left = std::min(left, p.x), right = std::max(right, p.x);
    low = std::min(low, p.y), high = std::max(high, p.y);
  }
  const auto clamp = [](double value, std::uint32_t size) {
    // Small pixels make offsets larger than any integer; -1 and the size stand for all outside.
    return static_cast<std::int64_t>(std::clamp(value, -1.0, static_cast<double>(size)));
  };
  // Places of at most 2e5 pixels round by less than 1e-10. A centre that is off a side by its rounding
  // must be in the box of one of the triangles there: place_in() says of which.
  constexpr double kOffSide = 1e-9;
  const auto from = [&](double place, std::uint32_t size) {
    return clamp(std::ceil(place - kOffSide), size);
  };
  const auto to = [&](double place, std::uint32_t size) {
    return clamp(std::floor(place + kOffSide), size);
  };
  const std::int64_t from_column = from((left - first_x_) / pixel_x_, result_.width);
  const std::int64_t to_column = to((right - first_x_) / pixel_x_, result_.width);
  const std::int64_t from_row = from((first_y_ - high) / pixel_y_, result_.height);
  const std::int64_t to_row = to((first_y_ - low) / pixel_y_, result_.height);
  for (std::int64_t row = std::max<std::int64_t>(from_row, 0);
       row <= std::min<std::int64_t>(to_row, result_.height - 1); ++row) {
    context_.check_stop();
    for (std::int64_t column = std::max<std::int64_t>(from_column, 0);
         column <= std::min<std::int64_t>(to_column, result_.width - 1); ++column) {
      look_at_pixel(t, horizon, column, row);
    }
  }
}

/// Whether a centre lies on the line through two vertices, but for its rounding.
bool Viewer::is_on_line(const Offset& a, const Offset& b, const Offset& p) const noexcept {
  const double across = b.x - a.x, up = b.y - a.y;
  const double most_x = std::abs(first_x_) + std::abs(p.x) + std::abs(a.x);
  const double most_y = std::abs(first_y_) + std::abs(p.y) + std::abs(a.y);
  return std::abs(across * (p.y - a.y) - up * (p.x - a.x)) <=
         kCrossRoundings * (std::abs(across) * most_y + std::abs(up) * most_x);
}

/// The place of a centre in a triangle; none: it is outside, or on a side that the ray reaches from beyond.
std::optional<PlaceInTriangle> Viewer::place_in(const std::array<Offset, 3>& o,
                                                const Offset& p) const noexcept {
  PlaceInTriangle place;
  place.along = p;
  for (int i = 0; i < 3; ++i) {
    const Offset& a = o[static_cast<std::size_t>(next_corner(i))];
    const Offset& b = o[static_cast<std::size_t>(previous_corner(i))];
    const double faces = turn(a, b);
    // Along a side in line with the eye a centre that is off by its own rounding is on it: else the
    // ground behind the centre, on the side's other hand, would hide it.
    const bool is_in_line = faces == 0 && is_on_line(a, b, p);
    const double w = is_in_line ? 0.0 : (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    if (w < 0 || (w == 0 && faces < 0)) {
      return std::nullopt;
    }
    if (is_in_line) {
      place.along = a.x * p.x + a.y * p.y > 0 ? a : b;  // the eye may lie between them
      place.side = turn(place.along, o[static_cast<std::size_t>(i)]) > 0 ? Horizon::Side::kLeft
                                                                         : Horizon::Side::kRight;
    }
    place.weights[i] = w;
  }
  return place;
}

void Viewer::look_at_pixel(TriangleId t, const Horizon& horizon, std::int64_t column,
                           std::int64_t row) {
  Sight& pixel =
      result_
          .pixels[static_cast<std::size_t>(row) * result_.width + static_cast<std::size_t>(column)];
  Offset p{first_x_ + static_cast<double>(column) * pixel_x_,
           first_y_ - static_cast<double>(row) * pixel_y_, 0};
  if (!within(p.x, p.y)) {
    return;
  }
  const auto o = offsets(t);
  const std::optional<PlaceInTriangle> place = place_in(o, p);
  if (!place) {
    return;
  }
  const auto& weights = place->weights;
  if (!is_surface(t) && !holds_surface(tin_, t, weights)) {
    return;
  }
  if (p.x == 0 && p.y == 0) {
    pixel = Sight::kVisible;
    return;
  }
  // The height on the plane of the triangle without curvature, then lowered by the drop at the
  // point itself. The corner with the least key comes first, whatever mesh the triangle is of: where the
  // eye is in the plane, the last digit of the sum decides.
  const auto first = static_cast<std::size_t>(least_corner(t));
  const std::array<std::size_t, 3> order{first, (first + 1) % 3, (first + 2) % 3};
  const double sum = weights[order[0]] + weights[order[1]] + weights[order[2]];
  for (const std::size_t i : order) {
    p.z += weights[i] / sum * (o[i].z + drop(o[i].x, o[i].y));
  }
  p.z += request_.target_height - drop(p.x, p.y);
  see(pixel, sees(p, walked_ ? spot_at(p) : eye_.spot, place->side, place->along, horizon));
}

/// The vertices that were looked at, in the order of their keys: a mesh has them in that in which it was
/// made.
std::vector<VertexId> Viewer::seen_vertices() const {
  std::vector<VertexId> seen;
  for (VertexId v = 0; v < seen_.size(); ++v) {
    if (v % kStopInterval == 0) {
      context_.check_stop();
    }
    if (seen_[v] != Sight::kNothing) {
      seen.push_back(v);
    }
  }
  const auto is_before = [&](VertexId a, VertexId b) {
    return key_of(tin_.position(a)) < key_of(tin_.position(b));
  };
  if (request_.list_vertices && !std::is_sorted(seen.begin(), seen.end(), is_before)) {
    std::sort(seen.begin(), seen.end(), is_before);
  }
  return seen;
}

/// The corner of a triangle with the least key.
int Viewer::least_corner(TriangleId t) const noexcept {
  int least = 0;
  for (const int i : {1, 2}) {
    const auto& v = tin_.triangles[t].v;
    if (key_of(tin_.position(v[i])) < key_of(tin_.position(v[least]))) least = i;
  }
  return least;
}

void Viewer::collect() {
  for (const VertexId v : seen_vertices()) {
    if (v % kStopInterval == 0) {
      context_.check_stop();
    }
    if (!touches_surface(tin_, v)) {
      continue;
    }
    const Offset& o = offsets_[v];
    const bool visible = seen_[v] == Sight::kVisible;
    ++(visible ? result_.visible_vertices : result_.hidden_vertices);
    if (request_.pixels && pixels_on_grid_) {
      // The pixel on a vertex takes the vertex's answer: the smallest triangles look at no pixel.
      const auto column = static_cast<std::int64_t>(std::llround(o.x - first_x_));
      const auto row = static_cast<std::int64_t>(std::llround(first_y_ - o.y));
      if (column >= 0 && row >= 0 && column < result_.width && row < result_.height) {
        result_.pixels[static_cast<std::size_t>(row) * result_.width +
                       static_cast<std::size_t>(column)] = seen_[v];
      }
    }
    if (request_.list_vertices) {
      const GridPoint p = tin_.position(v);
      result_.vertices.push_back(
          {facts_.map.to_map(p.x, p.y), facts_.heights.height(tin_.vertices[v].height), visible});
    }
  }
  for (const Sight s : result_.pixels) {
    result_.visible_pixels += s == Sight::kVisible ? 1 : 0;
    result_.hidden_pixels += s == Sight::kHidden ? 1 : 0;
  }
}

}  // namespace

Viewshed sweep_viewshed(const Tin& tin, const StoreFacts& facts, const ViewshedRequest& request,
                        const QueryContext& context, const SightBias& bias,
                        const HeldBySweeps& held) {
  return Viewer(tin, facts, request, context, bias, held).run();
}

}  // namespace ptin
