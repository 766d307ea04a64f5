// SPDX-License-Identifier: GPL-3.0-or-later
//
// A service of small real terrains, asked over HTTP.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "tests/tools/http_client.h"
#include "tests/tools/program.h"
#include "tools/serve/terrain_service.h"

namespace ptin::tools::testing {

/// Options for files that were built: collections `mountains` and `coast`, on two threads.
[[nodiscard]] serve::ServeOptions serve_options(const TestFolder& folder);

/// The service, and a client of it.
class ServedTerrains {
 public:
  explicit ServedTerrains(serve::ServeOptions options)
      : service_(options, [this](const std::string& line) { note(line); }),
        running_(options.http, service_),
        client_(running_.address()) {
    service_.watch(&running_.server());
  }
  ~ServedTerrains() {
    running_.stop();
    service_.watch(nullptr);
  }

  HttpAnswer get(const std::string& target, const std::string& headers = {}) {
    return client_.get(target, headers);
  }
  HttpAnswer post(const std::string& target, const nlohmann::json& body) {
    return client_.ask("POST", target, "Content-Type: application/json\r\n", body.dump());
  }
  HttpAnswer ask(const std::string& method, const std::string& target, const std::string& headers,
                 const std::string& body) {
    return client_.ask(method, target, headers, body);
  }
  [[nodiscard]] const std::string& address() const { return running_.address(); }
  /// The lines of the log so far, as one text.
  [[nodiscard]] std::string log() const {
    const std::lock_guard lock(mutex_);
    return log_;
  }

 private:
  void note(const std::string& line) {
    const std::lock_guard lock(mutex_);
    log_.append(line).append("\n");
  }
  mutable std::mutex mutex_;
  std::string log_;
  serve::TerrainService service_;
  RunningServer running_;
  HttpClient client_;
};

/// A text as a value of a query.
[[nodiscard]] std::string encoded(const std::string& text);

}  // namespace ptin::tools::testing
