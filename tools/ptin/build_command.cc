// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/build_command.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <variant>

#include "engine/construct/build_option_table.h"
#include "engine/error.h"
#include "engine/number.h"
#include "tools/ask/groups.h"

namespace ptin::tools {

namespace {

/// What reads the word of an option.
ask::Into word_of(const WordOption& words, BuildOptions& options) {
  return [words, &options](const std::string& word) {
    std::size_t number = 0;
    while (words.words[number] != word) ++number;
    words.set(options, number);
  };
}

/// The row of an option of the engine's table.
ask::Parameter row_of(const BuildOption& option, BuildOptions& options) {
  ask::Parameter row{.name = option.name,
                     .words = option.words == nullptr ? "" : option.words,
                     .metavar = option.value == nullptr ? "" : option.value,
                     .range = option.unit == nullptr ? NumberRange::kAny : option.range,
                     .source_unit = option.unit == nullptr ? "" : option.unit,
                     .splits_at_commas = option.has_many && !option.is_file,
                     .help = option.help};
  if (option.has_many) row.values(1, ask::kAnyNumberOfValues);
  const auto place = [&](const auto& field) {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, WordOption>) {
      row.into = word_of(field, options);
      if (row.metavar.empty()) row.metavar = "TEXT";
      row.choices.assign(field.words.begin(), field.words.end());
    } else if constexpr (std::is_same_v<Field, std::optional<std::int64_t> BuildOptions::*>) {
      row.into = [&value = options.*field](const std::string& text) {
        value = parse_number<std::int64_t>(text);
        if (!value) refuse("\"" + text + "\" is no whole number");
      };
    } else if constexpr (std::is_same_v<Field, std::vector<int> BuildOptions::*>) {
      row.into = [&value = options.*field, read = option.numbers_of](
                     const std::vector<std::string>& words) { value = read(words); };
      row.values(1, ask::kAnyNumberOfValues).repeated();
    } else {
      row.into = &(options.*field);
    }
  };
  std::visit(place, option.field);
  if (std::holds_alternative<std::optional<std::array<double, 4>> BuildOptions::*>(option.field)) {
    row.values(4, 4);
  }
  return option.shows_default ? row.with_default() : row;
}

/// The work: its memory, threads and temporary files, and whether it goes on.
void add_work_options(ask::Parameters& rows, BuildCommand& command) {
  rows.add("memory", &command.memory, "SIZE",
           "Hard limit on the memory of the process, as 512M or 2G (default: 1G, or less where a "
           "cgroup or a resource limit allows less)");
  ask::add_threads(
      rows, command.threads,
      "Threads (default: one a processor that affinity and cgroups leave this process); fewer are "
      "used where memory is short. The output is the same for any number");
  rows.add(
      "tmp",
      [&command](const std::string& folder) {
        if (!std::filesystem::is_directory(folder)) refuse("there is no folder " + folder);
        command.tmp = folder;
      },
      "DIR", "Folder for temporary files (default: beside the output)");
  rows.add("resume", &command.resume, "", "Go on with an interrupted build");
  rows.add("discard", &command.discard, "",
           "Remove an interrupted build first; without INPUT, only that")
      .excluding("resume");
  rows.add("dry-run", &command.dry_run, "", "Say what the build would need, and stop");
  rows.add("progress-fd", &command.progress_fd, "FD",
           "Write progress as lines of JSON to this file descriptor")
      .within(NumberRange::kNotNegative);
  rows.add("parts", &command.parts, "N",
           "Read the source and divide the rest into this many jobs of a batch system, which `ptin "
           "build-part` does")
      .within({.least = 1, .most = 1 << 20})
      .needing("plan");
  rows.add("plan", &command.plan, "FILE", "With --parts: the plan to write for them")
      .needing("parts");
}

}  // namespace

ask::Parameters build_rows(BuildCommand& command) {
  ask::Parameters rows;
  rows.add(
          "input", &command.inputs, "",
          "A raster that GDAL reads, several of one grid, or points: LAS, LAZ (COPC too), a folder "
          "of these, CSV or XYZ text (.gz too), or a layer that OGR reads; several files of one "
          "CRS; or a TIN: PLY, OBJ, 2DM, LandXML")
      .spelled("INPUT")
      .values(1, ask::kAnyNumberOfValues);
  const auto add = [&](bool reads) {
    for (const BuildOption& option : build_option_table()) {
      if (option.reads == reads) rows.push_back(row_of(option, command.options));
    }
  };
  add(true);
  rows.add("output", &command.output, "FILE", "The .ptin file to write")
      .spelled("-o,--output")
      .required_at(ask::Door::kProgram);
  add(false);
  add_work_options(rows, command);
  rows.add("overwrite", &command.overwrite, "", "Replace an existing output");
  return rows;
}

}  // namespace ptin::tools
