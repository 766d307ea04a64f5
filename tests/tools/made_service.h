// SPDX-License-Identifier: GPL-3.0-or-later
//
// A service whose questions go on until they are released: what the tests of the server share.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "engine/error.h"
#include "tests/tools/http_client.h"
#include "tools/http/problem.h"
#include "tools/http/server.h"

namespace ptin::tools::testing {

using http::GivenUp;
using http::Limits;
using http::Problem;
using http::Request;
using http::Response;
using std::chrono::milliseconds;

inline Response text(std::string body) {
  Response response;
  response.content_type = "text/plain";
  response.body = std::move(body);
  return response;
}

/// Answers /echo with the body, /wait when it is released or stopped, /large with many bytes, /quick
/// beside the queue.
class MadeService : public http::Service {
 public:
  bool is_quick(const Request& request) const override {
    return !request.path.empty() && request.path[0] == "quick";
  }
  void check(const Request& head) const override {
    if (!head.path.empty() && head.path[0] == "forbidden") throw Problem(401, "nobody may");
  }
  http::Needs needs(const Request& request) const override {
    const std::string kind = request.path.size() > 1 ? request.path[1] : "";
    if (kind == "tile") return {http::Lane::kTile, 0};
    if (kind == "sweep") return {http::Lane::kSweep, sweep_bytes};
    return {};
  }
  Response answer_quickly(const Request&) override { return text("quick"); }
  Response answer(const Request& request) override {
    const std::string what = request.path.empty() ? "" : request.path[0];
    if (what == "echo") return text(request.method + " " + request.body);
    if (what == "large") return text(std::string(std::size_t{64} << 20, 'x'));
    if (what == "fault") throw std::runtime_error("a fault");
    if (what == "wait") wait(request);
    if (what == "file") return file();
    return text("answer");
  }
  Response failure(const Request&, std::exception_ptr thrown, GivenUp why) noexcept override {
    last_given_up = why;
    try {
      std::rethrow_exception(thrown);
    } catch (const Problem& problem) {
      return problem.response();
    } catch (const Error& error) {
      return Problem(error.code() == ErrorCode::cancelled ? 503 : 500, error.message()).response();
    } catch (...) {
      return Problem(500, "fault").response();
    }
  }
  void finish(const Request&, Response& response) override { response.add("X-Made", "yes"); }
  void bound_freed_memory() noexcept override { ++bounded; }
  void note(const http::Served& served) noexcept override {
    {
      const std::lock_guard lock(mutex_);
      remote_ = served.request.remote;
    }
    ++noted;
    if (served.response == nullptr) ++hung_up;
    if (!served.is_whole) ++cut;
  }

  std::uint64_t sweep_bytes = 0;
  std::atomic<bool> is_released{false};
  std::atomic<int> waiting{0}, stopped{0}, noted{0}, hung_up{0}, cut{0}, bounded{0};
  std::atomic<GivenUp> last_given_up{GivenUp::kNot};

  [[nodiscard]] std::string last_remote() const {
    const std::lock_guard lock(mutex_);
    return remote_;
  }

 private:
  /// A file of 300 000 bytes, whose first piece comes when it is released.
  Response file() {
    Response response;
    response.content_type = "application/octet-stream";
    response.long_body = std::make_shared<http::LongBody>();
    response.long_body->bytes = 300000;
    response.long_body->read = [this](std::uint64_t, std::span<char> into) {
      ++waiting;
      while (!is_released) std::this_thread::sleep_for(milliseconds(1));
      --waiting;
      std::fill(into.begin(), into.end(), 'f');
    };
    return response;
  }
  void wait(const Request& request) {
    ++waiting;
    while (!is_released && !request.stop.stop_requested()) {
      std::this_thread::sleep_for(milliseconds(1));
    }
    --waiting;
    if (!request.stop.stop_requested()) return;
    ++stopped;
    throw Error(ErrorCode::cancelled, "stopped");
  }

  mutable std::mutex mutex_;
  std::string remote_;
};

/// Few of everything, and time for all of it.
inline Limits small_limits() {
  Limits limits = unhurried_limits();
  limits.threads = 2;
  limits.waiting = 1;
  limits.connections = 8;
  return limits;
}

}  // namespace ptin::tools::testing
