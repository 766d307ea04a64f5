// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/io_plot.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "tools/facts/human.h"
#include "tools/measure/best_way.h"
#include "tools/plot/panel.h"
#include "tools/plot/row_chart.h"

namespace ptin::tools {

namespace {

constexpr int kIoSheetWidth = 1200, kIoLegendHeight = 36;
constexpr double kIoMargin = 24, kIoTitleHeight = 36, kIoLineHeight = 18, kLowerHeight = 240;
constexpr Colour kPackedColour{24, 26, 34}, kSecondColour{150, 60, 160};

Colour colour_of(ReadWay way) {
  switch (way) {
    case ReadWay::kAnnounced:
      return {20, 100, 190};
    case ReadWay::kFaults:
      return {208, 92, 24};
    case ReadWay::kPread:
      return {34, 140, 80};
    case ReadWay::kUring:
      break;
  }
  return {120, 122, 132};
}

void add_mark(const Readings& readings, bool is_hollow, ChartRow& row) {
  const Quantiles q = readings.seconds();
  const auto ms = [](const std::optional<double>& s) {
    return s ? std::optional(*s * 1e3) : std::nullopt;
  };
  if (q.median) row.marks.push_back({*q.median * 1e3, ms(q.p95), ms(q.p99), is_hollow});
}

/// "47.1 KiB, 9 faults".
std::string note_of(const Readings& cold) {
  if (cold.all().empty()) return {};
  const auto bytes = cold.mean_device_bytes();
  std::string text = bytes ? human_bytes(static_cast<std::uint64_t>(*bytes)) + ", " : "";
  const double faults = cold.mean_major_faults();
  return text + short_number(faults < 10 ? std::round(faults * 10) / 10 : std::round(faults)) +
         " faults";
}

std::vector<ChartRow> question_rows(const IoReport& report) {
  std::vector<ChartRow> rows;
  const auto add = [&](const char* group, ReadWay way, const Readings& cold, const Readings& warm) {
    const bool is_first = way == report.opening.front().way;
    ChartRow row{is_first ? group : "", name_of(way), note_of(cold), colour_of(way), {}};
    add_mark(warm, true, row);
    add_mark(cold, false, row);
    if (is_first || !row.marks.empty()) rows.push_back(std::move(row));
  };
  for (const OpeningFigures& o : report.opening) {
    if (report.why_not_cold.empty()) add("open", o.way, o.cold, {});
  }
  for (const QuestionFigures& q : report.questions) add(name_of(q.kind), q.way, q.cold, q.warm);
  return rows;
}

std::vector<ChartRow> search_rows(const IndexFigures& index) {
  std::vector<ChartRow> rows;
  for (const SearchFigures& s : index.searches) {
    ChartRow row{s.is_second ? "" : name_of(s.kind),
                 s.is_second ? "spatialindex" : "packed",
                 note_of(s.cold),
                 s.is_second ? kSecondColour : kPackedColour,
                 {}};
    add_mark(s.warm, true, row);
    add_mark(s.cold, false, row);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<CountLine> thread_lines(const IoReport& report, QuestionKind kind) {
  std::vector<CountLine> lines;
  for (const bool is_warm : {false, true}) {
    for (const OpeningFigures& o : report.opening) {
      CountLine line{colour_of(o.way), is_warm, {}};
      for (const ThreadFigures& f : report.threads) {
        const auto rate = quantiles_of(is_warm ? f.warm_per_second : f.cold_per_second).median;
        if (f.kind == kind && f.way == o.way && rate) line.values.emplace_back(f.threads, *rate);
      }
      if (!line.values.empty()) lines.push_back(std::move(line));
    }
  }
  return lines;
}

std::string facts_of_run(const IoRequest& request, const IoReport& report) {
  std::string text = std::filesystem::path(request.file).filename().string() + ", " +
                     human_bytes(report.file_bytes);
  if (!report.file_system.empty()) text += ", " + report.file_system;
  if (report.device) {
    text += "; device " + grouped(static_cast<std::uint64_t>(report.device->sequential_mb_s)) +
            " MB/s in order, " + short_number(std::round(report.device->random_4k_ms * 1e3) / 1e3) +
            " ms for 4 KiB anywhere";
  }
  return text;
}

LegendEntry dot_entry(bool is_hollow, std::string text) {
  return {[is_hollow](Canvas& canvas, const CanvasBox& box) {
            const CanvasPoint middle{(box.left + box.right) / 2, (box.top + box.bottom) / 2};
            canvas.dot(middle, 4.2, kInk);
            if (is_hollow) canvas.dot(middle, 2.7, {255, 255, 255});
          },
          std::move(text)};
}

std::vector<LegendEntry> io_legend() {
  return {dot_entry(false, "cold, median"),
          dot_entry(true, "warm, median"),
          {[](Canvas& canvas, const CanvasBox& box) {
             const double y = (box.top + box.bottom) / 2;
             canvas.line({box.left, y}, {box.right, y}, {});
             canvas.line({box.left, y}, {box.right - 9, y}, {kInk, 2.6});
             canvas.line({box.right - 9, y - 4}, {box.right - 9, y + 4}, {kInk, 1.4});
           },
           "95 % and 99 %, where enough were asked"},
          {nullptr, "cold: dropped from the page cache; what lies below it is not visible"}};
}

/// The sum of the figures, in lines that the sheet has room for.
std::vector<std::string> best_lines(const IoReport& report) {
  const auto best = best_way(report);
  if (!best) return {};
  constexpr std::size_t kLetters = 160;
  std::vector<std::string> lines = wrapped(best->sentence, kLetters);
  for (std::string& line : wrapped(best->beside, kLetters)) lines.push_back(std::move(line));
  return lines;
}

}  // namespace

void plot_io(const std::string& path, bool overwrite, const IoRequest& request,
             const IoReport& report) {
  const RowChart questions(question_rows(report), "milliseconds a question",
                           "cold, from the device");
  const RowChart searches(search_rows(report.index), "milliseconds a search, index alone",
                          "cold, from the device");
  const double lower = std::max(kLowerHeight, searches.height());
  const std::vector<std::string> said = best_lines(report);
  const double head = kIoTitleHeight + kIoLineHeight * static_cast<double>(said.size()) + 2;
  Canvas canvas(path, overwrite, kIoSheetWidth,
                static_cast<int>(head + questions.height() + lower) + 20 + kIoLegendHeight);
  canvas.text({kIoMargin, 18}, facts_of_run(request, report), {.size = 14, .is_bold = true});
  for (std::size_t i = 0; i < said.size(); ++i) {
    canvas.text({kIoMargin, 42 + kIoLineHeight * static_cast<double>(i)}, said[i]);
  }
  const double width = kIoSheetWidth - 2 * kIoMargin;
  questions.draw(canvas, {kIoMargin, head}, width);
  const double top = head + questions.height() + 10;
  constexpr double kChartWidth = 265;
  double left = kIoMargin;
  for (const QuestionKind kind : {QuestionKind::kPoint, QuestionKind::kWindow10000th}) {
    draw_count_chart(canvas, {left, top, left + kChartWidth, top + lower},
                     std::string(name_of(kind)) + ": questions a second", "threads",
                     thread_lines(report, kind));
    left += kChartWidth + 10;
  }
  searches.draw(canvas, {left + 14, top}, kIoSheetWidth - kIoMargin - left - 14);
  draw_sheet_legend(canvas, io_legend());
  canvas.publish();
}

}  // namespace ptin::tools
