// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/build_command.h"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <variant>

#include "engine/construct/build_option_table.h"
#include "tools/facts/numbers.h"
#include "tools/ptin/measures.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

/// Declares an option with a number, within its range.
template <class T>
CLI::Option* add_number(CLI::App& app, const BuildOption& option, const std::string& names,
                        T& number) {
  CLI::Option* const added = app.add_option(names, number, option.help);
  if (option.noun != nullptr) {
    const bool is_measure = *option.unit != '\0';
    added->check(is_measure ? plain_measure(option.range, option.unit)
                            : numbers(option.range, option.unit));
  }
  return added;
}

CLI::Option* add_words(CLI::App& app, const BuildOption& option, const std::string& names,
                       const WordOption& words, BuildOptions& options) {
  const std::vector<std::string> all(words.words.begin(), words.words.end());
  return app
      .add_option_function<std::string>(
          names,
          [words, all, &options](const std::string& word) {
            words.set(options, static_cast<std::size_t>(std::find(all.begin(), all.end(), word) -
                                                        all.begin()));
          },
          option.help)
      ->check(CLI::IsMember(all));
}

/// Declares an option of the table.
void add_build_option(CLI::App& app, const BuildOption& option, BuildOptions& options) {
  std::string names = std::string("--") + option.name;
  if (option.alias != nullptr) names += std::string(",--") + option.alias;
  const auto add = [&](const auto& field) -> CLI::Option* {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, WordOption>) {
      return add_words(app, option, names, field, options);
    } else {
      auto& value = options.*field;
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, bool>) {
        return app.add_flag(names, value, option.help);
      } else if constexpr (std::is_same_v<Value, std::optional<std::array<double, 4>>>) {
        return app
            .add_option_function<std::vector<double>>(
                names,
                [&value](const std::vector<double>& box) {
                  value = {box[0], box[1], box[2], box[3]};
                },
                option.help)
            ->expected(4)
            ->check(numbers(option.range, option.unit));
      } else if constexpr (std::is_same_v<Value, double> ||
                           std::is_same_v<Value, std::optional<double>>) {
        return add_number(app, option, names, value);
      } else {
        return app.add_option(names, value, option.help);
      }
    }
  };
  CLI::Option* const added = std::visit(add, option.field);
  if (std::holds_alternative<std::vector<int> BuildOptions::*>(option.field)) {
    added->delimiter(',')->allow_extra_args(false);
  } else if (option.has_many && !option.is_file) {
    added->delimiter(',');
  }
  if (option.value != nullptr) added->type_name(option.value);
  if (option.shows_default) added->capture_default_str();
}

/// The work: its memory, threads and temporary files, and whether it goes on.
void add_work_options(CLI::App& app, BuildCommand& command) {
  app.add_option("--memory", command.memory,
                 "Hard limit on the memory of the process, as 512M or 2G (default: 1G, or less\n"
                 "where a cgroup or a resource limit allows less)")
      ->type_name("SIZE");
  app.add_option(
         "--threads", command.threads,
         "Threads (default: one a processor that affinity and cgroups leave this process);\n"
         "fewer are used where memory is short. The output is the same for any number")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  app.add_option("--tmp", command.tmp, "Folder for temporary files (default: beside the output)")
      ->check(CLI::ExistingDirectory)
      ->type_name("DIR");
  auto* resume = app.add_flag("--resume", command.resume, "Go on with an interrupted build");
  app.add_flag("--discard", command.discard,
               "Remove an interrupted build first; without INPUT, only that")
      ->excludes(resume);
  app.add_flag("--dry-run", command.dry_run, "Say what the build would need, and stop");
  app.add_option("--progress-fd", command.progress_fd,
                 "Write progress as lines of JSON to this file descriptor")
      ->check(numbers(NumberRange::kNotNegative, ""))
      ->type_name("FD");
  auto* parts = app.add_option("--parts", command.parts,
                               "Read the source and divide the rest into this many jobs of a batch "
                               "system, which\n"
                               "`ptin build-part` does")
                    ->check(CLI::Range(1, 1 << 20))
                    ->type_name("N");
  auto* plan = app.add_option("--plan", command.plan, "With --parts: the plan to write for them")
                   ->needs(parts)
                   ->type_name("FILE");
  parts->needs(plan);
}

}  // namespace

void declare_build_options(CLI::App& app, BuildCommand& command) {
  app.add_option(
      "INPUT", command.inputs,
      "A raster that GDAL reads, several of one grid, or points: LAS, CSV or XYZ text (.gz\n"
      "too), or a layer that OGR reads; several files of one CRS; or a TIN: PLY, OBJ, 2DM, "
      "LandXML");
  const auto add = [&](bool reads) {
    for (const BuildOption& option : build_option_table()) {
      if (option.reads == reads) add_build_option(app, option, command.options);
    }
  };
  add(true);
  app.add_option("-o,--output", command.output, "The .ptin file to write")
      ->type_name("FILE")
      ->required();
  add(false);
  add_work_options(app, command);
  app.add_flag("--overwrite", command.overwrite, "Replace an existing output");
}

}  // namespace ptin::tools
