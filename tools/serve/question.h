// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parameters of a question, told by name in a URL or in the body of a POST, and read by type.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "tools/http/request.h"
#include "tools/serve/client_json.h"

namespace ptin::serve {

/// What a question takes: the one truth for reading, for refusals and for OpenAPI.
struct ParameterFact {
  std::string_view name;
  std::string_view type;  ///< Of a JSON schema: "number", "integer", "string", "boolean", "array".
  std::string_view about;
  std::string_view example{};  ///< Empty: none.
  bool is_required = false;
};

/// The parameters of one request. All readers throw http::Problem 400, which names the parameter.
class Question {
 public:
  /// Takes the query of the URL and, of a POST, the members of a JSON object, or the fields of a
  /// form, in its body. A member that is no text is kept as JSON.
  /// @param bounds  Of all JSON in it.
  /// @throws http::Problem 400  a name that `facts` does not have (lists those that are), or that
  ///                            comes twice; a body that is no object, or deeper than 16
  ///                       413  as json_of_client()
  ///                       415  a body of another type
  Question(const http::Request& request, std::span<const ParameterFact> facts,
           const JsonBounds& bounds = {});

  [[nodiscard]] bool has(std::string_view name) const;
  /// The text; empty where it was not given.
  [[nodiscard]] const std::string& text(std::string_view name) const;
  /// @throws also where it was not given
  [[nodiscard]] const std::string& needed(std::string_view name) const;
  /// A finite number.
  [[nodiscard]] std::optional<double> number(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name, double otherwise) const;
  /// A whole number of at least 0.
  [[nodiscard]] std::optional<std::uint64_t> count(std::string_view name) const;
  /// "true" or "false", "1" or "0"; false where it was not given.
  [[nodiscard]] bool flag(std::string_view name) const;
  /// Numbers between commas, or an array of JSON.
  [[nodiscard]] std::vector<double> numbers(std::string_view name) const;
  /// One of `known`, the first where it was not given.
  [[nodiscard]] std::string_view choice(std::string_view name,
                                        std::span<const std::string_view> known) const;
  /// A value of JSON; null where it was not given.
  [[nodiscard]] nlohmann::json json(std::string_view name) const;

  /// `error`, or `vertices`, or neither.
  [[nodiscard]] DetailRequest detail() const;
  /// `bbox`: four numbers, or six of which the third and the sixth are heights and left alone; none
  /// where it was not given. In degrees across the antimeridian west is larger than east, by half a
  /// circle at least: Places::to_terrain() takes such a window.
  [[nodiscard]] std::optional<Window> bbox(std::string_view name = "bbox") const;

  /// The parameters in the order of their names: the same for every way to write one question.
  [[nodiscard]] std::string canonical() const;

 private:
  /// A parameter as text, and as JSON where it came so.
  struct Value {
    std::string text;
    nlohmann::json json = nlohmann::json::value_t::discarded;
  };
  void take(std::string name, Value value, std::span<const ParameterFact> facts);
  void take_body(const http::Request& request, std::span<const ParameterFact> facts);
  [[nodiscard]] const Value* find(std::string_view name) const;

  JsonBounds bounds_;
  std::map<std::string, Value, std::less<>> values_;
};

/// Without blanks before and behind.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// A finite number and nothing else, as a client writes it.
[[nodiscard]] std::optional<double> number_of(std::string_view text);

}  // namespace ptin::serve
