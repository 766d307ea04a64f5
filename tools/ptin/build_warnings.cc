// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/build_warnings.h"

#include <cstdio>
#include <string>

#include "tools/facts/human.h"
#include "tools/ptin/build_show.h"

namespace ptin::tools {

namespace {

/// Points with heights far apart are hardly repeated ones: a mean of them may lie where no ground
/// is. Whoever named the rule knows that.
void add_merging(const BuildCommand& command, const BuildReport& r, SourceWarnings& to) {
  constexpr double kManySteps = 100.0;
  const double steps = ratio(r.largest_shift_height, r.height_quantum);
  if (command.options.duplicates || steps <= kManySteps) return;
  to.add({"merged_heights",
          counted(r.merged_points, "point") + " fell together with others, at heights up to " +
              short_number(r.largest_shift_height) + " (" + short_number(steps) + " steps of " +
              short_number(r.height_quantum) +
              ") away from the mean that was taken; --duplicates min, max or first takes one of "
              "them, and of LAS --returns last leaves what lies near the ground",
          ""});
}

/// A file without points is mostly one that was not written, or not sent, to its end.
void add_empty_inputs(const BuildReport& r, SourceWarnings& to) {
  if (r.empty_inputs.empty()) return;
  const std::size_t others = r.empty_inputs.size() - 1;
  to.add({"empty_inputs",
          "there is no point in " + r.empty_inputs.front() +
              (others == 0 ? "" : ", nor in " + counted(others, "other file")) +
              "; is all of the source there?",
          ""});
}

/// Nothing can be asked of a terrain that is void everywhere.
void add_no_surface(const BuildCommand& command, const BuildReport& r, SourceWarnings& to) {
  if (r.source_samples > r.lone_samples) return;
  const std::string why = r.source_samples == 0 ? "no sample of the source has a height"
                                                : "no sample with a height has a triangle";
  to.add({"no_surface",
          command.output + " has no surface, all of it is void: " + why +
              "; look at the source, and at --nodata, --max-edge and --boundary",
          ""});
}

std::string place_of(const SourceWarning& w) {
  return w.line == 0 ? w.file : w.file + ":" + std::to_string(w.line);
}

/// How often, and in how many files.
std::string extent_of(const SourceWarning& w) {
  std::string text;
  if (w.count > 1) text = grouped(w.count) + " times, " + (w.point == 0 ? "here first" : "first");
  if (w.point > 0) text += (text.empty() ? "point " : " point ") + grouped(w.point);
  if (w.files > 1) text += (text.empty() ? "" : "; ") + counted(w.files - 1, "more file");
  return text.empty() ? "" : " (" + text + ")";
}

}  // namespace

SourceWarnings build_warnings(const BuildCommand& command, const BuildReport& report) {
  SourceWarnings all = report.warnings;
  add_merging(command, report, all);
  add_empty_inputs(report, all);
  add_no_surface(command, report, all);
  return all;
}

void print_warnings(const SourceWarnings& warnings, const Context& context) {
  if (context.json || context.quiet) return;
  for (const SourceWarning& w : warnings.all()) {
    const std::string place = w.file.empty() ? "" : place_of(w) + ": ";
    std::fprintf(stderr, "ptin: warning: %s%s%s\n", place.c_str(), w.message.c_str(),
                 extent_of(w).c_str());
  }
}

nlohmann::json warnings_json(const SourceWarnings& warnings) {
  nlohmann::json list = nlohmann::json::array();
  for (const SourceWarning& w : warnings.all()) {
    const bool has_file = !w.file.empty();
    list.push_back({{"kind", w.kind},
                    {"message", w.message},
                    {"file", has_file ? nlohmann::json(w.file) : nlohmann::json()},
                    {"line", w.line > 0 ? nlohmann::json(w.line) : nlohmann::json()},
                    {"point", w.point > 0 ? nlohmann::json(w.point) : nlohmann::json()},
                    {"count", w.count > 0 ? nlohmann::json(w.count) : nlohmann::json()},
                    {"files", has_file ? w.files : 0}});
  }
  return list;
}

}  // namespace ptin::tools
