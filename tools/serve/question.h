// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parameters of a request, told by name in a URL or in the body of a POST.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "tools/ask/parameter.h"
#include "tools/http/request.h"
#include "tools/serve/client_json.h"

namespace ptin::serve {

/// The parameters of one request. Refusals are http::Problem 400, which name the parameter.
class Question {
 public:
  /// Takes the query of the URL and, of a POST, the members of a JSON object, or the fields of a
  /// form, in its body. A member that is no text is kept as JSON.
  /// @param bounds  Of all JSON in it.
  /// @throws http::Problem 400  a name that `rows` do not have (lists those that are), or that
  ///                            comes twice; a body that is no object, or deeper than 16
  ///                       413  as json_of_client()
  ///                       415  a body of another type
  Question(const http::Request& request, std::span<const ask::Parameter> rows,
           const JsonBounds& bounds = {});

  [[nodiscard]] bool has(std::string_view name) const;
  /// The text; empty where it was not given.
  [[nodiscard]] const std::string& text(std::string_view name) const;
  /// Whether it came as JSON that is no text.
  [[nodiscard]] bool is_json(std::string_view name) const;
  /// A value of JSON; null where it was not given.
  [[nodiscard]] nlohmann::json json(std::string_view name) const;
  /// Puts the values where the rows say.  @throws http::Problem 400  as ask::Reading
  void read(std::span<const ask::Parameter> rows) const;

  /// The parameters in the order of their names: the same for every way to write one question.
  [[nodiscard]] std::string canonical() const;

 private:
  /// A parameter as text, and as JSON where it came so.
  struct Value {
    std::string text;
    nlohmann::json json = nlohmann::json::value_t::discarded;
  };
  void take(std::string name, Value value, std::span<const ask::Parameter> rows);
  void take_body(const http::Request& request, std::span<const ask::Parameter> rows);
  [[nodiscard]] const Value* find(std::string_view name) const;

  JsonBounds bounds_;
  std::map<std::string, Value, std::less<>> values_;
};

}  // namespace ptin::serve
