// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive transmission, in bounded pieces: T0 and what matters most, then what a client lacks.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "engine/error.h"
#include "tools/http/problem.h"
#include "tools/region/serving.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Problem;

struct PieceQuestion {
  tools::Serving wanted;
  std::optional<std::uint64_t> max_bytes;
};

void add_question(ask::Parameters& rows, PieceQuestion& question) {
  rows.add("window", &question.wanted.window, "",
           "What the client looks at: xmin, ymin, xmax, ymax")
      .in(ask::Unit::kMap)
      .values(4, 4)
      .at(ask::Door::kService)
      .like("380000,3802000,382000,3804000");
  ask::add_error(rows, question.wanted.error, "Certified error allowed; without it full detail");
  rows.add("max_bytes", &question.max_bytes, "",
           "Most bytes of the answer, which ends on a frame; 256 KiB without it")
      .at(ask::Door::kService)
      .like("100000");
  ask::add_text(
      rows, "have",
      "What the client was served before, in that order: objects with window, error, splits",
      "[{\"error\":50,\"splits\":3000}]")
      .as_json();
  ask::add_text(rows, "fingerprint", "Fingerprint of the collection from which it was served");
}

std::vector<tools::Serving> held_servings(const Asked& asked) {
  const Question& q = asked.question;
  if (q.has("fingerprint") && q.text("fingerprint") != asked.collection->fingerprint) {
    throw Problem(409, "the file of this collection was replaced since; ask anew, without have")
        .at(q.has("have") ? "have" : "fingerprint");
  }
  if (!q.has("have")) return {};
  const nlohmann::json have = q.json("have");  // Its depth and its size are looked at.
  if (have.is_array()) {
    check_count(have.size(), asked.options.question.have, "servings", "have", "have");
  }
  std::vector<tools::Serving> servings;
  try {
    servings = tools::servings_of(q.text("have"));
  } catch (const Error& error) {
    throw Problem(400, error.message()).at("have");
  }
  return servings;
}

std::vector<StreamHeld> held_of(const Asked& asked) {
  std::vector<StreamHeld> held;
  for (const tools::Serving& s : held_servings(asked)) {
    const std::uint64_t splits = s.splits.value_or(asked.options.question.held_vertices);
    check_count(splits, asked.options.question.held_vertices, "held vertices", "held_vertices",
                "have");
    held.push_back({tools::predicate_of(s, asked.facts(), "have"), splits});
  }
  return held;
}

/// A piece may end on any frame, where that is worth the work.
constexpr std::uint64_t kFewestSplits = 1024;

/// Memory of a piece of so many bytes: while it grows, the text is there twice.
constexpr std::uint64_t bytes_of_text(std::uint64_t piece) { return 2 * piece; }

std::uint64_t most_bytes(const Asked& asked, const PieceQuestion& question) {
  const QuestionLimits& limits = asked.options.question;
  const std::uint64_t asked_for = question.max_bytes.value_or(limits.stream_bytes);
  check_count(asked_for, limits.most_stream_bytes, "bytes", "most_stream_bytes", "max_bytes");
  return asked_for;
}

}  // namespace

std::uint64_t most_held_vertices(const QuestionLimits& limits) {
  const std::uint64_t left =
      engine_memory(limits.question_memory, bytes_of_text(limits.stream_bytes));
  return std::min<std::uint64_t>(limits.held_vertices, most_held_within(left, kFewestSplits));
}

ask::Parameters stream_parameters() { return described<PieceQuestion>(); }

http::Response answer_stream(const Asked& asked) {
  const auto question = read<PieceQuestion>(asked);
  const tools::Serving& wanted = question.wanted;
  const std::uint64_t most = most_bytes(asked, question);
  StreamRequest request;
  request.wanted = tools::predicate_of(wanted, asked.facts(), "window");
  request.tolerance = wanted.error;
  request.held = held_of(asked);
  request.limits = engine_limits(asked, bytes_of_text(most));
  request.fewest_splits = kFewestSplits;
  // No more than so many bytes hold and so much memory takes: those behind the cut are not looked for.
  constexpr std::uint64_t kMemoryOfSplit = 512;
  request.most_splits =
      std::max<std::uint64_t>(1, std::min(most, request.limits.memory_bytes / kMemoryOfSplit));
  request.most_bytes = most;
  request.metadata = tools::metadata_of_stream(asked.terrain().store(), wanted);

  std::string text;
  const StreamSummary summary =
      asked.terrain().stream(request, [&](std::span<const std::byte> bytes) {
        text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      });
  http::Response response = answered(asked, std::move(text), asked.formats.front().media,
                                     summary.cost, summary.certificate.error,
                                     summary.certificate.complete && asked.facts().base_error == 0);
  response.add("Ptin-Splits", std::to_string(summary.splits));
  response.add("Ptin-Fingerprint", asked.collection->fingerprint);
  return response;
}

}  // namespace ptin::serve
