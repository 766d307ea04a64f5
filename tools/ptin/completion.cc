// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin completion: a bash script made from the same table as parsing and help.
#include <memory>

#include <nlohmann/json.hpp>

#include "tools/error_status.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/command_line.h"
#include "tools/ptin/man_page.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

std::string bash_script(std::span<const Command> all) {
  Context context;
  std::string names;
  std::string cases;
  for (const Command& command : all) {
    names.append(names.empty() ? "" : " ").append(command.name);
    cases.append("    ").append(command.name).append(") words=\"");
    const Declared declared = declared_of(command, context);
    for (const ask::Parameter& row : declared.parameters) {
      if (is_argument(row)) continue;
      for (const std::string& name : names_of(row)) cases.append(" ").append(name);
    }
    cases.append("\" ;;\n");
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

Declared declare_completion(Context& context) {
  const auto shell = std::make_shared<std::string>();
  Declared declared;
  declared.parameters.add("shell", shell.get(), "", "bash; or man for the manual page")
      .spelled("SHELL")
      .of({"bash", "man"})
      .required_at(ask::Door::kBoth);
  declared.run = [shell, &context] {
    const std::string text = *shell == "man" ? man_page() : bash_script();
    context.json ? print_json({{"text", text}}) : write_to_stdout(text);
    return kExitDone;
  };
  return declared;
}

}  // namespace ptin::tools
