// SPDX-License-Identifier: GPL-3.0-or-later
//
// Charts over logarithmic axes: rows of measured values, and values at several counts.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/plot/canvas.h"

namespace ptin::tools {

/// A logarithmic scale with round ends.
class LogScale {
 public:
  /// A scale that holds all of the values; those that are not above 0 do not count. Without any: 1
  /// to 10.
  explicit LogScale(const std::vector<double>& values);

  struct Tick {
    double value;
    bool has_text;  ///< Where there is room for it; else a line alone.
    bool is_power_of_ten;
  };
  /// 0 at the low end, 1 at the high end; values beyond lie on the ends.
  [[nodiscard]] double share_of(double value) const;
  [[nodiscard]] const std::vector<Tick>& ticks() const noexcept { return ticks_; }

 private:
  double low_ = 1.0, high_ = 10.0;
  std::vector<Tick> ticks_;
};

/// A median, and how far up the slower ones reach.
struct ChartMark {
  double median = 0.0;
  std::optional<double> p95, p99;
  bool is_hollow = false;
};
struct ChartRow {
  std::string group;  ///< Written before the first row of a group.
  std::string name;
  std::string note;  ///< On the right.
  Colour colour{};
  std::vector<ChartMark> marks;
};
/// Rows below each other, over an axis of their values.
class RowChart {
 public:
  /// @param axis  Words below the axis.
  /// @param note  Words above the notes.
  RowChart(std::vector<ChartRow> rows, std::string axis, std::string note);

  [[nodiscard]] double height() const;  ///< Pixels, with axis and words.
  /// @param at  Its left upper corner.
  /// @param width  With names on the left and notes on the right.
  void draw(Canvas& canvas, CanvasPoint at, double width) const;

 private:
  void draw_mark(Canvas& canvas, const ChartRow& row, const ChartMark& mark, const CanvasBox& area,
                 double y) const;

  std::vector<ChartRow> rows_;
  std::string axis_, note_;
  LogScale scale_;
};

/// A line through values at counts, as 1, 2, 4.
struct CountLine {
  Colour colour{};
  bool is_dashed = false;
  std::vector<std::pair<int, double>> values;
};
/// Lines over counts, which stand side by side, and a logarithmic axis on the left.
/// @param area  With axes and words.
void draw_count_chart(Canvas& canvas, const CanvasBox& area, const std::string& title,
                      const std::string& axis, const std::vector<CountLine>& lines);

}  // namespace ptin::tools
