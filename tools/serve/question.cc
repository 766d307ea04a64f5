// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/question.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/number.h"
#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

using http::Problem;

Problem bad(std::string_view name, const std::string& what) {
  return Problem(400, what).at(std::string(name));
}

std::string list_of(std::span<const ParameterFact> facts) {
  std::string list;
  for (const ParameterFact& fact : facts) {
    list.append(list.empty() ? "" : ", ").append(fact.name);
  }
  return list.empty() ? "none" : list;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::optional<double> number_of(std::string_view text) {
  const std::optional<double> number = parse_number<double>(trimmed(text));
  return number && std::isfinite(*number) ? number : std::nullopt;
}

Question::Question(const http::Request& request, std::span<const ParameterFact> facts,
                   const JsonBounds& bounds)
    : bounds_(bounds) {
  for (const auto& [name, value] : request.parameters) take(name, {value}, facts);
  if (!request.body.empty()) take_body(request, facts);
  for (const ParameterFact& fact : facts) {
    if (fact.is_required && !has(fact.name)) {
      throw bad(fact.name, "the parameter " + std::string(fact.name) +
                               " is missing: " + std::string(fact.about) +
                               (fact.example.empty() ? "" : ", as " + std::string(fact.example)));
    }
  }
}

void Question::take_body(const http::Request& request, std::span<const ParameterFact> facts) {
  std::string_view type = request.header("content-type").value_or("application/json");
  type = trimmed(type.substr(0, type.find(';')));
  if (type == "application/x-www-form-urlencoded") {
    for (auto& [name, value] : http::parse_form(request.body)) {
      take(std::move(name), {std::move(value)}, facts);
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
      take(name, {std::move(value.get_ref<std::string&>())}, facts);
    } else {
      std::string text = value.dump();
      take(name, {std::move(text), std::move(value)}, facts);
    }
  }
}

void Question::take(std::string name, Value value, std::span<const ParameterFact> facts) {
  const bool is_known = std::any_of(facts.begin(), facts.end(),
                                    [&](const ParameterFact& fact) { return fact.name == name; });
  if (!is_known) {
    throw Problem(400, "no parameter of this question is called \"" + http::shown(name) +
                           "\"; it has " + list_of(facts))
        .at(http::shown(name));
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

const std::string& Question::needed(std::string_view name) const {
  if (!has(name)) throw bad(name, "the parameter " + std::string(name) + " is missing");
  return text(name);
}

std::optional<double> Question::number(std::string_view name) const {
  if (!has(name)) return std::nullopt;
  const std::optional<double> number = number_of(text(name));
  if (!number) throw bad(name, "\"" + http::shown(text(name)) + "\" is no finite number");
  return number;
}

double Question::number(std::string_view name, double otherwise) const {
  return number(name).value_or(otherwise);
}

std::optional<std::uint64_t> Question::count(std::string_view name) const {
  if (!has(name)) return std::nullopt;
  const auto count = parse_number<std::uint64_t>(trimmed(text(name)));
  if (!count) {
    throw bad(name, "\"" + http::shown(text(name)) + "\" is no whole number of at least 0");
  }
  return count;
}

bool Question::flag(std::string_view name) const {
  const std::string& given = text(name);
  if (given.empty() || given == "false" || given == "0") return false;
  if (given == "true" || given == "1") return true;
  throw bad(name, "\"" + http::shown(given) + "\" is neither true nor false");
}

std::vector<double> Question::numbers(std::string_view name) const {
  std::string_view given = trimmed(text(name));
  if (given.starts_with('[') && given.ends_with(']')) given = given.substr(1, given.size() - 2);
  std::vector<double> numbers;
  while (!given.empty()) {
    const std::size_t end = std::min(given.find(','), given.size());
    const std::optional<double> number = number_of(given.substr(0, end));
    if (!number) {
      throw bad(name, "\"" + http::shown(given.substr(0, end)) +
                          "\" is no finite number; expected numbers between commas");
    }
    numbers.push_back(*number);
    given.remove_prefix(std::min(end + 1, given.size()));
  }
  return numbers;
}

std::string_view Question::choice(std::string_view name,
                                  std::span<const std::string_view> known) const {
  const std::string& given = text(name);
  if (given.empty()) return known.front();
  const auto found = std::find(known.begin(), known.end(), given);
  if (found != known.end()) return *found;
  std::string list;
  for (const std::string_view one : known) list.append(list.empty() ? "" : ", ").append(one);
  throw bad(name, "\"" + http::shown(given) + "\" is not offered; expected one of " + list);
}

nlohmann::json Question::json(std::string_view name) const {
  const Value* const value = find(name);
  if (value == nullptr) return {};
  return value->json.is_discarded() ? json_of_client(value->text, name, bounds_) : value->json;
}

DetailRequest Question::detail() const {
  DetailRequest detail;
  detail.tolerance = number("error");
  detail.vertices = count("vertices");
  if (detail.tolerance && *detail.tolerance < 0) {
    throw bad("error", "an error is not negative; leave it out for full detail");
  }
  if (detail.tolerance && detail.vertices) {
    throw bad("vertices", "give error or vertices, not both");
  }
  return detail;
}

std::optional<Window> Question::bbox(std::string_view name) const {
  if (!has(name)) return std::nullopt;
  const std::vector<double> n = numbers(name);
  if (n.size() != 4 && n.size() != 6) {
    throw bad(name, "a window has four numbers: west, south, east, north");
  }
  const std::size_t half = n.size() / 2;
  const Window window{n[0], n[1], n[half], n[half + 1]};
  constexpr double kHalfCircle = 180;
  const bool is_across_antimeridian = std::abs(window.min_x) <= kHalfCircle &&
                                      std::abs(window.max_x) <= kHalfCircle &&
                                      window.min_x - window.max_x >= kHalfCircle;
  if ((window.min_x > window.max_x && !is_across_antimeridian) || window.min_y > window.max_y) {
    throw bad(name, "the window is inverted; expected west, south, east, north");
  }
  return window;
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
