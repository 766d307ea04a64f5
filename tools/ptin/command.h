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

namespace CLI {
class App;
}

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
};

/// Runs a parsed subcommand; returns the exit status.  @throws Error
using Action = std::function<int()>;

struct Command {
  const char* name;
  const char* summary;   ///< One line.
  const char* examples;  ///< Ends --help.
  /// Declares options on `app`, but for those of Context, which every subcommand has, and returns
  /// what to run after parsing. `context` outlives both.
  Action (*declare)(CLI::App& app, Context& context);
};

/// Every subcommand, in the order of --help. From it come parsing, help and completion.
[[nodiscard]] std::span<const Command> commands() noexcept;

Action declare_build(CLI::App& app, Context& context);
Action declare_build_part(CLI::App& app, Context& context);
Action declare_info(CLI::App& app, Context& context);
Action declare_verify(CLI::App& app, Context& context);
Action declare_refine(CLI::App& app, Context& context);
Action declare_export(CLI::App& app, Context& context);
Action declare_stream(CLI::App& app, Context& context);
Action declare_unstream(CLI::App& app, Context& context);
Action declare_viewer(CLI::App& app, Context& context);
Action declare_locate(CLI::App& app, Context& context);
Action declare_profile(CLI::App& app, Context& context);
Action declare_sight(CLI::App& app, Context& context);
Action declare_render(CLI::App& app, Context& context);
Action declare_isoline(CLI::App& app, Context& context);
Action declare_highest(CLI::App& app, Context& context);
Action declare_volume(CLI::App& app, Context& context);
Action declare_viewshed(CLI::App& app, Context& context);
Action declare_bench(CLI::App& app, Context& context);
Action declare_serve(CLI::App& app, Context& context);
Action declare_completion(CLI::App& app, Context& context);

}  // namespace ptin::tools
