// SPDX-License-Identifier: GPL-3.0-or-later
//
// A target, a header and a body of any kind become a question with typed values, or are refused with a
// Problem of 4xx. The first line of the input is the target, the second one Accept-Encoding; the rest
// is the body.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tests/fuzz/fuzz_target.h"
#include "tools/ask/questions.h"
#include "tools/http/etag.h"
#include "tools/http/gzip.h"
#include "tools/http/problem.h"
#include "tools/serve/endpoint.h"
#include "tools/serve/polyline.h"
#include "tools/serve/wkt_places.h"

namespace {

/// Calls what may refuse, and with nothing else than 4xx.
template <class Read>
void attempt(const Read& read) {
  try {
    read();
  } catch (const ptin::http::Problem& problem) {
    if (problem.status() < 400 || problem.status() > 499) std::abort();
    static_cast<void>(problem.response());
  }
}

/// Reads the parameters of a question of one kind where the service takes them.
template <class Asked>
void read_as(const ptin::serve::Question& q) {
  Asked asked;
  ptin::ask::Parameters rows;
  add_question(rows, asked);
  rows.keep(ptin::ask::Door::kService);
  attempt([&] { q.read(rows); });
}

void read_everything(const ptin::serve::Question& q) {
  read_as<ptin::LocateRequest>(q);
  read_as<ptin::ProfileRequest>(q);
  read_as<ptin::ask::SightQuestion>(q);
  read_as<ptin::ask::ViewshedQuestion>(q);
  read_as<ptin::ask::IsolineQuestion>(q);
  read_as<ptin::ask::HighestQuestion>(q);
  read_as<ptin::ask::VolumeQuestion>(q);
  attempt([&] { static_cast<void>(q.json("have")); });
  attempt([&] { static_cast<void>(ptin::serve::decode_polyline(q.text("locations"))); });
  for (const char* name : {"coords", "f"}) {
    attempt([&] { static_cast<void>(ptin::serve::points_of_wkt(q.text(name), name)); });
    attempt([&] { static_cast<void>(ptin::serve::lines_of_wkt(q.text(name), name)); });
    attempt([&] { static_cast<void>(ptin::serve::polygon_of_wkt(q.text(name), name)); });
  }
}

}  // namespace

PTIN_FUZZ_TARGET(http_request, data, size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::size_t line = text.find('\n'), second = text.find('\n', line + 1);
  ptin::http::Request request;
  request.method = "POST";
  request.target = text.substr(0, line);
  const std::string header =
      line == std::string::npos ? std::string() : text.substr(line + 1, second - line - 1);
  if (second != std::string::npos) request.body = text.substr(second + 1);
  static_cast<void>(ptin::http::takes_gzip(header));
  static_cast<void>(ptin::http::names_etag(header, "\"a\""));
  attempt([&] {
    const ptin::http::Target target = ptin::http::parse_target(request.target);
    request.path = target.path;
    request.parameters = target.parameters;
    for (const ptin::serve::Endpoint& endpoint : ptin::serve::endpoints()) {
      attempt([&] { read_everything(ptin::serve::Question(request, endpoint.parameters)); });
    }
  });
  return 0;
}
