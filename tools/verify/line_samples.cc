// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/line_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <nlohmann/json.hpp>

#include "engine/construct/grid/decimal.h"
#include "engine/construct/read/line_file.h"
#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "engine/geometry/box.h"
#include "engine/geometry/orient.h"
#include "engine/stop.h"
#include "tools/facts/human.h"
#include "tools/verify/decimal_steps.h"

namespace ptin::tools {

namespace {

__extension__ using Wide = __int128;

/// Height of a vertex of a boundary without heights: any other is lower, and stands.
constexpr double kNoHeight = std::numeric_limits<double>::infinity();

/// A height as the file stores it.
double stored(Decimal height, const HeightEncoding& heights) {
  if (heights.type == HeightType::float32) {
    return static_cast<double>(static_cast<float>(to_double(height)));
  }
  return heights.height_of_code(steps_of(height, heights.offset, heights.step));
}
double stored(double height, const HeightEncoding& heights) {
  if (heights.type == HeightType::float32) return static_cast<double>(static_cast<float>(height));
  return heights.height_of_code(std::nearbyint((height - heights.offset) / heights.step));
}

/// Refuses files other than those that the store was built with, as far as their number shows.
void check_files(const LineInputs& inputs, const nlohmann::json& options) {
  const nlohmann::json built = options.value("breaklines", nlohmann::json::array());
  const auto count = static_cast<std::size_t>(built.is_array() ? built.size() : 0);
  if (count != inputs.breaklines.size()) {
    refuse("this file was built with " + counted(count, "file") + " of breaklines, and here " +
           counted(inputs.breaklines.size(), "file") +
           " of them stands behind --breaklines; name all of them");
  }
  if (options.contains("boundary") != !inputs.boundary.empty()) {
    refuse(inputs.boundary.empty()
               ? "this file was built with a boundary; name its file behind --boundary"
               : "this file was built without a boundary; leave --boundary out");
  }
}

}  // namespace

nlohmann::json options_of_build(const StoreFile& store) {
  const nlohmann::json metadata = metadata_of(store);
  const auto options = metadata.find("options");
  return options != metadata.end() && options->is_object() ? *options : nlohmann::json::object();
}

LineSamples::LineSamples(const LineInputs& inputs, const StoreFile& store,
                         std::optional<double> resolution, const std::stop_token& stop)
    : facts_(&store.facts()), resolution_(resolution) {
  const nlohmann::json options = options_of_build(store);
  check_files(inputs, options);
  for (const std::string& path : inputs.breaklines) {
    read(path, options.value("breakline_layer", std::string()), false, stop);
  }
  if (!inputs.boundary.empty()) {
    read(inputs.boundary, options.value("boundary_layer", std::string()), true, stop);
  }
  for (int round = 0; round < 50 && join_once(); ++round) stop_if_asked(stop, "verification");
  drop_outside();
}

void LineSamples::add_vertex(VertexKey key, double height, bool keeps_lower) {
  const auto [found, is_new] = vertices_.try_emplace(key, height);
  if (!is_new && keeps_lower) found->second = std::min(found->second, height);
}

void LineSamples::read(const std::string& path, const std::string& layer, bool is_boundary,
                       const std::stop_token& stop) {
  const auto place_of = [&](const SourcePoint& p, bool is_laid) {
    const auto [x, y] = grid_position(p, facts_->map, resolution_);
    // Parts of a line without heights that have no surface below are no part of the terrain.
    const double least = is_laid ? -kGridMax : 0.0;
    if (!(x >= least && y >= least && x <= kGridMax && y <= kGridMax)) {
      refuse("these lines reach beyond what the terrain may hold: they are not those of its build",
             path);
    }
    return GridPoint{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
  };
  std::vector<std::pair<VertexKey, double>> vertices;
  const auto take = [&](const std::vector<SourcePoint>& line, bool has_heights) {
    const bool is_laid = !is_boundary && !has_heights;  // divides others, and is none itself
    for (std::size_t i = 0; i < line.size(); ++i) {
      const GridPoint p = place_of(line[i], is_laid);
      vertices.emplace_back(key_of(p), is_laid ? kNoHeight : stored(line[i].z, facts_->heights));
      if (i > 0)
        pieces_.push_back(
            {place_of(line[i - 1], is_laid), p, !is_boundary && !is_laid, is_boundary});
    }
  };
  const LayerWish wish{is_boundary ? LayerKind::kAreas : LayerKind::kLines, layer,
                       "a build with that layer alone"};
  const bool is_flat = read_line_file(path, wish, take, stop).is_flat;
  is_flat_ = is_flat_ || is_flat;
  is_boundary_flat_ = is_boundary && is_flat;
  for (const auto& [key, height] : vertices)
    add_vertex(key, is_boundary_flat_ ? kNoHeight : height, true);
}

/// Sorts pieces, and makes one of those that fall together; of a boundary's two cancel.
void LineSamples::sort_pieces() {
  for (LinePiece& p : pieces_) {
    if (std::tie(p.b.x, p.b.y) < std::tie(p.a.x, p.a.y)) std::swap(p.a, p.b);
  }
  std::sort(pieces_.begin(), pieces_.end(), [](const LinePiece& p, const LinePiece& q) {
    return std::tie(p.a.x, p.a.y, p.b.x, p.b.y) < std::tie(q.a.x, q.a.y, q.b.x, q.b.y);
  });
  std::vector<LinePiece> kept;
  widest_ = 0;
  for (const LinePiece& p : pieces_) {
    if (p.a == p.b) continue;
    widest_ = std::max(widest_, std::int64_t{p.b.x} - p.a.x);
    if (!kept.empty() && kept.back().a == p.a && kept.back().b == p.b) {
      kept.back().breakline |= p.breakline;
      kept.back().boundary ^= p.boundary;
    } else {
      kept.push_back(p);
    }
  }
  pieces_ = std::move(kept);
}

/// Notes that a point divides a piece where it lies inside of it. True then.
bool LineSamples::touch(std::size_t number, GridPoint p) {
  const LinePiece& s = pieces_[number];
  const bool is_inside = !(p == s.a) && !(p == s.b) && orient(s.a, s.b, p) == 0 &&
                         contains(united(box_of(s.a), s.b), p);
  if (is_inside) divisions_.emplace_back(number, p);
  return is_inside;
}

/// Notes that two pieces divide each other where they cross, in the lower of their heights.
void LineSamples::cross(std::size_t one, std::size_t other) {
  const LinePiece &s = pieces_[one], &u = pieces_[other];
  const std::int64_t a = orient(u.a, u.b, s.a), b = orient(u.a, u.b, s.b);
  if ((a > 0) == (b > 0) || (orient(s.a, s.b, u.a) > 0) == (orient(s.a, s.b, u.b) > 0)) return;
  const auto nearest = [&](std::int64_t from, std::int64_t to) {  // halves go up
    const Wide sign = a < b ? -1 : 1;
    const Wide below = sign * 2 * (Wide{a} - b);
    const Wide above = sign * (2 * Wide{a} * (to - from) + (Wide{a} - b));
    Wide whole = above / below;
    if (whole * below > above) --whole;
    return static_cast<std::int32_t>(from + static_cast<std::int64_t>(whole));
  };
  const GridPoint x{nearest(s.a.x, s.b.x), nearest(s.a.y, s.b.y)};
  const auto height_at = [&](const LinePiece& piece, double t) {
    const double from = vertices_.at(key_of(piece.a)), to = vertices_.at(key_of(piece.b));
    return std::isinf(from) || std::isinf(to) ? kNoHeight : from + t * (to - from);
  };
  const double on_s = static_cast<double>(a) / (static_cast<double>(a) - static_cast<double>(b));
  const auto c = static_cast<double>(orient(s.a, s.b, u.a));
  const auto d = static_cast<double>(orient(s.a, s.b, u.b));
  add_vertex(key_of(x), std::min(height_at(s, on_s), height_at(u, c / (c - d))), false);
  divisions_.emplace_back(one, x);
  divisions_.emplace_back(other, x);
}

/// Divides pieces where they meet. False when none did.
bool LineSamples::join_once() {
  sort_pieces();
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    for (std::size_t k = i + 1; k < pieces_.size() && pieces_[k].a.x <= pieces_[i].b.x; ++k) {
      const LinePiece &s = pieces_[i], &u = pieces_[k];
      if (!meets(united(box_of(s.a), s.b), united(box_of(u.a), u.b))) continue;
      bool touches = s.a == u.a || s.a == u.b || s.b == u.a || s.b == u.b;
      for (const GridPoint p : {u.a, u.b}) touches = touch(i, p) || touches;
      for (const GridPoint p : {s.a, s.b}) touches = touch(k, p) || touches;
      if (!touches) cross(i, k);
    }
  }
  const bool any = !divisions_.empty();
  finish();
  return any;
}

void LineSamples::divide_at(GridPoint p) {
  visit_at(p, [&](std::size_t i) {
    if (!(p == pieces_[i].a) && !(p == pieces_[i].b) && orient(pieces_[i].a, pieces_[i].b, p) == 0)
      divisions_.emplace_back(i, p);
  });
}

void LineSamples::finish() {
  if (divisions_.empty()) return;
  const auto along = [&](const std::pair<std::size_t, GridPoint>& d) {
    const GridPoint a = pieces_[d.first].a;
    return std::hypot(static_cast<double>(d.second.x) - a.x, static_cast<double>(d.second.y) - a.y);
  };
  std::sort(divisions_.begin(), divisions_.end(), [&](const auto& one, const auto& other) {
    return std::tuple(one.first, along(one)) < std::tuple(other.first, along(other));
  });
  for (std::size_t i = divisions_.size(); i-- > 0;) {  // from the far end inwards
    const auto& [number, p] = divisions_[i];
    LinePiece rest = pieces_[number];
    rest.a = p;
    pieces_[number].b = p;
    pieces_.push_back(rest);
  }
  divisions_.clear();
  sort_pieces();
}

/// Visits the pieces whose boxes hold a point.
template <class Visit>
void LineSamples::visit_at(GridPoint p, const Visit& visit) const {
  const auto first =
      std::lower_bound(pieces_.begin(), pieces_.end(), p.x - widest_,
                       [](const LinePiece& s, std::int64_t x) { return std::int64_t{s.a.x} < x; });
  for (auto s = first; s != pieces_.end() && s->a.x <= p.x; ++s) {
    if (contains(united(box_of(s->a), s->b), p)) {
      visit(static_cast<std::size_t>(s - pieces_.begin()));
    }
  }
}

std::size_t LineSamples::band_of(std::int64_t y) const {
  constexpr std::int64_t kBands = 1024;
  const std::int64_t height = std::int64_t{facts_->bounds.max_y} - facts_->bounds.min_y + 1;
  return static_cast<std::size_t>(
      std::clamp<std::int64_t>((y - facts_->bounds.min_y) * kBands / height, 0, kBands - 1));
}

void LineSamples::index_boundary() {
  bands_.assign(1024, {});
  for (const LinePiece& s : pieces_) {
    const auto [low, high] = std::minmax(s.a.y, s.b.y);
    for (std::size_t i = band_of(low); s.boundary && i <= band_of(high); ++i)
      bands_[i].push_back(s);
  }
}

bool LineSamples::is_beside_boundary(GridPoint p) const {
  for (std::size_t band = band_of(std::int64_t{p.y} - 1); band <= band_of(std::int64_t{p.y} + 1);
       ++band) {
    for (const LinePiece& s : bands_[band]) {
      GridBox box = united(box_of(s.a), s.b);
      box = {box.min_x - 1, box.min_y - 1, box.max_x + 1, box.max_y + 1};
      const double length =
          std::hypot(static_cast<double>(s.b.x) - s.a.x, static_cast<double>(s.b.y) - s.a.y);
      if (contains(box, p) && std::abs(static_cast<double>(orient(s.a, s.b, p))) <= 1.5 * length) {
        return true;
      }
    }
  }
  return false;
}

/// By the pieces that lie left of the point in its row, counted half open; or on the boundary.
bool LineSamples::holds(GridPoint p) const {
  if (!has_boundary_) return true;
  if (is_boundary_flat_ && is_beside_boundary(p)) return false;
  bool is_inside = false;
  for (const LinePiece& s : bands_[band_of(p.y)]) {
    const std::int64_t side = orient(s.a, s.b, p);
    if (side == 0 && contains(united(box_of(s.a), s.b), p)) return true;
    if ((s.a.y <= p.y) != (s.b.y <= p.y) && (s.b.y > s.a.y ? side < 0 : side > 0)) {
      is_inside = !is_inside;
    }
  }
  return is_inside;
}

/// Lets go of breaklines outside of the boundary, and of vertices that no piece needs.
void LineSamples::drop_outside() {
  sort_pieces();
  has_boundary_ =
      std::any_of(pieces_.begin(), pieces_.end(), [](const LinePiece& s) { return s.boundary; });
  // In half steps, so that the middle of a piece is a point of the grid: coordinates stay below 2^31.
  std::vector<LinePiece> kept;
  for (const LinePiece& s : pieces_) {
    bool is_inside = !has_boundary_;
    const std::int64_t x = std::int64_t{s.a.x} + s.b.x, y = std::int64_t{s.a.y} + s.b.y;
    for (const LinePiece& u : pieces_) {
      if (!has_boundary_ || 2 * std::int64_t{u.a.x} > x) break;
      const bool rises = u.b.y > u.a.y;
      if (!u.boundary || (2 * std::int64_t{u.a.y} <= y) == (2 * std::int64_t{u.b.y} <= y)) continue;
      const Wide side = (Wide{u.b.x} - u.a.x) * (y - 2 * std::int64_t{u.a.y}) -
                        (Wide{u.b.y} - u.a.y) * (x - 2 * std::int64_t{u.a.x});
      if (rises ? side < 0 : side > 0) is_inside = !is_inside;
    }
    if (s.boundary || (s.breakline && is_inside)) kept.push_back(s);
  }
  pieces_ = std::move(kept);
  std::map<VertexKey, double> used;
  for (const LinePiece& s : pieces_) {
    for (const GridPoint p : {s.a, s.b}) {
      const double height = vertices_.at(key_of(p));
      if (height != kNoHeight) used.emplace(key_of(p), stored(height, facts_->heights));
    }
  }
  vertices_ = std::move(used);
  if (has_boundary_) index_boundary();
  if (is_boundary_flat_) std::erase_if(pieces_, [](const LinePiece& s) { return !s.breakline; });
}

}  // namespace ptin::tools
