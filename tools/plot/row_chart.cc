// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/row_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

constexpr double kRowHeight = 17, kGroupGap = 9, kAxisHeight = 44, kHeadHeight = 22;
constexpr double kNames = 214, kNotes = 170;  // room on the left and on the right
constexpr Colour kGridLine{206, 208, 214}, kWhite{255, 255, 255};
constexpr Stroke kFineLine{kGridLine, 1.0, 0.6};

void draw_frame(Canvas& canvas, const CanvasBox& a) {
  canvas.line(std::array<CanvasPoint, 5>{{{a.left, a.top},
                                          {a.right, a.top},
                                          {a.right, a.bottom},
                                          {a.left, a.bottom},
                                          {a.left, a.top}}},
              {});
}

/// The ticks whose texts have room beside each other. Powers of ten come first: an axis of 1, 10, 100 is
/// read more easily than one of 2, 10, 50.
/// @param place   Where a tick's text has its middle, in pixels along the axis.
/// @param extent  How much of the axis a text takes, in pixels.
template <class Place, class Extent>
std::vector<LogScale::Tick> with_room(const LogScale& scale, const Place& place,
                                      const Extent& extent) {
  constexpr double kApart = 6;
  std::vector<LogScale::Tick> kept;
  for (const bool of_tens : {true, false}) {
    for (const LogScale::Tick& tick : scale.ticks()) {
      if (!tick.has_text || tick.is_power_of_ten != of_tens) continue;
      const bool has_room = std::none_of(kept.begin(), kept.end(), [&](const LogScale::Tick& k) {
        return std::abs(place(k.value) - place(tick.value)) <
               (extent(k.value) + extent(tick.value)) / 2 + kApart;
      });
      if (has_room) kept.push_back(tick);
    }
  }
  return kept;
}

std::vector<double> values_of(const std::vector<ChartRow>& rows) {
  std::vector<double> values;
  for (const ChartRow& row : rows) {
    for (const ChartMark& m : row.marks) {
      values.push_back(m.median);
      for (const auto& more : {m.p95, m.p99}) values.push_back(more.value_or(m.median));
    }
  }
  return values;
}

}  // namespace

LogScale::LogScale(const std::vector<double>& values) {
  std::vector<double> positive;
  std::copy_if(values.begin(), values.end(), std::back_inserter(positive),
               [](double v) { return v > 0 && std::isfinite(v); });
  if (!positive.empty()) {
    const auto [low, high] = std::minmax_element(positive.begin(), positive.end());
    low_ = *low / 1.3;
    high_ = *high * 1.3;
  }
  const double decades = std::log10(high_ / low_);
  const int first = static_cast<int>(std::floor(std::log10(low_)));
  for (int decade = first; decade <= first + std::ceil(decades) + 1; ++decade) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double value = digit * std::pow(10.0, decade);
      if (value >= low_ && value <= high_)
        ticks_.push_back({value, digit == 1 || decades < 3.2, digit == 1});
    }
  }
}

double LogScale::share_of(double value) const {
  if (!(value > low_)) return 0;
  return std::min(1.0, std::log(value / low_) / std::log(high_ / low_));
}

RowChart::RowChart(std::vector<ChartRow> rows, std::string axis, std::string note)
    : rows_(std::move(rows)),
      axis_(std::move(axis)),
      note_(std::move(note)),
      scale_(values_of(rows_)) {}

double RowChart::height() const {
  const auto groups =
      std::count_if(rows_.begin(), rows_.end(), [](const ChartRow& r) { return !r.group.empty(); });
  return kHeadHeight + kAxisHeight + kRowHeight * static_cast<double>(rows_.size()) +
         kGroupGap * static_cast<double>(groups + 1);
}

void RowChart::draw_mark(Canvas& canvas, const ChartRow& row, const ChartMark& mark,
                         const CanvasBox& area, double y) const {
  constexpr double kRadius = 4.2, kEnd = 4.0;
  const auto x_of = [&](double value) { return area.left + area.width() * scale_.share_of(value); };
  const double x = x_of(mark.median);
  if (mark.p99) canvas.line({x, y}, {x_of(*mark.p99), y}, {row.colour, 1.0});
  if (mark.p95) {
    const double end = x_of(*mark.p95);
    canvas.line({x, y}, {end, y}, {row.colour, mark.is_hollow ? 1.0 : 2.6});
    canvas.line({end, y - kEnd}, {end, y + kEnd}, {row.colour, 1.4});
  }
  canvas.dot({x, y}, kRadius, row.colour);
  if (mark.is_hollow) canvas.dot({x, y}, kRadius - 1.5, kWhite);
}

void RowChart::draw(Canvas& canvas, CanvasPoint at, double width) const {
  const CanvasBox area{at.x + kNames, at.y + kHeadHeight, at.x + width - kNotes,
                       at.y + height() - kAxisHeight};
  const auto x_of = [&](double value) { return area.left + area.width() * scale_.share_of(value); };
  for (const LogScale::Tick& tick : scale_.ticks()) {
    canvas.line({x_of(tick.value), area.top}, {x_of(tick.value), area.bottom}, kFineLine);
  }
  const auto width_of = [&](double value) { return canvas.text_width(short_number(value)); };
  for (const LogScale::Tick& tick : with_room(scale_, x_of, width_of)) {
    const double x = x_of(tick.value);
    canvas.line({x, area.bottom}, {x, area.bottom + 4}, {});
    canvas.text({x, area.bottom + 14}, short_number(tick.value), {TextAnchor::kMiddle});
  }
  canvas.text({area.right + 12, at.y + kHeadHeight / 2}, note_);
  double y = area.top + kGroupGap - kRowHeight / 2;
  for (const ChartRow& row : rows_) {
    y += kRowHeight;
    if (!row.group.empty()) {
      if (&row != &rows_.front()) {
        y += kGroupGap;
        const double between = y - kRowHeight / 2 - kGroupGap / 2;
        canvas.line({at.x, between}, {at.x + width, between}, kFineLine);
      }
      canvas.text({at.x, y}, row.group, {.is_bold = true});
    }
    canvas.text({area.left - 10, y}, row.name, {TextAnchor::kEnd});
    canvas.text({area.right + 12, y}, row.note);
    for (const ChartMark& mark : row.marks) draw_mark(canvas, row, mark, area, y);
  }
  draw_frame(canvas, area);
  canvas.text({(area.left + area.right) / 2, area.bottom + 32}, axis_, {TextAnchor::kMiddle});
}

void draw_count_chart(Canvas& canvas, const CanvasBox& area, const std::string& title,
                      const std::string& axis, const std::vector<CountLine>& lines) {
  std::vector<double> values;
  std::set<int> counts;
  for (const CountLine& line : lines) {
    for (const auto& [count, value] : line.values) {
      counts.insert(count);
      values.push_back(value);
    }
  }
  const LogScale scale(values);
  const CanvasBox inner{area.left + 64, area.top + kHeadHeight, area.right - 8,
                        area.bottom - kAxisHeight};
  const auto x_of = [&](int count) {
    const auto place = static_cast<double>(std::distance(counts.begin(), counts.find(count)));
    return inner.left + inner.width() * (place + 0.5) / static_cast<double>(counts.size());
  };
  const auto y_of = [&](double value) {
    return inner.bottom - inner.height() * scale.share_of(value);
  };
  for (const LogScale::Tick& tick : scale.ticks()) {
    canvas.line({inner.left, y_of(tick.value)}, {inner.right, y_of(tick.value)}, kFineLine);
  }
  constexpr double kLineOfText = 8;
  for (const LogScale::Tick& tick : with_room(scale, y_of, [](double) { return kLineOfText; })) {
    canvas.text({inner.left - 8, y_of(tick.value)}, short_number(tick.value), {TextAnchor::kEnd});
  }
  for (const int count : counts) {
    canvas.text({x_of(count), inner.bottom + 14}, std::to_string(count), {TextAnchor::kMiddle});
  }
  for (const CountLine& line : lines) {
    std::vector<CanvasPoint> points;
    for (const auto& [count, value] : line.values) points.push_back({x_of(count), y_of(value)});
    canvas.line(points, {line.colour, 1.6, 1.0, line.is_dashed});
    for (const CanvasPoint& p : points) {
      canvas.dot(p, 3.6, line.colour);
      if (line.is_dashed) canvas.dot(p, 2.2, kWhite);
    }
  }
  draw_frame(canvas, inner);
  canvas.text({area.left, area.top + kHeadHeight / 2}, title, {.is_bold = true});
  canvas.text({(inner.left + inner.right) / 2, inner.bottom + 32}, axis, {TextAnchor::kMiddle});
}

}  // namespace ptin::tools
