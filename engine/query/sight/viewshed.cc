// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/viewshed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "engine/error.h"
#include "engine/query/living/floor_cells.h"
#include "engine/query/living/floor_tin.h"
#include "engine/query/refine/refine.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/region.h"
#include "engine/query/shape/spot.h"
#include "engine/query/sight/viewshed_sweep.h"

namespace ptin {

namespace {

void check(const ViewshedRequest& r) {
  if (!std::isfinite(r.eye.x) || !std::isfinite(r.eye.y) || !std::isfinite(r.eye_height)) {
    refuse("the observer's position or height is not a finite number");
  }
  if (!(r.radius > 0) || !std::isfinite(r.radius)) {
    refuse("the radius must be a number > 0");
  }
  if (!(r.target_height >= 0) || !std::isfinite(r.target_height)) {
    refuse("the target's height must be a number >= 0");
  }
  for (const double side : r.pixel_size.value_or(std::array{1.0, 1.0})) {
    if (!(side > 0) || !std::isfinite(side)) {
      refuse("the pixel size must be a number > 0");
    }
  }
  check(r.curvature);
  if (!(r.ground_per_map_x > 0) || !(r.ground_per_map_y > 0)) {
    refuse("the ground units of a map unit are not numbers > 0");
  }
}

/// Distances over ground from the eye.
struct GroundDistance {
  MapPoint eye;               ///< Grid units.
  double ground_x, ground_y;  ///< Ground units of a grid unit.

  /// To the nearest point of a box; 0: it holds the eye.
  [[nodiscard]] double to(const GridBox& box) const noexcept {
    const double x = ground_x * std::max({box.min_x - eye.x, eye.x - box.max_x, 0.0});
    const double y = ground_y * std::max({box.min_y - eye.y, eye.y - box.max_y, 0.0});
    return std::sqrt(x * x + y * y);
  }
};

/// Rounding of a distance that is compared with the radius, here and where targets are.
constexpr double kReach = 1 + 1e-12;

/// True for records that may deviate by more than `slope` times their distance from the eye, and
/// for all whose roi holds the eye. Monotone: a larger box is no farther.
class DeviationTowards final : public AttributePredicate {
 public:
  DeviationTowards(const GroundDistance& from_eye, double slope)
      : from_eye_(from_eye), slope_(slope) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    const double distance = from_eye_.to(a.roi);
    return distance == 0 || a.deviation > slope_ * distance;
  }

 private:
  GroundDistance from_eye_;
  double slope_;
};

/// Puts what two biased sweeps are certain of into the result of the plain sweep.
class Certainty {
 public:
  explicit Certainty(Viewshed& seen) : seen_(seen) {
    for (Sight& s : seen_.pixels) {
      s = s == Sight::kVisible  ? Sight::kPerhapsVisible
          : s == Sight::kHidden ? Sight::kPerhapsHidden
                                : s;
    }
    for (Viewshed::Target& t : seen_.vertices) {
      t.certain = false;
    }
  }

  /// Takes over the targets for which a sweep biased against the answer `certain` gives that answer
  /// nevertheless.
  void add(const Viewshed& biased, Sight certain) {
    for (std::size_t i = 0; i < seen_.pixels.size(); ++i) {
      if (biased.pixels[i] == certain) {
        seen_.pixels[i] = certain;
      }
    }
    for (std::size_t i = 0; i < seen_.vertices.size(); ++i) {
      if (biased.vertices[i].visible == is_visible(certain)) {
        seen_.vertices[i].visible = biased.vertices[i].visible;
        seen_.vertices[i].certain = true;
      }
    }
  }

  void count() {
    seen_.visible_pixels = seen_.hidden_pixels = seen_.undecided_pixels = 0;
    seen_.visible_vertices = seen_.hidden_vertices = seen_.undecided_vertices = 0;
    for (const Sight s : seen_.pixels) {
      seen_.visible_pixels += s == Sight::kVisible ? 1 : 0;
      seen_.hidden_pixels += s == Sight::kHidden ? 1 : 0;
      seen_.undecided_pixels += s == Sight::kPerhapsVisible || s == Sight::kPerhapsHidden ? 1 : 0;
    }
    for (const Viewshed::Target& t : seen_.vertices) {
      ++(!t.certain  ? seen_.undecided_vertices
         : t.visible ? seen_.visible_vertices
                     : seen_.hidden_vertices);
    }
  }

 private:
  Viewshed& seen_;
};

/// Bytes of the arrays of a mesh, with what they have grown beyond it.
std::uint64_t held_bytes(const Tin& tin) noexcept {
  return tin.vertices.capacity() * sizeof(Vertex) + tin.has_height.capacity() +
         tin.triangles.capacity() * sizeof(Triangle) +
         tin.classes.capacity() * sizeof(TriangleClass);
}

/// Refines the mesh of a request, sweeps it, and finds which answers are certain.
class ViewshedSearch {
 public:
  ViewshedSearch(const OpenedTerrain& terrain, const ViewshedRequest& request)
      : terrain_(terrain),
        store_(terrain.store()),
        request_(request),
        context_(request.limits, store_.path()),
        detail_(request.detail, terrain.record_source(), context_),
        leaves_out_(leaves_records_out(store_.facts())),
        left_out_(leaves_out_ ? store_.facts().base_deviation : 0.0) {}

  Viewshed run() {
    const bool is_coarse = detail_.is_asked() && !detail_.certificate().complete;
    refine_mesh(is_coarse);
    const bool leaves_open = is_coarse || leaves_out_;
    results_held_ = leaves_open && std::isfinite(left_out_) ? 2 : 1;
    Viewshed result = sweep({});
    if (leaves_open) {
      Certainty certainty(result);
      tell_apart(certainty);
      certainty.count();
    }
    store_.pages().check_unchanged();
    result.certified_error = detail_.certificate().error;
    result.certified_deviation = is_coarse ? std::max(allowed(), store_.facts().base_deviation)
                                           : detail_.certificate().deviation;
    result.exact = detail_.is_exact(store_.facts());
    result.cost = context_.cost;
    return result;
  }

 private:
  void tell_apart(Certainty& certainty) {
    if (!std::isfinite(left_out_)) {
      return;
    }
    // The ground on which the eye stands is not known either.
    const double base = request_.absolute ? left_out_ : 2 * left_out_;
    const bool voids = !store_.facts().free_of_voids;
    certainty.add(sweep({1, slope_, voids, base}), Sight::kVisible);
    if (!voids) {
      certainty.add(sweep({-1, slope_, false, base}), Sight::kHidden);
    }
  }

  void refine_mesh(bool is_coarse) {
    const double reach_x = request_.radius / request_.ground_per_map_x;
    const double reach_y = request_.radius / request_.ground_per_map_y;
    const MapPoint eye = request_.eye;
    const Window around{eye.x - reach_x, eye.y - reach_y, eye.x + reach_x, eye.y + reach_y};
    if (const Floor* const floor = floor_for(terrain_, detail_)) {
      const StoreFacts& facts = store_.facts();
      const GroundDistance away = distance_from_eye();
      tin_ = floor_tin(
          *floor, facts.heights, GridRegion(around, facts.map).bounds(),
          [&](const GridBox& box) { return away.to(box) <= request_.radius * kReach; }, context_);
      return;
    }
    RefineRequest wanted;
    wanted.region = around;
    wanted.limits = request_.limits;
    const PredicatePtr finer = is_coarse ? finer_towards_eye() : nullptr;
    wanted.also = finer.get();
    RefinedTin refined = refine(terrain_, wanted);
    context_.cost.add_counts(refined.cost);
    tin_ = std::move(refined.tin);
  }

  [[nodiscard]] GroundDistance distance_from_eye() const {
    const AffineMap& map = store_.facts().map;
    const auto spot = SpotMap(map, store_.facts().bounds).spot(request_.eye);
    // find_eye() refuses an eye outside
    return {spot ? grid_of(*spot) : map.to_grid(request_.eye),
            map.step_x * request_.ground_per_map_x, map.step_y * request_.ground_per_map_y};
  }

  [[nodiscard]] PredicatePtr finer_towards_eye() {
    slope_ = allowed() / request_.radius;
    return any_of({std::make_shared<AboveError>(detail_.tolerance()),
                   std::make_shared<DeviationTowards>(distance_from_eye(), slope_)});
  }

  /// The deviation allowed at the radius: the tolerance asked for, or the certified error of the
  /// vertices asked for.
  [[nodiscard]] double allowed() const noexcept {
    return request_.detail.tolerance.value_or(detail_.certificate().error);
  }

  Viewshed sweep(const SightBias& bias) {
    return sweep_viewshed(tin_, store_.facts(), request_, context_, bias,
                          {held_bytes(tin_), results_held_});
  }

  const OpenedTerrain& terrain_;
  const StoreFile& store_;
  const ViewshedRequest& request_;
  QueryContext context_;
  Detail detail_;
  Tin tin_;
  bool leaves_out_;  ///< Records, from the file.
  double left_out_;  ///< Deviation of the file's full TIN from the source's.
  double slope_ = 0;
  /// Results at once: that of the plain sweep, and of a biased one.
  std::uint64_t results_held_ = 1;
};

}  // namespace

Viewshed viewshed(const OpenedTerrain& terrain, const ViewshedRequest& request) {
  check(request);
  return timed([&] { return ViewshedSearch(terrain, request).run(); });
}

}  // namespace ptin
