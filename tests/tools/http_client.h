// SPDX-License-Identifier: GPL-3.0-or-later
//
// A client of HTTP that does what it is told, byte by byte, also what no client should.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include <nlohmann/json.hpp>

#include "tools/http/server.h"

namespace ptin::tools::testing {

/// Longer than any machine takes: a deadline that no test reaches but those that shorten it.
inline constexpr std::chrono::milliseconds kUnhurried{600000};
[[nodiscard]] inline http::Limits unhurried_limits() {
  http::Limits limits;
  limits.reading = limits.queueing = limits.computing = kUnhurried;
  limits.writing = limits.idle = kUnhurried;
  return limits;
}

struct HttpAnswer {
  int status = 0;
  std::map<std::string, std::string> headers;  ///< Names in lower case.
  std::string body;

  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(body); }
  [[nodiscard]] std::string header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? std::string() : found->second;
  }
};

/// One connection. What fails throws std::runtime_error.
class HttpClient {
 public:
  /// @param address  "127.0.0.1:8080".
  /// @param source  Its own address, as 127.0.0.2; empty: the system's choice.
  explicit HttpClient(const std::string& address, const std::string& source = {});
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  void send(std::string_view bytes);
  /// The next answer; none where the server closes first, or sends nothing for two minutes.
  [[nodiscard]] std::optional<HttpAnswer> receive(bool has_body = true);
  /// Waits until the server closes; false where it does not within two minutes.
  [[nodiscard]] bool is_closed();
  /// Whether there is something to receive by then.
  [[nodiscard]] bool is_readable_within(std::chrono::milliseconds time) const;
  void close();
  /// Takes as little as the system allows into its own buffer.
  void shrink_receiving();

  /// Sends a request and takes the answer.
  HttpAnswer ask(const std::string& method, const std::string& target,
                 const std::string& headers = {}, const std::string& body = {});
  HttpAnswer get(const std::string& target, const std::string& headers = {}) {
    return ask("GET", target, headers);
  }

 private:
  [[nodiscard]] bool fill();
  int fd_ = -1;
  std::string waiting_;
};

/// A server that runs on a thread of its own until the object goes.
class RunningServer {
 public:
  RunningServer(const http::Limits& limits, http::Service& service)
      : server_("127.0.0.1:0", limits, service), thread_([this] { server_.run(); }) {}
  ~RunningServer() { stop(); }
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;

  void stop() {
    if (!thread_.joinable()) return;
    server_.drain();
    thread_.join();
  }
  [[nodiscard]] const std::string& address() const { return address_; }
  [[nodiscard]] http::Server& server() { return server_; }

 private:
  http::Server server_;
  std::string address_ = server_.address();
  std::thread thread_;
};

/// Waits until `is_so`, for two minutes at most.
[[nodiscard]] bool comes_true(const std::function<bool()>& is_so);

/// The first answer of this status to a request that is sent again and again, each time by a new
/// connection: where a deadline is short, a busy machine may miss it sooner than the test means.
/// None within two minutes: an empty one.
[[nodiscard]] HttpAnswer first_answer(const std::string& address, int status,
                                      const std::string& request);

}  // namespace ptin::tools::testing
