// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/question.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "tools/facts/human.h"
#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

using http::Problem;

std::string list_of(std::span<const ask::Parameter> rows) {
  std::string list;
  for (const ask::Parameter& row : rows) list.append(list.empty() ? "" : ", ").append(row.name);
  return list.empty() ? "none" : list;
}

/// The values of a parameter: of a list those between commas, or of an array of JSON.
std::vector<std::string> values_of(const ask::Parameter& row, std::string_view text) {
  if (!ask::is_list(row)) return {std::string(text)};
  text = ask::trimmed(text);
  if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
  const std::vector<std::string_view> parts = ask::parts_of(text, ',');
  return {parts.begin(), parts.end()};
}

}  // namespace

Question::Question(const http::Request& request, std::span<const ask::Parameter> rows,
                   const JsonBounds& bounds)
    : bounds_(bounds) {
  for (const auto& [name, value] : request.parameters) take(name, {value}, rows);
  if (!request.body.empty()) take_body(request, rows);
}

void Question::read(std::span<const ask::Parameter> rows) const {
  ask::Reading reading(ask::Door::kService);
  try {
    for (const ask::Parameter& row : rows) {
      const Value* const value = find(row.name);
      if (value != nullptr) reading.take(row, values_of(row, value->text));
    }
    reading.check(rows);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw Problem(400, error.context() + ": " + error.message()).at(error.context());
  }
}

void Question::take_body(const http::Request& request, std::span<const ask::Parameter> rows) {
  std::string_view type = request.header("content-type").value_or("application/json");
  type = ask::trimmed(type.substr(0, type.find(';')));
  if (type == "application/x-www-form-urlencoded") {
    for (auto& [name, value] : http::parse_form(request.body)) {
      take(std::move(name), {std::move(value)}, rows);
    }
    return;
  }
  if (type != "application/json") {
    throw Problem(415,
                  "the body is of a type that is not read here; send application/json or "
                  "application/x-www-form-urlencoded");
  }
  nlohmann::json body = json_of_client(request.body, "body", bounds_);
  if (!body.is_object()) {
    throw Problem(400, "the body is no JSON object; send the parameters as its members");
  }
  for (auto& [name, value] : body.items()) {
    if (value.is_string()) {
      take(name, {std::move(value.get_ref<std::string&>())}, rows);
    } else {
      std::string text = value.dump();
      take(name, {std::move(text), std::move(value)}, rows);
    }
  }
}

void Question::take(std::string name, Value value, std::span<const ask::Parameter> rows) {
  const bool is_known = std::any_of(rows.begin(), rows.end(),
                                    [&](const ask::Parameter& row) { return row.name == name; });
  if (!is_known) {
    throw Problem(400, "no parameter of this question is called \"" + tools::shown(name) +
                           "\"; it has " + list_of(rows))
        .at(tools::shown(name));
  }
  if (!values_.emplace(name, std::move(value)).second) {
    throw Problem(400, "the parameter " + name + " is given twice").at(name);
  }
}

const Question::Value* Question::find(std::string_view name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? nullptr : &found->second;
}

bool Question::has(std::string_view name) const { return find(name) != nullptr; }

const std::string& Question::text(std::string_view name) const {
  static const std::string kNothing;
  const Value* const value = find(name);
  return value == nullptr ? kNothing : value->text;
}

bool Question::is_json(std::string_view name) const {
  const Value* const value = find(name);
  return value != nullptr && !value->json.is_discarded();
}

nlohmann::json Question::json(std::string_view name) const {
  const Value* const value = find(name);
  if (value == nullptr) return {};
  return value->json.is_discarded() ? json_of_client(value->text, name, bounds_) : value->json;
}

std::string Question::canonical() const {
  std::string text;
  for (const auto& [name, value] : values_) {
    text.append(std::to_string(name.size())).append(":").append(name);
    text.append(std::to_string(value.text.size())).append("=").append(value.text);
  }
  return text;
}

}  // namespace ptin::serve
