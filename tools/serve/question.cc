// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/question.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

using http::Problem;

Problem bad(std::string_view name, const std::string& what) {
  return Problem(400, what).at(std::string(name));
}

http::Parameters members_of(const nlohmann::json& object) {
  if (!object.is_object()) {
    throw Problem(400, "the body is no JSON object; send the parameters as its members");
  }
  http::Parameters members;
  for (const auto& [name, value] : object.items()) {
    members.emplace_back(name, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return members;
}

http::Parameters fields_of(const std::string& form) {
  return http::parse_target("/?" + form).parameters;
}

/// The parameters that a body holds.
http::Parameters parameters_of_body(const http::Request& request) {
  if (request.body.empty()) return {};
  std::string_view type = request.header("content-type").value_or("application/json");
  type = trimmed(type.substr(0, type.find(';')));
  if (type == "application/json") return members_of(json_of_client(request.body, "body"));
  if (type == "application/x-www-form-urlencoded") return fields_of(request.body);
  throw Problem(415,
                "the body is of a type that is not read here; send application/json or "
                "application/x-www-form-urlencoded");
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
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_one = status == std::errc() && end == text.data() + text.size();
  if (!is_one || !std::isfinite(number)) return std::nullopt;
  return number;
}

nlohmann::json json_of_client(std::string_view text, std::string_view name, int most_deep) {
  using Event = nlohmann::json::parse_event_t;
  // The parser is recursive in nothing, but what it makes is taken apart recursively.
  bool is_too_deep = false;
  std::vector<std::set<std::string>> names;  // Of the members of the objects that are open.
  std::string twice;
  const auto watch = [&](int depth, Event event, nlohmann::json& parsed) {
    is_too_deep = is_too_deep || depth > most_deep;
    if (is_too_deep) return false;
    if (event == Event::object_start) names.emplace_back();
    if (event == Event::object_end) names.pop_back();
    if (event == Event::key && !names.back().insert(parsed.get<std::string>()).second) {
      twice = parsed.get<std::string>();
    }
    return true;
  };
  nlohmann::json json = nlohmann::json::parse(text.begin(), text.end(), watch, false);
  if (is_too_deep) {
    throw bad(name, "the JSON is deeper than " + std::to_string(most_deep) + " levels");
  }
  if (json.is_discarded()) throw bad(name, "this is no JSON");
  if (!twice.empty()) throw bad(name, "the member " + twice + " of the JSON is given twice");
  return json;
}

Question::Question(const http::Request& request, std::span<const ParameterFact> facts) {
  for (const auto& [name, value] : request.parameters) take(name, value, facts);
  for (auto& [name, value] : parameters_of_body(request)) take(name, std::move(value), facts);
  for (const ParameterFact& fact : facts) {
    if (fact.is_required && !has(fact.name)) {
      throw bad(fact.name, "the parameter " + std::string(fact.name) +
                               " is missing: " + std::string(fact.about) +
                               (fact.example.empty() ? "" : ", as " + std::string(fact.example)));
    }
  }
}

void Question::take(std::string name, std::string value, std::span<const ParameterFact> facts) {
  const bool is_known = std::any_of(facts.begin(), facts.end(),
                                    [&](const ParameterFact& fact) { return fact.name == name; });
  if (!is_known) {
    throw Problem(
        400, "no parameter of this question is called \"" + name + "\"; it has " + list_of(facts))
        .at(name);
  }
  if (!values_.emplace(name, std::move(value)).second) {
    throw Problem(400, "the parameter " + name + " is given twice").at(name);
  }
}

bool Question::has(std::string_view name) const { return values_.find(name) != values_.end(); }

const std::string& Question::text(std::string_view name) const {
  static const std::string kNothing;
  const auto found = values_.find(name);
  return found == values_.end() ? kNothing : found->second;
}

const std::string& Question::needed(std::string_view name) const {
  if (!has(name)) throw bad(name, "the parameter " + std::string(name) + " is missing");
  return text(name);
}

std::optional<double> Question::number(std::string_view name) const {
  if (!has(name)) return std::nullopt;
  const std::optional<double> number = number_of(text(name));
  if (!number) throw bad(name, "\"" + text(name) + "\" is no finite number");
  return number;
}

double Question::number(std::string_view name, double otherwise) const {
  return number(name).value_or(otherwise);
}

std::optional<std::uint64_t> Question::count(std::string_view name) const {
  if (!has(name)) return std::nullopt;
  const std::string_view given = trimmed(text(name));
  std::uint64_t count = 0;
  const auto [end, status] = std::from_chars(given.data(), given.data() + given.size(), count);
  if (status != std::errc() || end != given.data() + given.size()) {
    throw bad(name, "\"" + text(name) + "\" is no whole number of at least 0");
  }
  return count;
}

bool Question::flag(std::string_view name) const {
  const std::string& given = text(name);
  if (given.empty() || given == "false" || given == "0") return false;
  if (given == "true" || given == "1") return true;
  throw bad(name, "\"" + given + "\" is neither true nor false");
}

std::vector<double> Question::numbers(std::string_view name) const {
  std::string_view given = trimmed(text(name));
  if (given.starts_with('[') && given.ends_with(']')) given = given.substr(1, given.size() - 2);
  std::vector<double> numbers;
  while (!given.empty()) {
    const std::size_t end = std::min(given.find(','), given.size());
    const std::optional<double> number = number_of(given.substr(0, end));
    if (!number) {
      throw bad(name, "\"" + std::string(given.substr(0, end)) +
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
  throw bad(name, "\"" + given + "\" is not offered; expected one of " + list);
}

nlohmann::json Question::json(std::string_view name) const {
  return has(name) ? json_of_client(text(name), name) : nlohmann::json();
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
    text.append(std::to_string(value.size())).append("=").append(value);
  }
  return text;
}

}  // namespace ptin::serve
