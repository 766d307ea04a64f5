// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/bench_report.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include <nlohmann/json.hpp>

#include "tools/facts/human.h"
#include "tools/measure/best_way.h"

namespace ptin::tools {

namespace {

constexpr const char* kPackedIndex = "packed";
constexpr const char* kSecondIndex = "spatialindex";

/// Three significant digits; a hyphen for none.
std::string figure(const std::optional<double>& value) {
  if (!value) return "-";
  std::array<char, 32> text{};
  const double v = *value;
  const int decimals = v == 0 || v >= 100 ? 0 : (v >= 10 ? 1 : (v >= 1 ? 2 : 3));
  std::snprintf(text.data(), text.size(), "%.*f", decimals, v);
  return v >= 1e15 ? std::string(text.data())
                   : (v >= 1000 ? grouped(static_cast<std::uint64_t>(v + 0.5)) : text.data());
}

std::optional<double> scaled(const std::optional<double>& value, double factor) {
  return value ? std::optional(*value * factor) : std::nullopt;
}

/// Columns of text, the first ones begun on the left, numbers ended on the right.
class AlignedTable {
 public:
  AlignedTable(std::size_t words, std::vector<std::string> head) : words_(words) {
    add(std::move(head));
  }
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] std::string text() const {
    std::vector<std::size_t> width(rows_.front().size());
    for (const auto& row : rows_) {
      for (std::size_t i = 0; i < row.size() && i < width.size(); ++i)
        width[i] = std::max(width[i], row[i].size());
    }
    std::string text;
    for (const auto& row : rows_) {
      std::string line;
      for (std::size_t i = 0; i < row.size(); ++i) {
        const std::string gap(width[i] - row[i].size(), ' ');
        line += (i == 0 ? "" : "  ") + (i < words_ ? row[i] + gap : gap + row[i]);
      }
      line.erase(line.find_last_not_of(' ') + 1);
      text += line + "\n";
    }
    return text;
  }

 private:
  std::size_t words_;
  std::vector<std::vector<std::string>> rows_;
};

/// A sentence in lines.
std::string in_lines(const std::string& sentence) {
  constexpr std::size_t kWidth = 110;
  std::string text;
  for (const std::string& line : wrapped(sentence, kWidth)) text += line + "\n";
  return text;
}

/// Times, and those left out because they were not cold: "40", "38 of 40".
std::string times_of(const Readings& readings) {
  const std::size_t n = readings.all().size();
  if (n + readings.not_cold() == 0) return "-";
  const std::string told = std::to_string(n);
  return readings.not_cold() == 0 ? told : told + " of " + std::to_string(n + readings.not_cold());
}

void add_quantiles(const Readings& readings, double factor, std::vector<std::string>& row) {
  const Quantiles q = readings.seconds();
  row.push_back(times_of(readings));
  for (const auto& value : {q.median, q.p95, q.p99}) row.push_back(figure(scaled(value, factor)));
}

/// What a question reads: as it counts itself, and, where it was cold, as the system does.
void add_reads(const Readings& cold, const Readings& warm, std::vector<std::string>& row) {
  const bool is_cold = !cold.all().empty();
  const Readings& counted = is_cold ? cold : warm;
  if (counted.all().empty()) {
    row.insert(row.end(), 6, "-");
    return;
  }
  row.push_back(figure(counted.mean_pages()));
  row.push_back(figure(counted.mean_nodes()));
  row.push_back(figure(counted.mean_asked_bytes() / 1024));
  row.push_back(figure(counted.asked_over_least()));
  row.push_back(figure(scaled(cold.mean_device_bytes(), 1.0 / 1024)));
  row.push_back(is_cold ? figure(cold.mean_major_faults()) : "-");
}

const std::vector<std::string> kReadingHead = {
    "times", "cold ms", "95 %",  "99 %",      "times",   "warm ms",    "95 %",
    "99 %",  "pages",   "nodes", "asked KiB", "/ least", "device KiB", "faults"};

/// "window 1/25 (announced, pread) is left out: why", a line a kind.
std::string left_out_text(const IoReport& report) {
  std::map<std::pair<QuestionKind, std::string>, std::string> ways;
  for (const QuestionFigures& q : report.questions) {
    if (q.why_left_out.empty()) continue;
    std::string& of_kind = ways[{q.kind, q.why_left_out}];
    of_kind += (of_kind.empty() ? "" : ", ") + std::string(name_of(q.way));
  }
  std::string text;
  for (const auto& [key, of_kind] : ways) {
    text +=
        std::string(name_of(key.first)) + " (" + of_kind + ") is left out: " + key.second + "\n";
  }
  return text;
}

std::string questions_text(const IoReport& report) {
  std::vector<std::string> head = {"question", "way"};
  head.insert(head.end(), kReadingHead.begin(), kReadingHead.end());
  AlignedTable table(2, head);
  const Readings none;
  const auto add = [&](const char* question, const char* way, const Readings& cold,
                       const Readings& warm) {
    std::vector<std::string> row = {question, way};
    add_quantiles(cold, 1e3, row);
    add_quantiles(warm, 1e3, row);
    add_reads(cold, warm, row);
    table.add(std::move(row));
  };
  for (const OpeningFigures& o : report.opening) {
    if (report.why_not_cold.empty()) add("open", name_of(o.way), o.cold, none);
  }
  for (const QuestionFigures& q : report.questions) {
    if (q.why_left_out.empty()) add(name_of(q.kind), name_of(q.way), q.cold, q.warm);
  }
  return table.text() + left_out_text(report);
}

std::string threads_text(const IoReport& report) {
  if (report.threads.empty()) return {};
  AlignedTable table(2, {"questions a second", "way", "threads", "times", "cold", "times", "warm"});
  for (const ThreadFigures& f : report.threads) {
    const auto cold = quantiles_of(f.cold_per_second), warm = quantiles_of(f.warm_per_second);
    if (cold.count + warm.count + f.not_cold == 0) continue;
    const std::string runs = std::to_string(cold.count);
    table.add({std::string(name_of(f.kind)) + ", " + std::to_string(f.questions) + " of them",
               name_of(f.way), std::to_string(f.threads),
               f.not_cold == 0 ? runs : runs + " of " + std::to_string(cold.count + f.not_cold),
               figure(cold.median), std::to_string(warm.count), figure(warm.median)});
  }
  return "\n" + table.text();
}

std::string indexes_text(const IoReport& report) {
  std::vector<std::string> head = {"search of the index alone", "index"};
  head.insert(head.end(), kReadingHead.begin(), kReadingHead.end());
  head.erase(std::find(head.begin(), head.end(), "pages"));
  head.erase(std::find(head.begin(), head.end(), "/ least"));
  AlignedTable table(2, head);
  for (const SearchFigures& s : report.index.searches) {
    std::vector<std::string> row = {name_of(s.kind), s.is_second ? kSecondIndex : kPackedIndex};
    add_quantiles(s.cold, 1e3, row);
    add_quantiles(s.warm, 1e3, row);
    const std::size_t pages = row.size();
    add_reads(s.cold, s.warm, row);
    row.erase(row.begin() + static_cast<std::ptrdiff_t>(pages));      // a search reads none,
    row.erase(row.begin() + static_cast<std::ptrdiff_t>(pages) + 2);  // and has no answer
    table.add(std::move(row));
  }
  std::string text = "\n" + table.text();
  const IndexFigures& index = report.index;
  if (!index.why_no_second.empty())
    return text + "libspatialindex is left out: " + index.why_no_second + "\n";
  text += "libspatialindex's tree: built in " + figure(index.build_seconds) + " s, " +
          human_bytes(index.bytes) + "; the packed R-tree is " + human_bytes(index.packed_bytes) +
          " of the file\n";
  if (!index.why_not_cold.empty())
    text += "libspatialindex's tree has no cold figures: " + index.why_not_cold + "\n";
  return text;
}

/// Whether a reading that was to be cold was not.
bool was_ever_warm(const IoReport& report) {
  const auto has_some = [](const auto& rows) {
    return std::any_of(rows.begin(), rows.end(),
                       [](const auto& row) { return row.cold.not_cold() > 0; });
  };
  return has_some(report.opening) || has_some(report.questions) ||
         has_some(report.index.searches) ||
         std::any_of(report.threads.begin(), report.threads.end(),
                     [](const ThreadFigures& f) { return f.not_cold > 0; });
}

std::string head_text(const IoRequest& request, const IoReport& report) {
  std::string text = "file      " + printable(request.file) + ", " + human_bytes(report.file_bytes);
  if (!report.file_system.empty()) text += ", " + report.file_system;
  text += "\n";
  constexpr std::uint64_t kFewBytes = std::uint64_t{8} << 20;  // of which no rate is of the device
  if (report.device && report.file_bytes >= kFewBytes) {
    text += "device    " + figure(report.device->sequential_mb_s) + " MB/s in order, " +
            figure(report.device->random_4k_ms) + " ms for 4 KiB anywhere (O_DIRECT)\n";
  }
  const std::string level =
      request.tolerance ? "at an error of " + short_number(*request.tolerance) : "exact";
  text += "asked     " + level + ", at places of seed " + std::to_string(request.seed) + ", in " +
          human_duration(report.seconds) + "\n";
  if (report.why_not_cold.empty()) {
    text +=
        "cold      dropped from the page cache before each question (posix_fadvise) and seen to be "
        "gone (mincore);\n"
        "          what the disk, the host of a virtual machine or a server keeps is not visible "
        "from here\n"
        "warm      the same question once more\n"
        "times     95 % and 99 % are told where two answers at least took longer: of 40 and of "
        "200\n";
    if (was_ever_warm(report))
      text +=
          "          `8 of 10`: two were not cold, since something else had read the file; they "
          "are in no figure\n";
  } else {
    text += "cold      not measured: " + report.why_not_cold + "\n";
  }
  if (report.why_not_cold.empty() && !report.has_device_bytes)
    text += "bytes     of the device are not known: this file system does not count them\n";
  if (!report.why_no_uring.empty()) text += "io_uring  not measured: " + report.why_no_uring + "\n";
  return text + "\n";
}

nlohmann::json or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}
nlohmann::json or_null(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

/// A row of `readings`: what was read, of which question, by which way or index.
nlohmann::json reading_json(const char* what, const char* question, const char* by, bool is_cold,
                            const Readings& readings) {
  const Quantiles q = readings.seconds();
  nlohmann::json row = {{"what", what},
                        {"question", nullptr},
                        {"by", by},
                        {"cold", is_cold},
                        {"times", q.count},
                        {"not_cold", readings.not_cold()},
                        {"median_ms", or_null(scaled(q.median, 1e3))},
                        {"p95_ms", or_null(scaled(q.p95, 1e3))},
                        {"p99_ms", or_null(scaled(q.p99, 1e3))},
                        {"pages", readings.mean_pages()},
                        {"index_nodes", readings.mean_nodes()},
                        {"asked_bytes", readings.mean_asked_bytes()},
                        {"asked_over_least", or_null(readings.asked_over_least())},
                        {"device_bytes", or_null(readings.mean_device_bytes())},
                        {"major_faults", readings.mean_major_faults()},
                        {"left_out", nullptr}};
  if (question != nullptr) row["question"] = question;
  return row;
}

nlohmann::json readings_json(const IoReport& report) {
  const bool has_cold = report.why_not_cold.empty();
  nlohmann::json rows = nlohmann::json::array();
  const auto add = [&](const char* what, const char* question, const char* by, const Readings& cold,
                       const Readings& warm) {
    if (has_cold && (!cold.all().empty() || cold.not_cold() > 0))
      rows.push_back(reading_json(what, question, by, true, cold));
    if (!warm.all().empty()) rows.push_back(reading_json(what, question, by, false, warm));
  };
  for (const OpeningFigures& o : report.opening) add("open", nullptr, name_of(o.way), o.cold, {});
  for (const QuestionFigures& q : report.questions) {
    add("question", name_of(q.kind), name_of(q.way), q.cold, q.warm);
    if (q.why_left_out.empty()) continue;
    rows.push_back(reading_json("question", name_of(q.kind), name_of(q.way), has_cold, {}));
    rows.back()["left_out"] = q.why_left_out;
  }
  for (const SearchFigures& s : report.index.searches) {
    add("search", name_of(s.kind), s.is_second ? kSecondIndex : kPackedIndex, s.cold, s.warm);
  }
  return rows;
}

nlohmann::json rates_json(const IoReport& report) {
  nlohmann::json rows = nlohmann::json::array();
  for (const ThreadFigures& f : report.threads) {
    for (const bool is_cold : {true, false}) {
      const Quantiles rate = quantiles_of(is_cold ? f.cold_per_second : f.warm_per_second);
      const std::uint64_t not_cold = is_cold ? f.not_cold : 0;
      if (rate.count + not_cold == 0) continue;
      rows.push_back({{"question", name_of(f.kind)},
                      {"by", name_of(f.way)},
                      {"threads", f.threads},
                      {"cold", is_cold},
                      {"times", rate.count},
                      {"not_cold", not_cold},
                      {"questions", f.questions},
                      {"per_second", or_null(rate.median)}});
    }
  }
  return rows;
}

nlohmann::json second_index_json(const IndexFigures& index) {
  const bool is_there = index.why_no_second.empty();
  return {{"why_not", or_null(index.why_no_second)},
          {"why_not_cold", or_null(index.why_not_cold)},
          {"build_seconds", is_there ? nlohmann::json(index.build_seconds) : nlohmann::json()},
          {"bytes", is_there ? nlohmann::json(index.bytes) : nlohmann::json()}};
}

nlohmann::json best_json(const IoReport& report) {
  const auto best = best_way(report);
  if (!best) return nullptr;
  nlohmann::json others = nlohmann::json::array();
  for (const WayRatio& other : best->others) {
    others.push_back({{"by", name_of(other.way)},
                      {"ratio", other.ratio},
                      {"at_least", other.at_least},
                      {"at_most", other.at_most},
                      {"verdict", name_of(other.verdict())},
                      {"kinds_less", other.kinds_less}});
  }
  const bool is_one = best->verdict == Verdict::kFaster;
  return {{"by", is_one ? nlohmann::json(name_of(best->way)) : nlohmann::json()},
          {"verdict", name_of(best->verdict)},
          {"cold", best->is_cold},
          {"kinds", best->kinds},
          {"over", name_of(best->way)},
          {"others", others},
          {"sentence", best->sentence + " " + best->beside}};
}

}  // namespace

std::string text_of(const IoRequest& request, const IoReport& report) {
  std::string text = head_text(request, report) + questions_text(report) + threads_text(report) +
                     indexes_text(report);
  if (const auto best = best_way(report))
    text += "\n" + in_lines(best->sentence) + in_lines(best->beside);
  return text;
}

nlohmann::json json_of(const IoRequest& request, const IoReport& report) {
  nlohmann::json device;
  if (report.device) {
    device = {{"sequential_mb_s", report.device->sequential_mb_s},
              {"random_4k_ms", report.device->random_4k_ms}};
  }
  return {{"file", request.file},
          {"bytes", report.file_bytes},
          {"file_system", or_null(report.file_system)},
          {"device", device},
          {"seed", request.seed},
          {"error", or_null(request.tolerance)},
          {"threads", request.most_threads},
          {"seconds", report.seconds},
          {"why_not_cold", or_null(report.why_not_cold)},
          {"why_no_io_uring", or_null(report.why_no_uring)},
          {"readings", readings_json(report)},
          {"rates", rates_json(report)},
          {"packed_index_bytes", report.index.packed_bytes},
          {"second_index", second_index_json(report.index)},
          {"best", best_json(report)}};
}

}  // namespace ptin::tools
