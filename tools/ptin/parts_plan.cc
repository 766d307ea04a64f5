// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/parts_plan.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "engine/construct/build_parts.h"
#include "engine/error.h"
#include "tools/output/output_file.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

SourceWarnings write_parts_plan(const BuildCommand& command,
                                const std::vector<std::string>& arguments,
                                const BuildResources& resources) {
  const BegunParts begun =
      begin_parts(command.inputs, output_target(command.output), command.options, resources);
  const nlohmann::json plan = {{"ptin_parts", PTIN_VERSION},
                               {"folder", std::filesystem::current_path().string()},
                               {"arguments", arguments},
                               {"parts", command.parts},
                               {"note", nlohmann::json::parse(begun.note)}};
  OutputFile file(command.plan, command.overwrite);
  file.write(plan.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  file.publish();
  return begun.warnings;
}

PartsPlan read_parts_plan(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::not_found, "there is no such plan", path);
  std::ostringstream text;
  text << file.rdbuf();
  const nlohmann::json json = nlohmann::json::parse(text.str(), nullptr, false);
  const auto refuse_plan = [&](const char* what) {
    throw Error(ErrorCode::invalid_argument, what, path);
  };
  if (!json.is_object() || !json.contains("ptin_parts")) {
    refuse_plan("this is no plan of ptin build --parts");
  }
  if (json["ptin_parts"] != PTIN_VERSION) refuse_plan("the plan is of another version of ptin");
  PartsPlan plan;
  try {
    plan.folder = json.at("folder").get<std::string>();
    plan.note = json.at("note").dump();
    std::vector<std::string> arguments = json.at("arguments").get<std::vector<std::string>>();
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    CLI::App app;
    bool ignored = false;
    app.add_flag("-q,--quiet", ignored);
    app.add_flag("--json", ignored);
    declare_build_options(app, plan.command);
    app.parse(arguments);
  } catch (const nlohmann::json::exception&) {
    refuse_plan("the plan is damaged");
  } catch (const CLI::ParseError&) {
    refuse_plan("the plan is damaged");
  }
  return plan;
}

}  // namespace ptin::tools
