// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/terrain_service.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <utility>

#include "engine/error.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/http/etag.h"
#include "tools/http/gzip.h"
#include "tools/http/list_header.h"
#include "tools/http/preconditions.h"
#include "tools/http/problem.h"
#include "tools/http/range.h"
#include "tools/serve/limit_table.h"
#include "tools/serve/packed_answer.h"

namespace ptin::serve {

namespace {

using http::Problem;
using http::Request;
using http::Response;

constexpr std::string_view kTileJson = "tilejson.json";

bool is_get(const Request& request) { return request.method == "GET" || request.method == "HEAD"; }

/// Whether a path has the form of a pattern; fills in what its `{id}` and `*` stand for.
bool fits(std::string_view pattern, const std::vector<std::string>& path, std::string& id,
          std::string& rest) {
  std::size_t at = 0;
  while (!pattern.empty()) {
    pattern.remove_prefix(1);  // the slash
    const std::size_t end = std::min(pattern.find('/'), pattern.size());
    const std::string_view segment = pattern.substr(0, end);
    pattern.remove_prefix(end);
    if (segment.empty()) return path.empty();
    if (at >= path.size()) return false;
    if (segment == "*") {
      for (; at < path.size(); ++at) rest.append(rest.empty() ? "" : "/").append(path[at]);
      return true;
    }
    if (segment == "{id}") {
      if (path[at].empty()) return false;
      id = path[at];
    } else if (segment != path[at]) {
      return false;
    }
    ++at;
  }
  return at == path.size();
}

std::uint64_t memory_of(Reserves reserves, const QuestionLimits& limits) {
  switch (reserves) {
    case Reserves::kNothing:
      return 0;
    case Reserves::kQuarter:
      return limits.question_memory / 4;
    case Reserves::kAll:
      break;
  }
  return limits.question_memory;
}

[[noreturn]] void throw_no_collection() {
  throw Problem(404, "there is no collection of this name; /collections lists them").at("id");
}

/// What a client may ask a path for.
std::string methods_of(const Endpoint* endpoint) {
  return endpoint != nullptr && endpoint->takes_post ? "GET, HEAD, POST, OPTIONS"
                                                     : "GET, HEAD, OPTIONS";
}

/// Whether the header Accept chooses between several types.
bool chooses_by_accept(const Endpoint& endpoint, const Question& question) {
  return endpoint.formats.size() > 1 && !question.has("f");
}

std::string header_of(const Response& response, std::string_view name) {
  for (const auto& [known, value] : response.headers) {
    if (known == name) return value;
  }
  return {};
}

Response plain_text(unsigned status, std::string text) {
  Response response;
  response.status = status;
  response.content_type = "text/plain; charset=utf-8";
  response.body = std::move(text);
  return response;
}

std::string now_text() {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto millis =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 40> text{};
  const std::size_t n = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::string fraction = std::to_string(millis);
  return std::string(text.data(), n) + "." + std::string(3 - fraction.size(), '0') + fraction + "Z";
}

}  // namespace

TerrainService::TerrainService(ServeOptions options, LogLine log)
    : options_(std::move(options)),
      access_(options_.token, options_.metrics),
      log_(std::move(log)),
      catalogue_(
          options_.files,
          [this](const std::string& id, const std::string& what) {
            metrics_.add("ptin_stale_files_total", "collection=\"" + id + "\"");
            this->log(
                {{"time", now_text()}, {"event", "file"}, {"collection", id}, {"detail", what}});
          }),
      cache_(options_.cache_bytes) {
  metrics_.declare_counter("ptin_requests_total", "Requests answered, by question and status.");
  metrics_.declare_counter("ptin_hung_up_total", "Clients that left before their answer.");
  metrics_.declare_counter("ptin_sent_bytes_total", "Bytes written, heads included.");
  metrics_.declare_counter("ptin_store_failures_total",
                           "Questions that failed because a file is damaged or cannot be read.");
  metrics_.declare_counter("ptin_stale_files_total",
                           "Times that a file was gone, or its successor could not be opened.");
  metrics_.declare_seconds("ptin_queue_seconds", "Time that a question waited for its turn.");
  metrics_.declare_seconds("ptin_compute_seconds", "Time that a question was computed.");
  metrics_.declare_gauge("ptin_connections", "Connections open.");
  metrics_.declare_gauge("ptin_waiting", "Questions that wait for their turn.");
  metrics_.declare_gauge("ptin_computing", "Questions being computed.");
  metrics_.declare_gauge("ptin_cache_bytes", "Answers that are kept.");
  metrics_.declare_gauge("ptin_memory_reserved_bytes",
                         "Memory lent to bodies, questions and answers.");
}

void TerrainService::enter(Request& request) const { enter_by(options_.public_address, request); }

bool TerrainService::is_quick(const Request& request) const {
  if (request.method == "OPTIONS" || access_.is_login(request)) return true;
  return request.path.size() == 1 &&
         std::find(kQuickPaths.begin(), kQuickPaths.end(), request.path[0]) != kQuickPaths.end();
}

Response TerrainService::answer_quickly(const Request& request) {
  if (request.method == "OPTIONS") return options_of(request);
  if (access_.is_login(request)) return access_.login(request);
  if (!is_get(request)) {
    throw Problem(405, "only GET and HEAD are answered here").allow(methods_of(nullptr));
  }
  if (request.path[0] == "readyz") return ready();
  if (request.path[0] == "metrics") {
    access_.check_metrics(request);
    return metrics_text();
  }
  return plain_text(200, "alive\n");
}

Response TerrainService::ready() const {
  std::string says = drains_ ? "draining\n" : "";
  for (const std::string& id : catalogue_.damaged()) says += "damaged: " + id + "\n";
  return says.empty() ? plain_text(200, "ready\n") : plain_text(503, std::move(says));
}

Response TerrainService::metrics_text() {
  if (server_ != nullptr) {
    const http::ServerLoad load = server_->load();
    metrics_.set("ptin_connections", "", static_cast<double>(load.connections));
    metrics_.set("ptin_waiting", "", static_cast<double>(load.waiting));
    metrics_.set("ptin_computing", "", static_cast<double>(load.computing));
    metrics_.set("ptin_memory_reserved_bytes", "", static_cast<double>(load.memory_bytes));
  }
  metrics_.set("ptin_cache_bytes", "", static_cast<double>(cache_.bytes()));
  Response response;
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.body = metrics_.text();
  return response;
}

TerrainService::Match TerrainService::match(const Request& request) const {
  for (const Endpoint& endpoint : endpoints()) {
    Match found;
    if (!fits(endpoint.path, request.path, found.id, found.rest)) continue;
    found.endpoint = &endpoint;
    return found;
  }
  return {};
}

void TerrainService::check(const Request& head) const {
  access_.check(head);
  const Match found = match(head);
  if (found.endpoint == nullptr) {
    throw Problem(404, "there is nothing under this path; / and /api list what there is");
  }
  if (!is_get(head) && !(found.endpoint->takes_post && head.method == "POST")) {
    const std::string methods = methods_of(found.endpoint);
    throw Problem(405, "only " + methods + " are answered here").allow(methods);
  }
  if (!found.id.empty() && !catalogue_.has(found.id)) throw_no_collection();
}

/// A question cheap in all but its size goes with dearer ones: a long body is long to read, and
/// the most important vertices of a terrain are looked for.
http::Needs TerrainService::needs(const Request& request) const {
  constexpr std::size_t kShortBody = std::size_t{16} << 10;
  const Match found = match(request);
  if (found.endpoint == nullptr) return {};
  http::Needs needs{found.endpoint->lane, memory_of(found.endpoint->reserves, options_.question)};
  const bool asks_for_vertices =
      std::any_of(request.parameters.begin(), request.parameters.end(),
                  [](const auto& parameter) { return parameter.first == "vertices"; }) ||
      request.body.find("vertices") != std::string::npos;
  if (needs.lane == http::Lane::kPoint && (request.body.size() > kShortBody || asks_for_vertices)) {
    needs.lane = http::Lane::kTile;
  }
  return needs;
}

void TerrainService::rest() noexcept {
  if (options_.give_back_freed_memory) options_.give_back_freed_memory();
}

void TerrainService::bound_freed_memory() noexcept {
  if (options_.bound_freed_memory) options_.bound_freed_memory();
}

Response TerrainService::answer(const Request& request) {
  return answer_endpoint(request, match(request));
}

/// What an answer depends on: the file, the question, what the client takes, and where it found us.
std::string TerrainService::key_of(const Request& request, const Match& found,
                                   const Collection* collection, const Question& question) const {
  std::string key = options_.version + "\n" + std::string(found.endpoint->path) + "\n";
  key += request.base + "\n";
  if (collection != nullptr) key += collection->fingerprint + collection->id;
  // A collection tells them.
  for (const LimitFact& limit : limit_table()) key += " " + std::to_string(limit.get(options_));
  if (collection != nullptr) {
    const BaseMap& map = base_map_of(options_, *collection);
    key += "\n" + map.tiles + "\n" + map.attribution;
  }
  key += "\n" + found.rest + "\n" + question.canonical() + "\n" + http::list_of(request, "accept");
  if (found.rest != kTileJson) return key;
  // It tells whole addresses.
  return key + "\n" + http::list_of(request, "host") + (request.is_secure ? "\nhttps" : "");
}

std::shared_ptr<const Collection> TerrainService::collection_of(const Match& found) const {
  if (found.id.empty()) return nullptr;
  std::shared_ptr<const Collection> collection = catalogue_.find(found.id);
  if (collection) return collection;
  throw_no_collection();
}

/// An address that names the version of its answers never gets other bytes.
std::string TerrainService::cache_control_of(const Question& question,
                                             const Collection& collection) const {
  if (question.text("v") != version_of(collection, options_.version)) return "no-cache";
  return (options_.token.empty() ? "public" : "private") +
         std::string(", max-age=31536000, immutable");
}

/// 304, with the headers that the whole answer would have (RFC 9110, section 15.4.5).
Response TerrainService::unchanged(std::string etag, std::string cache_control, bool is_chosen) {
  Response response;
  response.status = 304;
  response.add("ETag", std::move(etag));
  response.add("Cache-Control", std::move(cache_control));
  if (is_chosen) add_vary(response, "Accept");
  add_vary(response, "Accept-Encoding");
  return response;
}

Response TerrainService::answer_endpoint(const Request& request, const Match& found) {
  const std::shared_ptr<const Collection> collection = collection_of(found);
  JsonBounds bounds;
  bounds.memory_bytes = memory_of(found.endpoint->reserves, options_.question) / 2;
  bounds.stop = request.stop;
  const Question question(request, found.endpoint->parameters, bounds);
  // What a collection answers to a GET is the same until its file is replaced.
  if (!is_get(request) || !collection) return compute(request, found, collection, question);
  const std::string etag = http::etag_of(key_of(request, found, collection.get(), question));
  const std::string cache_control = cache_control_of(question, *collection);
  const std::string_view known = request.header("if-none-match").value_or("");
  if (http::names_etag(known, etag)) {
    const std::string packed = http::gzip_etag_of(etag);
    const bool has_packed = known.find(packed) != std::string_view::npos;
    return unchanged(has_packed ? packed : etag, cache_control,
                     chooses_by_accept(*found.endpoint, question));
  }
  const bool takes_gzip = http::takes_gzip(request.header("accept-encoding").value_or(""));
  const std::string cached = etag + (takes_gzip ? "gzip" : "");
  std::optional<Response> response = cache_.find(cached);
  if (!response) {
    response = compute(request, found, collection, question);
    if (response->status != 200 || response->long_body) return std::move(*response);
    response->add("ETag", etag);
    response->add("Cache-Control", cache_control);
    pack(takes_gzip, *response);
    cache_.keep(cached, *response);
  }
  // Whatever there is: there is an answer.
  if (known == "*") {
    return unchanged(header_of(*response, "ETag"), cache_control,
                     chooses_by_accept(*found.endpoint, question));
  }
  return std::move(*response);
}

/// The answer, with the memory that was reserved for it.
Response TerrainService::compute(const Request& request, const Match& found,
                                 const std::shared_ptr<const Collection>& collection,
                                 const Question& question) {
  const auto lease = request.memory;
  const Asked asked{request,
                    question,
                    options_,
                    catalogue_,
                    collection,
                    found.rest,
                    found.endpoint->formats,
                    {lease ? lease->bytes() : 0, request.stop}};
  Response response;
  try {
    response = found.endpoint->answer(asked);
  } catch (const Error& error) {
    if (collection && error.code() == ErrorCode::corruption) catalogue_.note_damage(*collection);
    throw;
  }
  if (response.held || response.long_body) return response;
  if (!is_get(request) || !collection) {
    pack(http::takes_gzip(request.header("accept-encoding").value_or("")), response);
  }
  if (lease) lease->shrink_to(response.body.capacity());
  response.held = lease;
  return response;
}

Response TerrainService::options_of(const Request& request) const {
  Response response;
  response.status = 204;
  const std::string methods = methods_of(match(request).endpoint);
  response.add("Allow", methods);
  if (!options_.cors_origin.empty() && request.header("access-control-request-method")) {
    response.add("Access-Control-Allow-Methods", methods);
    response.add("Access-Control-Allow-Headers",
                 "Content-Type, Authorization, If-Match, If-None-Match, If-Modified-Since, "
                 "If-Unmodified-Since, Range, If-Range");
    response.add("Access-Control-Max-Age", "86400");
  }
  return response;
}

Response TerrainService::failed(const Request& request, const Error& error, http::GivenUp why) {
  const std::string id = match(request).id;
  const unsigned status = tools::status_of(error.code()).http;
  switch (error.code()) {
    case ErrorCode::invalid_argument:
      return Problem(status, error.message()).response();
    case ErrorCode::resource_exhausted:
      return Problem(status,
                     "the answer takes more memory than the service gives a question of this "
                     "kind, " +
                         tools::human_bytes(
                             memory_of(match(request).endpoint->reserves, options_.question)) +
                         "; ask for less: a smaller window, a larger error, or fewer levels. "
                         "Whoever runs the "
                         "service gives more with --limit question_memory=SIZE")
          .beyond("question_memory")
          .response();
    case ErrorCode::cancelled:
      if (why == http::GivenUp::kDeadline) {
        return Problem(status,
                       "the answer takes longer than the service computes; ask for less: a smaller "
                       "window, a larger error, or fewer levels")
            .beyond("computing")
            .response();
      }
      return Problem(status, "the service ends").retry_after(1).response();
    case ErrorCode::corruption:
    case ErrorCode::io_error:
    case ErrorCode::not_found:
    case ErrorCode::unsupported_version:
      metrics_.add("ptin_store_failures_total", "collection=\"" + id + "\"");
      log({{"time", now_text()}, {"event", "store"}, {"id", request.id}, {"detail", error.what()}});
      return Problem(status,
                     "the file of this collection is damaged, or cannot be read; whoever runs "
                     "the service finds more in its log")
          .response();
    case ErrorCode::internal:
      break;
  }
  log({{"time", now_text()}, {"event", "fault"}, {"id", request.id}, {"detail", error.what()}});
  return Problem(status, "a fault of the service; whoever runs it finds more in its log")
      .response();
}

Response TerrainService::failure(const Request& request, std::exception_ptr thrown,
                                 http::GivenUp why) noexcept {
  try {
    return failure_told(request, std::move(thrown), why);
  } catch (...) {  // No memory even for a sentence: the status alone tells.
    Response response;
    response.status = 503;
    return response;
  }
}

Response TerrainService::failure_told(const Request& request, std::exception_ptr thrown,
                                      http::GivenUp why) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const Problem& problem) {
    return problem.response();
  } catch (const Error& error) {
    return failed(request, error, why);
  } catch (const std::bad_alloc&) {
    return Problem(503, "the system gives no more memory; come again later")
        .retry_after(5)
        .response();
  } catch (const std::exception& error) {
    return failed(request, {ErrorCode::internal, error.what()}, why);
  }
}

void TerrainService::finish(const Request& request, Response& response) {
  http::check_preconditions(request, response);
  http::select_range(request, response);
  if (response.content_type == http::kProblemJson) {
    const Endpoint* const asked = match(request).endpoint;
    if (asked != nullptr && asked->refusal != nullptr) asked->refusal(response);
  }
  if (!options_.cors_origin.empty()) {
    response.add("Access-Control-Allow-Origin", options_.cors_origin);
    response.add(
        "Access-Control-Expose-Headers",
        "ETag, Server-Timing, Ptin-Certified-Error, Ptin-Exact, Ptin-Bounds, "
        "Ptin-Fingerprint, Ptin-Splits, Ptin-Vertices, Ptin-Triangles, Content-Crs, Content-Range, "
        "Retry-After");
  }
  response.add("X-Content-Type-Options", "nosniff");
}

void TerrainService::note(const http::Served& served) noexcept {
  try {
    const Request& request = served.request;
    const Match found = request.is_parsed ? match(request) : Match{};
    const std::string question = found.endpoint ? std::string(found.endpoint->name)
                                 : is_quick(request) && !request.path.empty() ? request.path[0]
                                                                              : "none";
    const unsigned status = served.response ? served.response->status : 499;
    metrics_.add("ptin_requests_total",
                 "question=\"" + question + "\",status=\"" + std::to_string(status) + "\"");
    if (served.response == nullptr) metrics_.add("ptin_hung_up_total", "");
    metrics_.add("ptin_sent_bytes_total", "", static_cast<double>(served.bytes_written));
    metrics_.observe("ptin_queue_seconds", "", served.queue_seconds);
    metrics_.observe("ptin_compute_seconds", "question=\"" + question + "\"",
                     served.compute_seconds);
    nlohmann::ordered_json line = {{"time", now_text()},
                                   {"event", "request"},
                                   {"id", request.id},
                                   {"remote", request.remote},
                                   {"method", request.method},
                                   {"target", target_for_log(request)},
                                   {"question", question},
                                   {"status", status},
                                   {"bytes", served.bytes_written},
                                   {"queue_ms", 1e3 * served.queue_seconds},
                                   {"compute_ms", 1e3 * served.compute_seconds},
                                   {"write_ms", 1e3 * served.write_seconds}};
    if (!served.is_whole) line["whole"] = false;
    log(line);
  } catch (const std::exception&) {
    // Without memory for its line a request is not told; the next one is.
  }
}

void TerrainService::reload(const std::function<Reread()>& reread) {
  nlohmann::ordered_json line = {{"time", now_text()}, {"event", "reload"}};
  try {
    const Reread now = reread();
    catalogue_.replace(now.files);
    line["collections"] = nlohmann::ordered_json::array();
    for (const auto& collection : catalogue_.all()) line["collections"].push_back(collection->id);
    if (!now.changed.empty()) line["from_next_start"] = now.changed;
  } catch (const std::exception& error) {
    line["refused"] = error.what();
  }
  log(line);
}

void TerrainService::log(const nlohmann::ordered_json& line) const noexcept {
  try {
    log_(line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } catch (const std::exception&) {
    // As in note().
  }
}

}  // namespace ptin::serve
