// SPDX-License-Identifier: GPL-3.0-or-later
//
// The service: requests become questions, questions answers, and each leaves a line in the log.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tools/http/metrics.h"
#include "tools/http/server.h"
#include "tools/http/service.h"
#include "tools/serve/access.h"
#include "tools/serve/answer_cache.h"
#include "tools/serve/catalogue.h"
#include "tools/serve/endpoint.h"
#include "tools/serve/serve_options.h"

namespace ptin::serve {

/// Takes a line without its end: standard error of the program, a string in tests.
using LogLine = std::function<void(const std::string& line)>;

/// A configuration that was read anew.
struct Reread {
  std::vector<ServedFile> files;
  /// Settings beside these that are others than when the service began, which count from its next start on.
  std::vector<std::string> changed;
};

class TerrainService : public http::Service {
 public:
  /// Opens every file.  @throws Error as Catalogue
  TerrainService(ServeOptions options, LogLine log);

  void enter(http::Request& request) const override;
  [[nodiscard]] bool is_quick(const http::Request& request) const override;
  void check(const http::Request& head) const override;
  [[nodiscard]] http::Needs needs(const http::Request& request) const override;
  [[nodiscard]] http::Response answer_quickly(const http::Request& request) override;
  [[nodiscard]] http::Response answer(const http::Request& request) override;
  [[nodiscard]] http::Response failure(const http::Request& request, std::exception_ptr thrown,
                                       http::GivenUp why) noexcept override;
  void finish(const http::Request& request, http::Response& response) override;
  void note(const http::Served& served) noexcept override;
  void rest() noexcept override;
  void bound_freed_memory() noexcept override;

  /// What load() is asked of; null while there is none.
  void watch(const http::Server* server) noexcept { server_ = server; }
  /// Answers from these files from now on, and writes a line of the log that says so; where they cannot be had
  /// all is as before, and the line says why. Threads: any, one at once.
  /// @param reread  May throw Error: the configuration is broken.
  void reload(const std::function<Reread()>& reread);
  /// From now on /readyz says no, so that a balancer sends nobody here.
  void begin_to_drain() noexcept { drains_ = true; }

 private:
  struct Match {
    const Endpoint* endpoint = nullptr;
    std::string id;
    std::string rest;
  };
  [[nodiscard]] Match match(const http::Request& request) const;
  [[nodiscard]] http::Response answer_endpoint(const http::Request& request, const Match& match);
  [[nodiscard]] http::Response compute(const http::Request& request, const Match& found,
                                       const std::shared_ptr<const Collection>& collection,
                                       const Question& question);
  [[nodiscard]] std::string cache_control_of(const Question& question,
                                             const Collection& collection) const;
  /// @param is_chosen  The header Accept chooses the form of the answer.
  [[nodiscard]] static http::Response unchanged(std::string etag, std::string cache_control,
                                                bool is_chosen);
  [[nodiscard]] std::string key_of(const http::Request& request, const Match& found,
                                   const Collection* collection, const Question& question) const;
  [[nodiscard]] std::shared_ptr<const Collection> collection_of(const Match& found) const;
  [[nodiscard]] http::Response ready() const;
  [[nodiscard]] http::Response metrics_text();
  [[nodiscard]] http::Response options_of(const http::Request& request) const;
  /// failure(), but for what it throws where there is no memory.
  [[nodiscard]] http::Response failure_told(const http::Request& request, std::exception_ptr thrown,
                                            http::GivenUp why);
  /// The answer to an error of the engine; the place of a file is told to the log alone.
  [[nodiscard]] http::Response failed(const http::Request& request, const Error& error,
                                      http::GivenUp why);
  void log(const nlohmann::ordered_json& line) const noexcept;

  ServeOptions options_;
  Access access_;
  LogLine log_;
  mutable http::Metrics metrics_;
  Catalogue catalogue_;
  AnswerCache cache_;
  const http::Server* server_ = nullptr;
  std::atomic<bool> drains_ = false;  ///< Set on the thread of signals.
};

}  // namespace ptin::serve
