// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/limit_table.h"

#include <algorithm>
#include <array>

#include "engine/error.h"
#include "engine/memory_units.h"
#include "engine/number.h"
#include "tools/facts/human.h"

namespace ptin::serve {

namespace {

using std::chrono::milliseconds;

std::uint64_t in_ms(milliseconds time) { return static_cast<std::uint64_t>(time.count()); }
milliseconds of_ms(std::uint64_t ms) { return milliseconds(static_cast<std::int64_t>(ms)); }

constexpr std::uint64_t kAny = std::uint64_t{1} << 40;

#define PTIN_LIMIT(member)                                       \
  [](const ServeOptions& o) { return std::uint64_t{o.member}; }, \
      [](ServeOptions& o, std::uint64_t v) { o.member = v; }
#define PTIN_TIME(member)                                \
  [](const ServeOptions& o) { return in_ms(o.member); }, \
      [](ServeOptions& o, std::uint64_t v) { o.member = of_ms(v); }

constexpr auto kLimits = std::to_array<LimitFact>({
    {"request_line_bytes", "the first line of a request (414)", "bytes", 256, kGiB,
     PTIN_LIMIT(http.request_line_bytes)},
    {"header_bytes", "all header lines of a request (431)", "bytes", 256, kGiB,
     PTIN_LIMIT(http.header_bytes)},
    {"body_bytes", "the body of a request (413)", "bytes", 256, kGiB, PTIN_LIMIT(http.body_bytes)},
    {"connections",
     "connections at once; beyond, the longest idle one closes, or none is idle (503)", "", 1, kAny,
     PTIN_LIMIT(http.connections)},
    {"waiting", "requests that wait in each lane: points, tiles, sweeps (503)", "", 0, kAny,
     PTIN_LIMIT(http.waiting)},
    {"memory_bytes",
     "memory of all bodies, questions and answers at once; without it, as much as fills all "
     "threads (503)",
     "bytes", 1 << 20, kAny, PTIN_LIMIT(http.memory_bytes)},
    {"question_memory", "memory of one question (413)", "bytes", 1 << 20, kAny,
     PTIN_LIMIT(question.question_memory)},
    {"cache_bytes", "memory of answers that are kept for whoever asks the same", "bytes", 0, kAny,
     PTIN_LIMIT(cache_bytes)},
    {"reading", "time for the head of a request to arrive, and for its body (408)", "ms", 1, kAny,
     PTIN_TIME(http.reading)},
    {"queueing", "time that a question waits for its turn and for memory (503)", "ms", 1, kAny,
     PTIN_TIME(http.queueing)},
    {"computing", "time that a question is computed (503)", "ms", 1, kAny,
     PTIN_TIME(http.computing)},
    {"writing",
     "time for a client to take each 64 KiB; long answers 32 KiB a second (the connection closes)",
     "ms", 1, kAny, PTIN_TIME(http.writing)},
    {"idle", "time between two requests (the connection closes)", "ms", 1, kAny,
     PTIN_TIME(http.idle)},
    {"draining", "time that new connections are still told that the service ends", "ms", 0, kAny,
     PTIN_TIME(http.draining)},
    {"points", "positions of a question (413)", "", 1, kAny, PTIN_LIMIT(question.points)},
    {"pairs", "pairs of ends of lines of sight (413)", "", 1, kAny, PTIN_LIMIT(question.pairs)},
    {"vertices", "vertices of a mesh, points of lines, as far as question_memory holds them (413)",
     "", 1, kAny, PTIN_LIMIT(question.vertices)},
    {"held_vertices",
     "vertices that a receiver of a stream has, as far as question_memory holds them (413)", "", 1,
     kAny, PTIN_LIMIT(question.held_vertices)},
    {"have", "servings that a receiver of a stream has had (413)", "", 1, kAny,
     PTIN_LIMIT(question.have)},
    {"pixels", "pixels of a picture, as far as question_memory holds them (413)", "", 1, kAny,
     PTIN_LIMIT(question.pixels)},
    {"stream_bytes", "bytes of a stream's answer without max_bytes", "bytes", 1024, kAny,
     PTIN_LIMIT(question.stream_bytes)},
    {"most_stream_bytes", "bytes of a stream's answer (413)", "bytes", 1024, kAny,
     PTIN_LIMIT(question.most_stream_bytes)},
});

#undef PTIN_LIMIT
#undef PTIN_TIME

std::string known_names() {
  std::string names;
  for (const LimitFact& limit : kLimits) names.append(names.empty() ? "" : ", ").append(limit.name);
  return names;
}

std::uint64_t number_in(const LimitFact& limit, const std::string& text) {
  if (limit.unit == "bytes" && text == "0") return 0;  // Which is no size elsewhere.
  if (limit.unit == "bytes") return tools::parse_bytes(text, "--limit");
  if (const auto value = parse_number<std::uint64_t>(text)) return *value;
  refuse("\"" + text + "\" is no whole number; the limit " + std::string(limit.name) + " counts " +
             (limit.unit == "ms" ? "milliseconds" : "pieces"),
         "--limit");
}

}  // namespace

std::span<const LimitFact> limit_table() noexcept { return kLimits; }

void set_limit(ServeOptions& options, const std::string& name, const std::string& value) {
  const auto* const limit = std::find_if(kLimits.begin(), kLimits.end(),
                                         [&](const LimitFact& l) { return l.name == name; });
  if (limit == kLimits.end()) {
    refuse("no limit is called \"" + name + "\"; there are " + known_names(), "--limit");
  }
  const std::uint64_t number = number_in(*limit, value);
  if (number < limit->least) {
    refuse("the limit " + name + " is " + std::to_string(limit->least) + " at least", "--limit");
  }
  if (number > limit->most) {
    refuse("the limit " + name + " is " + std::to_string(limit->most) + " at most", "--limit");
  }
  limit->set(options, number);
}

}  // namespace ptin::serve
