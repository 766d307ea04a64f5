// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin serve: questions over HTTP.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include "engine/error.h"
#include "engine/remote/remote_file.h"
#include "storage/file/sigbus_guard.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/http/descriptors.h"
#include "tools/http/server.h"
#include "tools/kept_memory.h"
#include "tools/ptin/query_options.h"
#include "tools/ptin/stop_on_signals.h"
#include "tools/serve/config_file.h"
#include "tools/serve/limit_table.h"
#include "tools/serve/log_writer.h"
#include "tools/serve/terrain_service.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

struct ServeCommand {
  std::vector<std::string> files;
  std::string listen, public_url, cors, token_file, metrics;  // Empty: not given.
  std::string base_map, base_map_attribution;
  std::string config, memory;
  std::vector<std::string> limits, trusted_proxies;
  int threads = 0;  ///< 0: as many as the process may use.
  bool offers_files = false;
};

/// NAME=FILE, or a file whose name without its extension is the name.
serve::ServedFile served_file(const std::string& text) {
  const std::size_t equals = text.find('=');
  std::error_code unknown;
  const bool has_name = equals != std::string::npos && !is_remote(text);  // URLs have = too
  if (has_name && !std::filesystem::exists(text, unknown)) {
    return {text.substr(0, equals), text.substr(equals + 1)};
  }
  return {std::filesystem::path(text).stem().string(), text};
}

serve::ServeOptions program_defaults() {
  serve::ServeOptions options;
  options.http.draining = std::chrono::milliseconds(1000);
  options.version = PTIN_VERSION;
  return options;
}

serve::ServeOptions options_of(const ServeCommand& command) {
  serve::ServeOptions options = program_defaults();
  options.http.threads = static_cast<std::size_t>(thread_count(0));
  options.http.memory_bytes = 0;  // Until somebody says how much.
  if (!command.config.empty()) serve::read_config(command.config, options);
  for (const std::string& file : command.files) options.files.push_back(served_file(file));
  if (options.files.empty()) refuse("no file is given: name files, or --config with [collections]");
  if (!command.listen.empty()) options.listen = command.listen;
  if (!command.public_url.empty()) {
    options.public_address = serve::public_address_of(command.public_url, "--public-url");
  }
  if (!command.cors.empty()) {
    options.cors_origin = serve::checked_origin(command.cors, "--cors");
  }
  if (!command.base_map.empty()) {
    options.base_map.reset();  // With whom its configuration names for another one.
    serve::set_base_map_tiles(command.base_map, options);
  }
  if (!command.base_map_attribution.empty()) {
    if (!options.base_map) options.base_map.emplace();
    options.base_map->attribution = command.base_map_attribution;
  }
  if (options.base_map) {
    if (const char* const fault = fault_of(*options.base_map))
      refuse(fault, options.base_map->tiles);
  }
  if (!command.metrics.empty()) {
    options.metrics = serve::metrics_for(command.metrics, "--metrics");
  }
  for (const std::string& proxy : command.trusted_proxies) {
    serve::add_trusted_proxies(proxy, options);
  }
  if (!command.token_file.empty()) options.token = serve::read_token(command.token_file);
  if (command.threads > 0) options.http.threads = static_cast<std::size_t>(command.threads);
  if (command.offers_files) options.offers_files = true;
  if (!command.memory.empty()) serve::set_limit(options, "memory_bytes", command.memory);
  for (const std::string& limit : command.limits) {
    const std::size_t equals = limit.find('=');
    if (equals == std::string::npos) refuse("expected NAME=VALUE, as points=1000", "--limit");
    serve::set_limit(options, limit.substr(0, equals), limit.substr(equals + 1));
  }
  serve::divide_memory(options);
  if (options.question.question_memory > options.http.memory_bytes) {
    refuse("one question may take " + std::to_string(options.question.question_memory) +
           " bytes, and all together " + std::to_string(options.http.memory_bytes) +
           ": give more --memory, or a smaller --limit question_memory=SIZE");
  }
  return options;
}

/// Allows as many connections as there are descriptors for.
void fit_connections(serve::ServeOptions& options) {
  const std::size_t descriptors = http::raise_descriptor_limit();
  const std::size_t each = options.offers_files ? 2 : 1;
  options.http.connections = std::min(
      options.http.connections, http::connections_for(descriptors, http::open_descriptors(), each));
}

std::string sizes_text(const serve::ServeOptions& options) {
  const http::Limits& limits = options.http;
  return counted(limits.threads, "thread") + " for points, and " +
         counted(limits.threads + 1, "thread") +
         " for tiles and sweeps, of which neither has more than " + std::to_string(limits.threads) +
         "; " + human_bytes(limits.memory_bytes) + " of memory, of which freed memory has " +
         human_bytes(limits.kept_bytes) + ", " + human_bytes(options.question.question_memory) +
         " a question; " + counted(limits.connections, "connection");
}

using Settings = std::map<std::string, std::string>;

Settings settings_of(const ServeCommand& command) {
  return command.config.empty() ? Settings() : serve::settings_in(command.config);
}

/// The command's files as its configuration names them now, and what else that says otherwise than it did.
serve::Reread reread(const ServeCommand& command, const Settings& begun) {
  const Settings now = settings_of(command);
  std::vector<std::pair<std::string, std::string>> differ;
  std::set_symmetric_difference(begun.begin(), begun.end(), now.begin(), now.end(),
                                std::back_inserter(differ));
  std::set<std::string> names;
  for (const auto& [name, value] : differ) names.insert(name);
  return {options_of(command).files, {names.begin(), names.end()}};
}

int run_serve(const ServeCommand& command, const Context& context) {
  install_sigbus_guard();  // A file that is cut short fails questions, not the service.
  serve::ServeOptions options = options_of(command);
  const Settings begun = settings_of(command);
  options.bound_freed_memory = keep_freed_memory_of_questions(options.http.kept_bytes);
  options.give_back_freed_memory = give_back_freed_memory;
  std::signal(SIGPIPE, SIG_IGN);  // Of whoever read the log and left.
  serve::LogWriter log(STDERR_FILENO);
  serve::TerrainService service(options, [&log](const std::string& line) { log.add(line); });
  fit_connections(options);
  http::Server server(options.listen, options.http, service);
  service.watch(&server);
  if (!context.quiet) {
    const std::string address = server.address();
    const std::string shown = address.starts_with("unix:") ? address : "http://" + address + "/";
    std::printf("%s answers from %zu file%s; SIGTERM ends it\n%s\n", shown.c_str(),
                options.files.size(), options.files.size() == 1 ? "" : "s",
                sizes_text(options).c_str());
    std::fflush(stdout);
  }
  const std::stop_callback drains(context.stop, [&] {
    service.begin_to_drain();
    server.drain();
  });
  // Collections alone: what else a configuration says counts from the next start on.
  const OnHangUp reloads([&] { service.reload([&] { return reread(command, begun); }); });
  server.run();
  service.watch(nullptr);
  return kExitDone;
}

std::string limits_help() {
  std::string help = "A limit, as points=1000; may be given often. A refusal names it:";
  const serve::ServeOptions defaults = program_defaults();
  for (const serve::LimitFact& limit : serve::limit_table()) {
    help.append("\n  ").append(limit.name).append("=").append(std::to_string(limit.get(defaults)));
    if (!limit.unit.empty()) help.append(" ").append(limit.unit);
    help.append(": ").append(limit.about);
  }
  return help;
}

void add_question(ask::Parameters& rows, ServeCommand& command) {
  rows.add("file", &command.files, "FILE...", "Files, each as FILE or NAME=FILE")
      .spelled("FILE")
      .values(1, ask::kAnyNumberOfValues);
  rows.add(
      "listen", &command.listen, "ADDRESS:PORT",
      "Where to listen; 127.0.0.1:8080 without it; or a socket, unix:/PATH, unix:/PATH,mode=660");
  rows.add("public-url", &command.public_url, "URL",
           "The address under which clients know the service, as https://example.org/terrain/: "
           "addresses in answers begin with it");
  rows.add(
      "config", &command.config, "FILE",
      "TOML: listen, threads, public_url, cors, base_map, base_map_attribution, token_file, files, "
      "metrics, trusted_proxies, [collections], [limits]; options win over it");
  ask::add_threads(rows, command.threads,
                   "Questions of each lane (points, tiles, sweeps) that are computed at once");
  rows.add("memory", &command.memory, "SIZE",
           "Memory of all bodies, questions and answers; as much as fills all threads without it");
  rows.add("limit", &command.limits, "NAME=VALUE", limits_help()).repeated();
  rows.add("cors", &command.cors, "ORIGIN", "Web pages of this origin may ask; * for all");
  rows.add(
      "base-map", &command.base_map, "TEMPLATE",
      "Tiles of Web Mercator that the viewer lays over terrains when its user wants them, as "
      "https://tiles.example.org/{z}/{x}/{y}.png, or with {TileMatrix}, {TileCol} and "
      "{TileRow}; browsers fetch them, the service does not. Without it those that a file names "
      "(build --base-map); none: not those either");
  rows.add("base-map-attribution", &command.base_map_attribution, "TEXT",
           "Whom pages name where they show the base map; its host without it");
  rows.add("token-file", &command.token_file, "FILE",
           "Questions need the token of its first line, as Authorization: Bearer TOKEN, or once as "
           "?token=TOKEN in a browser");
  rows.add("metrics", &command.metrics, "WHO",
           "Who reads /metrics: open, token, closed; without it whoever may ask questions");
  rows.add("trusted-proxy", &command.trusted_proxies, "ADDRESS[/BITS]",
           "A proxy that is believed its X-Forwarded-For, -Proto, -Host and -Prefix, and "
           "Forwarded; may "
           "be given often")
      .repeated();
  rows.add("files", &command.offers_files, "", "Give out the files themselves, by ranges");
}

}  // namespace

Declared declare_serve(Context& context) { return declared<ServeCommand>(context, run_serve); }

}  // namespace ptin::tools
