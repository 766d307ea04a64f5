// SPDX-License-Identifier: GPL-3.0-or-later
//
// A server of HTTP/1.1: one thread for connections, several that compute, limits on everything a
// client can do. TLS and HTTP/2 are a proxy's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "tools/http/limits.h"
#include "tools/http/service.h"

namespace ptin::http {

/// What a server does now.
struct ServerLoad {
  std::size_t connections = 0, waiting = 0, computing = 0;
  std::uint64_t memory_bytes = 0;  ///< Lent to bodies, questions and answers.
};

class Server {
 public:
  /// Listens from here on; run() answers.
  /// @param address  As Listener takes it: "127.0.0.1:8080", "[::1]:8080", "unix:/run/ptin.sock".
  /// @throws Error as Listener
  Server(const std::string& address, const Limits& limits, Service& service);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// The address that is listened on, "127.0.0.1:8080".
  [[nodiscard]] std::string address() const;

  /// Answers on the calling thread, until drain() was called and every request at hand was
  /// answered, or was given up.
  void run();

  /// Takes no further question. New connections are told so for the time of `draining`, then none is
  /// taken; what is at hand is finished, within the limits of queueing, computing and writing. Called
  /// again, it takes no connection from then on. May be
  /// called from any thread, not from a signal handler.
  void drain();

  /// Threads: any.
  [[nodiscard]] ServerLoad load() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace ptin::http
