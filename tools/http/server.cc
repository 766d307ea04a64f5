// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/server.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <new>
#include <unordered_map>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "engine/error.h"
#include "tools/http/connection.h"
#include "tools/http/turns.h"
#include "tools/http/worker_pool.h"

namespace ptin::http {

namespace {

using boost::asio::ip::tcp;
using Status = boost::system::error_code;

/// How long nothing is accepted after the system refused a connection: it has no descriptors left.
constexpr std::chrono::milliseconds kPause{100};

tcp::endpoint endpoint_of(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  const char* const wanted = "; expected ADDRESS:PORT, as in 127.0.0.1:8080 or [::1]:8080";
  if (colon == std::string::npos) refuse("the address has no port" + std::string(wanted), address);
  std::string host = address.substr(0, colon);
  if (host.size() > 1 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  if (host == "localhost") host = "127.0.0.1";
  std::uint16_t port = 0;
  const char* const end = address.data() + address.size();
  const auto [stopped, bad_port] = std::from_chars(address.data() + colon + 1, end, port);
  Status status;
  const auto ip = boost::asio::ip::make_address(host, status);
  if (status || bad_port != std::errc() || stopped != end) {
    refuse("not an address to listen on" + std::string(wanted), address);
  }
  return {ip, port};
}

}  // namespace

struct Server::Inside {
  Inside(const std::string& address, const Limits& limits_given, Service& service)
      : limits(limits_given),
        host{limits, service, pool,
             std::make_shared<MemoryBudget>(std::max<std::uint64_t>(
                 limits.memory_bytes / 6, std::uint64_t{4} * limits.body_bytes)),
             turns},
        turns(io.get_executor()),
        acceptor(io),
        pause(io),
        pool(limits.threads, limits.waiting) {
    const tcp::endpoint endpoint = endpoint_of(address);
    Status status;
    acceptor.open(endpoint.protocol(), status);
    if (!status) acceptor.set_option(tcp::acceptor::reuse_address(true), status);
    if (!status) acceptor.bind(endpoint, status);
    if (!status) acceptor.listen(boost::asio::socket_base::max_listen_connections, status);
    if (status) throw system_error(status.value(), "cannot listen on", address);
  }

  void accept() {
    acceptor.async_accept([this](const Status& status, tcp::socket socket) {
      if (!acceptor.is_open()) return;
      if (status) {
        pause.expires_after(kPause);
        pause.async_wait([this](const Status& stopped) {
          if (!stopped) accept();
        });
        return;
      }
      try {
        take(std::move(socket));
      } catch (const std::bad_alloc&) {
        // This client is turned away without a word; the next one is accepted all the same.
      }
      accept();
    });
  }

  void take(tcp::socket socket) {
    Status ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    const bool is_full = connections.size() >= limits.connections;
    // Those that are turned away are held for a moment too; beyond a few of them the door shuts.
    if (connections.size() >= limits.connections + 16) return;
    const auto made = std::make_shared<Connection>(std::move(socket), host, [this](Connection* c) {
      connections.erase(c);
      if (host.drains && connections.empty()) io.stop();
    });
    connections[made.get()] = made;
    if (!is_full) return made->start();
    made->turn_away(Problem(503, "the server has as many connections as it takes; come again later")
                        .beyond("connections")
                        .retry_after(1));
  }

  void drain() {
    if (host.drains) return;
    host.drains = true;
    Status ignored;
    acceptor.close(ignored);
    for (const auto& connection : all()) connection->drain();
    if (connections.empty()) return io.stop();
    pause.expires_after(limits.computing + limits.writing);
    pause.async_wait([this](const Status& stopped) {
      if (stopped) return;
      for (const auto& connection : all()) connection->abort();
      io.stop();
    });
  }

  /// A copy: a connection that closes leaves the table.
  [[nodiscard]] std::vector<std::shared_ptr<Connection>> all() const {
    std::vector<std::shared_ptr<Connection>> copy;
    for (const auto& [key, connection] : connections) {
      if (auto alive = connection.lock()) copy.push_back(std::move(alive));
    }
    return copy;
  }

  // The order in which they go, the last one first: threads that compute hold connections, and
  // connections that the context lets go use what stands above it.
  Limits limits;
  std::unordered_map<Connection*, std::weak_ptr<Connection>> connections;
  ConnectionHost host;
  boost::asio::io_context io{1};
  Turns turns;  // Those that wait in it are connections, whose sockets are the context's.
  tcp::acceptor acceptor;
  boost::asio::steady_timer pause;
  WorkerPool pool;
};

Server::Server(const std::string& address, const Limits& limits, Service& service)
    : inside_(std::make_unique<Inside>(address, limits, service)) {}

Server::~Server() = default;

std::string Server::address() const {
  const tcp::endpoint end = inside_->acceptor.local_endpoint();
  const std::string host = end.address().to_string();
  return (end.address().is_v6() ? "[" + host + "]" : host) + ":" + std::to_string(end.port());
}

void Server::run() {
  inside_->accept();
  while (true) {
    try {
      inside_->io.run();
      return;
    } catch (const std::bad_alloc&) {
      // The connection that was refused memory is gone; the others go on.
    }
  }
}

void Server::drain() {
  boost::asio::post(inside_->io, [inside = inside_.get()] { inside->drain(); });
}

ServerLoad Server::load() const {
  return {inside_->connections.size(), inside_->pool.waiting(), inside_->pool.running()};
}

}  // namespace ptin::http
