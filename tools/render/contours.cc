// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/contours.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/stop.h"
#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

constexpr Colour kContourColour{112, 72, 40};
const Stroke kFineContour{kContourColour, 0.7, 0.7};
const Stroke kIndexContour{kContourColour, 1.4, 0.85};
constexpr TextStyle kLabelStyle{
    .anchor = TextAnchor::kMiddle, .size = 10.5, .halo = 1.6, .colour = {84, 50, 24}};

/// Cairo's numbers end at some millions, so points far beside the map stay at this distance.
constexpr double kFarthestPixel = 1e5;  // pixels

std::vector<CanvasPoint> on_canvas(const Isoline& line, const View& view) {
  std::vector<CanvasPoint> points;
  points.reserve(line.points.size());
  for (const MapPoint& p : line.points) {
    points.push_back({std::clamp(view.pixel_x(p.x), -kFarthestPixel, kFarthestPixel),
                      std::clamp(view.pixel_y(p.y), -kFarthestPixel, kFarthestPixel)});
  }
  return points;
}

double distance_of(CanvasPoint a, CanvasPoint b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// A polyline by the length along it.
class MeasuredLine {
 public:
  explicit MeasuredLine(const std::vector<CanvasPoint>& points) : points_(points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      ends_.push_back(i == 0 ? 0.0 : ends_.back() + distance_of(points[i - 1], points[i]));
    }
  }
  [[nodiscard]] double length() const { return ends_.back(); }
  [[nodiscard]] CanvasPoint at(double along) const {
    const auto end = std::upper_bound(ends_.begin(), ends_.end(), along);
    const auto i = std::clamp<std::size_t>(static_cast<std::size_t>(end - ends_.begin()), 1,
                                           points_.size() - 1);
    const double step = ends_[i] - ends_[i - 1];
    const double share = step > 0 ? (along - ends_[i - 1]) / step : 0.0;
    const CanvasPoint a = points_[i - 1], b = points_[i];
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
  }

 private:
  const std::vector<CanvasPoint>& points_;
  std::vector<double> ends_;
};

/// Labels that stand on the map already.
class PlacedLabels {
 public:
  PlacedLabels(Canvas& canvas, const View& view) : canvas_(canvas), view_(view) {}

  /// Labels a line wherever it is straight enough, about every kEvery pixels.
  void label(const std::vector<CanvasPoint>& points, const std::string& text) {
    constexpr double kEvery = 380, kStep = 10;
    const double width = canvas_.text_width(text, kLabelStyle) + 6;
    const MeasuredLine line(points);
    if (line.length() < 2 * width) return;
    const double parts = std::max(1.0, std::floor(line.length() / kEvery));
    const double part = line.length() / parts;
    for (double begin = 0; begin + part <= line.length() + 1; begin += part) {
      // The middle of a part comes first, then what lies farther and farther from it.
      for (double off = 0; off < part / 2 - width / 2; off += kStep) {
        const double middle = begin + part / 2;
        if (place(line, middle + off, width, text) || place(line, middle - off, width, text)) break;
      }
    }
  }
  [[nodiscard]] bool any() const { return !taken_.empty(); }

 private:
  struct Taken {
    CanvasPoint middle;
    double radius;
  };

  bool place(const MeasuredLine& line, double middle, double width, const std::string& text) {
    // A chord as long as the label must be nearly as long as the line below it.
    constexpr double kStraight = 0.88;
    if (middle < width / 2 || middle > line.length() - width / 2) return false;
    const CanvasPoint a = line.at(middle - width / 2), b = line.at(middle + width / 2);
    if (distance_of(a, b) < kStraight * width) return false;
    const CanvasPoint at{(a.x + b.x) / 2, (a.y + b.y) / 2};
    if (!has_room(at, width / 2)) return false;
    // Higher ground lies to the right of the line, and a text's head to the left of its words: the
    // text runs against the line.
    TextStyle style = kLabelStyle;
    style.turn = std::atan2(a.y - b.y, a.x - b.x);
    canvas_.text(at, text, style);
    taken_.push_back({at, width / 2});
    return true;
  }

  [[nodiscard]] bool has_room(CanvasPoint at, double radius) const {
    constexpr double kBetween = 14;
    if (at.x < radius || at.y < radius || at.x > view_.width - radius ||
        at.y > view_.height - radius) {
      return false;
    }
    return std::none_of(taken_.begin(), taken_.end(), [&](const Taken& other) {
      return distance_of(at, other.middle) < radius + other.radius + kBetween;
    });
  }

  Canvas& canvas_;
  const View& view_;
  std::vector<Taken> taken_;
};

/// Calls `take` with the points of each line and its height.
template <class Take>
void for_each_line(const Isolines& lines, const View& view, const std::stop_token& stop,
                   const Take& take) {
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i % 64 == 0) stop_if_asked(stop, "drawing");
    const Isoline line = lines.line(i, points);
    if (line.points.size() > 1) take(on_canvas(line, view), lines.levels()[line.level]);
  }
}

}  // namespace

void draw_contours(Canvas& canvas, const Isolines& lines, const View& view,
                   const std::function<bool(double)>& is_index, const std::stop_token& stop) {
  for_each_line(lines, view, stop, [&](const std::vector<CanvasPoint>& points, double height) {
    canvas.line(points, is_index(height) ? kIndexContour : kFineContour);
  });
  // Labels come last: no line may be drawn over one.
  PlacedLabels labels(canvas, view);
  for (const bool of_index : {true, false}) {
    if (labels.any()) break;
    for_each_line(lines, view, stop, [&](const std::vector<CanvasPoint>& points, double height) {
      if (is_index(height) == of_index) labels.label(points, short_number(height));
    });
  }
}

}  // namespace ptin::tools
