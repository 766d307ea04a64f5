// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/contour_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <protozero/pbf_builder.hpp>
#include <protozero/pbf_writer.hpp>

#include "engine/error.h"
#include "engine/stop.h"

namespace ptin::tools {

namespace {

constexpr std::int64_t kTileExtent = 4096;  ///< Steps along a tile.
constexpr std::int64_t kBuffer = 64;        ///< Steps beside it that lines go on.
constexpr int kStepsLog2 = 12;
constexpr int kZoomsOfFullTin =
    4;  ///< Of the last zooms so many have it, each at its own interval.
/// Bytes of a point in its line, in those of the layer and of the tile, and a part of its level's commands.
constexpr std::uint64_t kBytesOfPoint = 8 + 2 * 4 + 4;
constexpr double kLeastLevels = 4.0, kLeastInterval = 0.01;
constexpr std::int64_t kLinesToIndex = 5;
constexpr double kMostLevelsOfTerrain = 1000.0;
constexpr double kMostBend = 0.25;  ///< Steps that a segment may leave the map's straight line by.
constexpr int kMostDivisions = 16;
/// The radius of the curve that a straight line of the map is on the world is larger, metres.
constexpr double kLeastRadius = 1e6;

/// A position on the lattice of a zoom, from the corner of the tile.
struct LatticePoint {
  std::int32_t x = 0, y = 0;
  friend bool operator==(const LatticePoint&, const LatticePoint&) = default;
};
using LatticeLine = std::vector<LatticePoint>;

/// The parts of lines that a tile shows, in steps of the zoom's lattice from the world's corner.
class TileLines {
 public:
  /// @param bytes  For what is kept of points, here and in the tile.
  TileLines(const MercatorPyramid& pyramid, const GlobePath& path, const WebTile& tile,
            std::uint64_t bytes)
      : pyramid_(pyramid),
        path_(path),
        most_points_(bytes / kBytesOfPoint),
        steps_(std::ldexp(1.0, tile.z + kStepsLog2)),
        metres_(kMercatorGirth / steps_) {
    const std::int64_t column = pyramid.unrolled_column(tile);
    corner_x_ = column * kTileExtent;
    corner_y_ = tile.y * kTileExtent;
    low_ = {static_cast<double>(corner_x_ - kBuffer), static_cast<double>(corner_y_ - kBuffer)};
    high_ = {static_cast<double>((column + 1) * kTileExtent + kBuffer),
             static_cast<double>((tile.y + 1) * kTileExtent + kBuffer)};
  }

  /// A window of the map that holds what the tile shows.
  [[nodiscard]] std::optional<Window> window() const;

  /// Adds the parts of a line, map units.
  void add(std::span<const MapPoint> line, std::vector<LatticeLine>& parts) {
    part_.clear();
    MapPoint before = world(line[0]);
    for (std::size_t i = 1; i < line.size(); ++i) {
      const MapPoint here = world(line[i]);
      add_segment({line[i - 1], before}, {line[i], here}, 0, parts);
      before = here;
    }
    end_part(parts);
  }

 private:
  /// On the map, and in steps.
  struct SegmentEnds {
    MapPoint map, at;
  };

  [[nodiscard]] MapPoint world(const MapPoint& map) const {
    const MapPoint grid = pyramid_.terrain().store().facts().map.to_grid(map);
    const GlobePoint p = path_.to_globe(grid.x, grid.y, 0.0);
    const double lat = std::clamp(p.lat, -kMostMercatorLatitude, kMostMercatorLatitude);
    const MapPoint share = world_of(p.lon, lat);
    return {share.x * steps_, share.y * steps_};
  }
  [[nodiscard]] bool misses(const MapPoint& a, const MapPoint& b) const noexcept {
    return std::max(a.x, b.x) < low_.x || std::min(a.x, b.x) > high_.x ||
           std::max(a.y, b.y) < low_.y || std::min(a.y, b.y) > high_.y;
  }

  /// Divides a segment where its middle on the map is beside its middle in steps. That depends on its ends
  /// in lexicographic order alone, so that it is the same in every tile and both ways.
  void add_segment(const SegmentEnds& a, const SegmentEnds& b, int depth,
                   std::vector<LatticeLine>& parts) {
    const double square =
        (b.at.x - a.at.x) * (b.at.x - a.at.x) + (b.at.y - a.at.y) * (b.at.y - a.at.y);
    // A chord of length d leaves a circle of radius r by d^2 / 8 r.
    if (depth < kMostDivisions && square * metres_ > 8 * kMostBend / 2 * kLeastRadius) {
      SegmentEnds middle;
      middle.map = {0.5 * (a.map.x + b.map.x), 0.5 * (a.map.y + b.map.y)};
      middle.at = world(middle.map);
      if (std::hypot(middle.at.x - 0.5 * (a.at.x + b.at.x), middle.at.y - 0.5 * (a.at.y + b.at.y)) >
          kMostBend) {
        add_segment(a, middle, depth + 1, parts);
        add_segment(middle, b, depth + 1, parts);
        return;
      }
    }
    add_straight(a.at, b.at, parts);
  }

  /// Puts points where a straight segment crosses the sides of tiles, and keeps what the tile shows.
  void add_straight(const MapPoint& a, const MapPoint& b, std::vector<LatticeLine>& parts) {
    if (misses(a, b)) {
      end_part(parts);
      return;
    }
    const bool is_turned = std::pair(b.x, b.y) < std::pair(a.x, a.y);
    const MapPoint& from = is_turned ? b : a;
    const MapPoint& to = is_turned ? a : b;
    stops_.clear();
    stops_.emplace_back(0.0, from);
    cross(from.x, to.x, low_.x, high_.x, [&](double x, double t) {
      stops_.emplace_back(t, MapPoint{x, from.y + t * (to.y - from.y)});
    });
    cross(from.y, to.y, low_.y, high_.y, [&](double y, double t) {
      stops_.emplace_back(t, MapPoint{from.x + t * (to.x - from.x), y});
    });
    std::sort(stops_.begin() + 1, stops_.end(), [](const auto& p, const auto& q) {
      return std::tuple(p.first, p.second.x, p.second.y) <
             std::tuple(q.first, q.second.x, q.second.y);
    });
    stops_.emplace_back(1.0, to);
    if (is_turned) std::reverse(stops_.begin(), stops_.end());
    for (std::size_t i = 1; i < stops_.size(); ++i) {
      add_piece(stops_[i - 1].second, stops_[i].second, parts);
    }
  }

  /// Calls found(value, share) where a coordinate passes a side of tiles, or an end of what is shown.
  template <class Found>
  static void cross(double from, double to, double low, double high, const Found& found) {
    const double least = std::min(from, to), most = std::max(from, to);
    const auto pass = [&](double value) {
      if (least < value && value < most) found(value, (value - from) / (to - from));
    };
    pass(low);
    pass(low + kBuffer);
    pass(high - kBuffer);
    pass(high);
  }

  /// A piece between stops lies within what is shown, or outside of it.
  void add_piece(const MapPoint& a, const MapPoint& b, std::vector<LatticeLine>& parts) {
    const MapPoint middle{0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
    if (middle.x < low_.x || middle.x > high_.x || middle.y < low_.y || middle.y > high_.y) {
      end_part(parts);
      return;
    }
    add_point(a);
    add_point(b);
  }

  void add_point(const MapPoint& p) {
    // What is shown is less than two tiles wide.
    const LatticePoint rounded{static_cast<std::int32_t>(std::llround(p.x) - corner_x_),
                               static_cast<std::int32_t>(std::llround(p.y) - corner_y_)};
    if (!part_.empty() && part_.back() == rounded) return;
    if (++points_ > most_points_) {
      throw Error(ErrorCode::resource_exhausted,
                  "the tile has more than " + std::to_string(most_points_) + " points");
    }
    part_.push_back(rounded);
  }

  void end_part(std::vector<LatticeLine>& parts) {
    if (part_.size() > 1) parts.push_back(part_);
    part_.clear();
  }

  const MercatorPyramid& pyramid_;
  const GlobePath& path_;
  std::uint64_t most_points_, points_ = 0;
  double steps_;                      ///< Along the world.
  double metres_;                     ///< Of a step, along the equator.
  std::int64_t corner_x_, corner_y_;  ///< Of the tile, steps.
  MapPoint low_, high_;               ///< What is shown, steps.
  LatticeLine part_;
  std::vector<std::pair<double, MapPoint>> stops_;
};

std::optional<Window> TileLines::window() const {
  const GlobeBox box{longitude_of(low_.x / steps_), latitude_of(high_.y / steps_),
                     longitude_of(high_.x / steps_), latitude_of(low_.y / steps_)};
  const GridBox grid = pyramid_.globe().grid_box(box);
  if (is_empty(grid)) return std::nullopt;
  const AffineMap& map = pyramid_.terrain().store().facts().map;
  const MapPoint a = map.to_map(grid.min_x, grid.min_y), b = map.to_map(grid.max_x, grid.max_y);
  return Window{std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
}

/// The heights n * interval of the terrain, by n.
std::vector<std::int64_t> level_numbers(const Globe& globe, double interval) {
  const double low = std::ceil(globe.min_height() / interval);
  const double high = std::floor(globe.max_height() / interval);
  if (!(interval > 0) || !(high - low < kMostLevelsOfTerrain)) {
    refuse("the interval is to be above 0 m, and the terrain's heights, " +
           std::to_string(globe.min_height()) + " m to " + std::to_string(globe.max_height()) +
           " m, to have at most 1000 levels: ask for a larger one");
  }
  std::vector<std::int64_t> numbers;
  for (auto n = static_cast<std::int64_t>(low); n <= static_cast<std::int64_t>(high); ++n) {
    numbers.push_back(n);
  }
  return numbers;
}

/// A level with its lines.
struct TileContour {
  double ele = 0.0;
  bool is_index = false;
  std::vector<LatticeLine> lines;
};

// Numbers of fields of Mapbox Vector Tile 2.1, section 4.
enum class TileField : protozero::pbf_tag_type { kLayers = 3 };
enum class LayerField : protozero::pbf_tag_type {
  kName = 1,
  kFeatures = 2,
  kKeys = 3,
  kValues = 4,
  kExtent = 5,
  kVersion = 15
};
enum class FeatureField : protozero::pbf_tag_type { kTags = 2, kType = 3, kGeometry = 4 };
enum class ValueField : protozero::pbf_tag_type { kDouble = 3, kSint = 6, kBool = 7 };

constexpr std::uint32_t kLineString = 2, kMoveTo = 1, kLineTo = 2;
std::uint32_t command_of(std::uint32_t id, std::size_t count) {
  return id | static_cast<std::uint32_t>(count) << 3U;
}

/// Lines as commands with differences of positions from the tile's corner.
std::vector<std::uint32_t> geometry_of(const std::vector<LatticeLine>& lines) {
  std::vector<std::uint32_t> commands;
  LatticePoint cursor;
  const auto go_to = [&](const LatticePoint& p) {
    commands.push_back(protozero::encode_zigzag32(p.x - cursor.x));
    commands.push_back(protozero::encode_zigzag32(p.y - cursor.y));
    cursor = p;
  };
  for (const LatticeLine& line : lines) {
    commands.push_back(command_of(kMoveTo, 1));
    go_to(line[0]);
    commands.push_back(command_of(kLineTo, line.size() - 1));
    for (std::size_t i = 1; i < line.size(); ++i) go_to(line[i]);
  }
  return commands;
}

std::string value_of_height(double ele) {
  std::string bytes;
  protozero::pbf_builder<ValueField> value(bytes);
  if (ele == std::rint(ele)) {
    value.add_sint64(ValueField::kSint, static_cast<std::int64_t>(ele));
  } else {
    value.add_double(ValueField::kDouble, ele);
  }
  return bytes;
}

std::string value_of_flag(bool flag) {
  std::string bytes;
  protozero::pbf_builder<ValueField>(bytes).add_bool(ValueField::kBool, flag);
  return bytes;
}

/// The values of a layer: false, true, and then a height each.
std::string vector_tile(const std::vector<TileContour>& contours) {
  if (contours.empty()) return {};
  std::string layer_bytes;
  {
    protozero::pbf_builder<LayerField> layer(layer_bytes);
    layer.add_uint32(LayerField::kVersion, 2);
    layer.add_string(LayerField::kName, "contours");
    std::uint32_t value = 2;
    for (const TileContour& contour : contours) {
      protozero::pbf_builder<FeatureField> feature(layer, LayerField::kFeatures);
      const std::array<std::uint32_t, 4> tags{0, value++, 1, contour.is_index ? 1U : 0U};
      feature.add_packed_uint32(FeatureField::kTags, tags.begin(), tags.end());
      feature.add_enum(FeatureField::kType, kLineString);
      const std::vector<std::uint32_t> geometry = geometry_of(contour.lines);
      feature.add_packed_uint32(FeatureField::kGeometry, geometry.begin(), geometry.end());
    }
    layer.add_string(LayerField::kKeys, "ele");
    layer.add_string(LayerField::kKeys, "index");
    layer.add_message(LayerField::kValues, value_of_flag(false));
    layer.add_message(LayerField::kValues, value_of_flag(true));
    for (const TileContour& contour : contours) {
      layer.add_message(LayerField::kValues, value_of_height(contour.ele));
    }
    layer.add_uint32(LayerField::kExtent, kTileExtent);
  }
  std::string bytes;
  protozero::pbf_builder<TileField>(bytes).add_message(TileField::kLayers, layer_bytes);
  return bytes;
}

/// The TIN of a zoom's lines.
const PixelLevel& level_of(const MercatorPyramid& pyramid, int zoom) {
  return pyramid.level(std::min(zoom + 1, pyramid.finest_level()));
}

double relief_of(const Globe& globe) noexcept { return globe.max_height() - globe.min_height(); }

}  // namespace

double contour_interval(int zoom, double relief) noexcept {
  constexpr std::array<double, 14> kIntervals{1000, 500, 200, 200, 100, 100, 50,
                                              50,   20,  20,  10,  5,   2,   1};
  constexpr int kFirst = 6, kLast = 13;
  const double usual = kIntervals[static_cast<std::size_t>(std::clamp(zoom - kFirst, 0, kLast))];
  const double most = std::max(relief / kLeastLevels, kLeastInterval);
  if (usual <= most) return usual;
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  // A power of ten that is rounded upwards would leave none of the three.
  for (const double times : {5.0, 2.0}) {
    if (times * power <= most) return times * power;
  }
  return power;
}

int last_contour_zoom(const MercatorPyramid& pyramid) noexcept {
  return pyramid.finest_level() - 2 + kZoomsOfFullTin;
}

std::optional<ContourTile> contour_tile(const MercatorPyramid& pyramid, const WebTile& tile,
                                        std::optional<double> interval, const QueryLimits& limits) {
  if (tile.z > last_contour_zoom(pyramid) || !pyramid.has(tile.z, tile.x, tile.y)) {
    return std::nullopt;
  }
  const Globe& globe = pyramid.globe();
  const double metres = globe.metres_per_height();
  const double apart = interval.value_or(contour_interval(tile.z, relief_of(globe)));
  const std::vector<std::int64_t> numbers = level_numbers(globe, apart);
  ContourTile made;
  const Globe::Lease path = globe.path();
  TileLines lines(pyramid, *path, tile, limits.share(5, 16).memory_bytes);
  const std::optional<Window> window = lines.window();
  if (!window || numbers.empty()) return made;

  IsolineRequest request;
  for (const std::int64_t n : numbers) {
    request.levels.push_back(static_cast<double>(n) * apart / metres);
  }
  request.region = *window;
  request.cuts = false;
  request.detail = level_of(pyramid, tile.z).detail;
  // The rest is that of the lines in steps, and of the tile's bytes.
  request.limits = limits.share(11, 16);
  const Isolines isolines = pyramid.terrain().isolines(request);
  made.cost = isolines.cost;
  std::vector<TileContour> contours;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < isolines.size(); ++i) {
    stop_if_asked(limits.stop, "the tile");
    const Isoline line = isolines.line(i, points);
    const auto n = std::llround(isolines.levels()[line.level] * metres / apart);
    const double ele = static_cast<double>(n) * apart;
    if (contours.empty() || contours.back().ele != ele) {
      if (!contours.empty() && contours.back().lines.empty()) contours.pop_back();
      contours.push_back({ele, n % kLinesToIndex == 0, {}});
    }
    lines.add(line.points, contours.back().lines);
  }
  if (!contours.empty() && contours.back().lines.empty()) contours.pop_back();
  made.bytes = vector_tile(contours);
  return made;
}

nlohmann::json contour_facts(const MercatorPyramid& pyramid, std::optional<double> interval) {
  if (interval) static_cast<void>(level_numbers(pyramid.globe(), *interval));
  nlohmann::json intervals = nlohmann::json::array();
  for (int z = 0; z <= last_contour_zoom(pyramid); ++z) {
    intervals.push_back(interval.value_or(contour_interval(z, relief_of(pyramid.globe()))));
  }
  nlohmann::json facts = {
      {"vector_layers",
       {{{"id", "contours"},
         {"description",
          "Contours, higher ground to their right; ele: the height in metres, index: every fifth "
          "level"},
         {"fields", {{"ele", "Number"}, {"index", "Boolean"}}}}}},
      {"ptin:unit", "m"},
      {"ptin:intervals", std::move(intervals)}};
  facts.update(pyramid.place_facts(last_contour_zoom(pyramid)));
  return facts;
}

}  // namespace ptin::tools
