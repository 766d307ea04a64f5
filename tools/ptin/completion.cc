// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin completion: a bash script made from the same table as parsing and help.
#include <memory>

#include <nlohmann/json.hpp>

#include "tools/error_status.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/cli.h"
#include "tools/ptin/man_page.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

std::string options_of(const CLI::App& app) {
  std::string words;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) words.append(" --").append(name);
    for (const std::string& name : option->get_snames()) words.append(" -").append(name);
  }
  return words;
}

std::string bash_script() {
  Context context;
  const CommandLine line = make_command_line(context);
  std::string names;
  std::string cases;
  for (const Command& command : commands()) {
    names.append(names.empty() ? "" : " ").append(command.name);
    cases.append("    ").append(command.name).append(") words=\"");
    cases.append(options_of(*line.app->get_subcommand(command.name))).append("\" ;;\n");
  }
  std::string script = "# bash completion for ptin; made by `ptin completion bash`\n_ptin() {\n";
  script.append("  local current=${COMP_WORDS[COMP_CWORD]} words=\n");
  script.append("  if [ \"$COMP_CWORD\" -eq 1 ]; then words=\"").append(names);
  script.append(" --help --version\"; fi\n  case ${COMP_WORDS[1]} in\n")
      .append(cases)
      .append("  esac\n");
  script.append(
      "  case $current in\n    -*) COMPREPLY=($(compgen -W \"$words\" -- \"$current\")) ;;\n");
  script.append(
      "    *) if [ \"$COMP_CWORD\" -eq 1 ]; then COMPREPLY=($(compgen -W \"$words\" -- "
      "\"$current\"));\n");
  script.append("       else COMPREPLY=($(compgen -f -- \"$current\")); fi ;;\n  esac\n}\n");
  script.append("complete -o filenames -F _ptin ptin\n");
  return script;
}

}  // namespace

Action declare_completion(CLI::App& app, Context& context) {
  const auto shell = std::make_shared<std::string>();
  app.add_option("SHELL", *shell, "bash; or man for the manual page")
      ->required()
      ->check(CLI::IsMember({"bash", "man"}));
  return [shell, &context] {
    const std::string text = *shell == "man" ? man_page() : bash_script();
    context.json ? print_json({{"text", text}}) : write_to_stdout(text);
    return kExitDone;
  };
}

}  // namespace ptin::tools
