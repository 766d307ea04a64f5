// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a subcommand is. Each has a file of its own and a row in the table of commands.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "tools/ask/parameter.h"

namespace ptin::tools {

class BuildCluster;

/// What every subcommand is given.
struct Context {
  /// The processes with which this one builds together; null where there are none. Empty where the
  /// program was made without them.
  std::function<std::unique_ptr<BuildCluster>()> join_cluster;
  std::vector<std::string> arguments;  ///< As they were given, behind the subcommand.
  std::stop_token stop;                ///< Fires on SIGINT and SIGTERM.
  bool json = false;   ///< --json: the answer on stdout and an error on stderr as JSON.
  bool quiet = false;  ///< -q: no progress, report or warning; what was asked for is printed.
  /// The values of the options, some of which wait for the terrain's units.
  std::shared_ptr<ask::Reading> reading = std::make_shared<ask::Reading>(ask::Door::kProgram);
};

/// Runs a parsed subcommand; returns the exit status.  @throws Error
using Action = std::function<int()>;

/// What a subcommand takes, but for the options of Context, which every subcommand has, and what it
/// does with it. The rows point into what `run` holds.
struct Declared {
  ask::Parameters parameters;
  Action run;
};

/// A subcommand that reads into `Options`, whose rows add_question() adds.
template <typename Options>
[[nodiscard]] Declared declared(Context& context,
                                int (*run)(const Options& options, const Context& context)) {
  const auto options = std::make_shared<Options>();
  Declared made{{}, [options, run, &context] { return run(*options, context); }};
  add_question(made.parameters, *options);
  return made;
}

struct Command {
  const char* name;
  const char* summary;   ///< One line.
  const char* examples;  ///< Ends --help.
  /// `context` outlives what is declared.
  Declared (*declare)(Context& context);
  /// Whether most of its work needs nothing of GDAL, PROJ and libcurl (tools/ptin/front.h).
  bool is_for_front = false;
};

/// Every subcommand, in the order of --help. From it come parsing, help and completion.
[[nodiscard]] std::span<const Command> commands() noexcept;

Declared declare_build(Context& context);
Declared declare_build_part(Context& context);
Declared declare_info(Context& context);
Declared declare_verify(Context& context);
Declared declare_refine(Context& context);
Declared declare_export(Context& context);
Declared declare_stream(Context& context);
Declared declare_unstream(Context& context);
Declared declare_viewer(Context& context);
Declared declare_tiles(Context& context);
Declared declare_locate(Context& context);
Declared declare_profile(Context& context);
Declared declare_sight(Context& context);
Declared declare_render(Context& context);
Declared declare_isoline(Context& context);
Declared declare_highest(Context& context);
Declared declare_volume(Context& context);
Declared declare_viewshed(Context& context);
Declared declare_bench(Context& context);
Declared declare_serve(Context& context);
Declared declare_completion(Context& context);

}  // namespace ptin::tools
