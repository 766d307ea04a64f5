// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/scratch/build_difference.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <nlohmann/json.hpp>

namespace ptin {

namespace {

/// A value as a command line has it.
std::string told(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "given" : "not given";
  if (value.is_null()) return "not given";
  if (!value.is_array()) {
    const std::string text = value.dump();
    return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
  }
  std::string all;
  for (const nlohmann::json& one : value) all += (all.empty() ? "" : " ") + told(one);
  return all.empty() ? "not given" : all;
}

std::string option_of(const std::string& key) {
  std::string option = key == "classes" ? "class" : key;
  std::replace(option.begin(), option.end(), '_', '-');
  return "--" + option;
}

class Differences {
 public:
  Differences(const nlohmann::json& then, const nlohmann::json& now) {
    if (!then.is_object() || !then.contains("options") || !then.contains("inputs")) {
      add("it was begun by another version of ptin");
      return;
    }
    compare_programs(then.value("program", nlohmann::json()),
                     now.value("program", nlohmann::json()));
    compare_options(then.at("options"), now.value("options", nlohmann::json::object()));
    if (then.value("page_bytes", nlohmann::json()) != now.value("page_bytes", nlohmann::json()))
      add("pages had " + told(then.value("page_bytes", nlohmann::json())) + " bytes and have " +
          told(now.value("page_bytes", nlohmann::json())));
    compare_inputs(then.at("inputs"), now.value("inputs", nlohmann::json::array()));
  }

  [[nodiscard]] std::string text() const {
    constexpr std::size_t kMost = 6;
    std::string text;
    for (std::size_t i = 0; i < std::min(all_.size(), kMost); ++i)
      text += (i == 0 ? "" : "; ") + all_[i];
    if (all_.size() > kMost) text += "; and " + std::to_string(all_.size() - kMost) + " more";
    return text.empty() ? "it was begun by another version of ptin" : text;
  }

 private:
  void add(std::string difference) { all_.push_back(std::move(difference)); }

  void compare_programs(const nlohmann::json& then, const nlohmann::json& now) {
    if (then == now) return;
    const auto version = [](const nlohmann::json& program) {
      return program.is_array() && !program.empty() ? told(program[0]) : std::string("unknown");
    };
    const bool is_same = version(then) == version(now);
    add(is_same ? "it was begun by another state of ptin " + version(now) +
                      ", whose temporary files are others"
                : "it was begun by ptin " + version(then) + ", and this is " + version(now));
  }

  void compare_options(const nlohmann::json& then, const nlohmann::json& now) {
    std::set<std::string> keys;
    for (const nlohmann::json* options : {&then, &now}) {
      for (const auto& [key, value] : options->items()) keys.insert(key);
    }
    for (const std::string& key : keys) {
      const nlohmann::json before = then.value(key, nlohmann::json()),
                           after = now.value(key, nlohmann::json());
      if (before == after) continue;
      add(option_of(key) + " was " + told(before) + " and is " + told(after));
    }
  }

  void compare_inputs(const nlohmann::json& then, const nlohmann::json& now) {
    const auto names_of = [](const nlohmann::json& inputs) {
      std::vector<std::string> names;
      for (const nlohmann::json& input : inputs) names.push_back(told(input.at(0)));
      return names;
    };
    std::vector<std::string> before = names_of(then), after = names_of(now);
    const bool is_other_order = before != after;
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    if (is_other_order && before == after) add("the inputs come in another order");
    for (const std::string& name : before) {
      if (!std::binary_search(after.begin(), after.end(), name))
        add("the input " + name + " is named no longer");
    }
    for (const std::string& name : after) {
      if (!std::binary_search(before.begin(), before.end(), name))
        add("the input " + name + " is new");
    }
    compare_files(then, now);
  }

  /// Files of inputs that are named by both builds.
  void compare_files(const nlohmann::json& then, const nlohmann::json& now) {
    for (const nlohmann::json& input : now) {
      const auto same = std::find_if(then.begin(), then.end(), [&](const nlohmann::json& other) {
        return other.at(0) == input.at(0);
      });
      if (same == then.end() || same->at(1) == input.at(1)) continue;
      const std::map<std::string, nlohmann::json> before = files_of(*same), after = files_of(input);
      for (const auto& [name, facts] : before) {
        const auto found = after.find(name);
        if (found == after.end()) {
          add(name + " is gone");
        } else if (found->second.at(1) != facts.at(1)) {
          add(name + " had " + told(facts.at(1)) + " bytes and has " + told(found->second.at(1)));
        } else if (found->second != facts) {
          add(name + " was written to since");
        }
      }
      for (const auto& [name, facts] : after) {
        if (!before.contains(name)) add(name + " was not there");
      }
    }
  }
  static std::map<std::string, nlohmann::json> files_of(const nlohmann::json& input) {
    std::map<std::string, nlohmann::json> files;
    for (const nlohmann::json& file : input.at(1)) files.emplace(told(file.at(0)), file);
    return files;
  }

  std::vector<std::string> all_;
};

}  // namespace

std::string what_differs(const nlohmann::json& begun_with, const nlohmann::json& now) {
  try {
    return Differences(begun_with, now).text();
  } catch (const nlohmann::json::
               exception&) {  // It has the parts that ours have, and other things in them.
    return "it was begun by another version of ptin";
  }
}

}  // namespace ptin
