// SPDX-License-Identifier: GPL-3.0-or-later
//
// One question of the service: where it is asked, what it takes, and what answers it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "tools/ask/field.h"
#include "tools/ask/groups.h"
#include "tools/http/admission.h"
#include "tools/http/problem.h"
#include "tools/http/request.h"
#include "tools/http/response.h"
#include "tools/serve/catalogue.h"
#include "tools/serve/question.h"
#include "tools/serve/serve_options.h"

namespace ptin::serve {

/// A request on its way to an answer.
struct Asked {
  const http::Request& request;
  const Question& question;
  const ServeOptions& options;
  const Catalogue& catalogue;
  std::shared_ptr<const Collection> collection;  ///< Null where the path names none.
  std::string_view rest;                         ///< What a `*` of the path stands for.
  std::span<const ask::Format> formats;          ///< That the question offers.
  QueryLimits limits;  ///< For the engine: the memory that was reserved, the request's stop token.

  [[nodiscard]] const Terrain& terrain() const { return collection->terrain; }
  [[nodiscard]] const StoreFacts& facts() const { return collection->terrain.store().facts(); }
};

/// How much memory is lent to a question before it works.
enum class Reserves : std::uint8_t { kNothing, kQuarter, kAll };  // of question_memory

struct Endpoint {
  std::string_view path;  ///< "/collections/{id}/position"; a last segment `*` takes what follows.
  std::string_view name;  ///< In the log and in metrics: "position".
  bool takes_post;        ///< Beside GET and HEAD.
  std::string_view about;
  /// Rows that describe the parameters: nobody reads what they would be put into.
  ask::Parameters parameters;
  std::span<const ask::Format> formats;  ///< Without names where `f` does not choose.
  http::Lane lane;
  Reserves reserves;
  /// May throw http::Problem, or Error as the engine.
  http::Response (*answer)(const Asked& asked);
  /// Gives a refusal, which is as http::Problem has it, the form that clients of this question expect;
  /// null: it stays. Whatever refuses a request of this path: the question, or the server before it.
  void (*refusal)(http::Response& refusal) = nullptr;
  /// What its answers tell: the members of an object of JSON, or, where none is offered, of a
  /// collection of GeoJSON; and the properties of features.
  std::vector<ask::Field> members{}, properties{};
};

/// Paths of one segment beside the questions, which are answered at once (TerrainService::is_quick()).
inline constexpr std::array<std::string_view, 3> kQuickPaths = {"healthz", "readyz", "metrics"};

/// Every question, in the order of the documentation.
[[nodiscard]] std::span<const Endpoint> endpoints() noexcept;

}  // namespace ptin::serve
