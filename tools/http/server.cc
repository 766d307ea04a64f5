// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/server.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <new>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "engine/error.h"
#include "tools/http/admission.h"
#include "tools/http/connection.h"
#include "tools/http/listener.h"
#include "tools/http/turns.h"

namespace ptin::http {

namespace {

using boost::asio::ip::tcp;
using Socket = Listener::Protocol::socket;
using Status = boost::system::error_code;

/// How long nothing is accepted after the system refused a connection, and none could be closed.
constexpr std::chrono::milliseconds kPause{20};
/// Connections beyond the limit: they are answered what is quick, or told that there are too many.
constexpr std::size_t kMostExtra = 16;

/// Points keep what all of their threads take, as far as there is room beside one whole question.
/// Bodies have a sixth, but room for some at least; answers what is left beside all of these, but a
/// quarter at least.
MemoryParts parts_of(const Limits& limits) {
  const auto without = [](std::uint64_t all, std::uint64_t part) {
    return all - std::min(all, part);
  };
  MemoryParts parts;
  parts.kept = limits.kept_bytes;
  parts.all = without(limits.memory_bytes, parts.kept);
  parts.points =
      std::min(limits.threads * limits.point_bytes, without(parts.all, limits.question_bytes));
  parts.most_bodies = std::max<std::uint64_t>(parts.all / 6, std::uint64_t{4} * limits.body_bytes);
  parts.most_answers = std::max(
      parts.all / 4, without(parts.all, parts.points + parts.most_bodies + limits.question_bytes));
  return parts;
}

Admission::Sizes sizes_of(const Limits& limits) {
  return {limits.threads, limits.waiting, parts_of(limits)};
}

/// Whoever may open a socket of the file system is trusted as a proxy: such a client has the address 0.0.0.0.
Limits with_local_proxy(Limits limits, bool is_local) {
  if (is_local) limits.trusted_proxies.push_back({boost::asio::ip::address_v4(), 32});
  return limits;
}

}  // namespace

struct Server::Inside {
  Inside(const std::string& address, const Limits& limits_given, Service& service)
      : limits(with_local_proxy(limits_given, Listener::is_local(address))),
        host{limits, service, admission, turns},
        turns(io.get_executor()),
        listener(io, address),
        pause(io),
        until_end(io),
        admission(
            sizes_of(limits), [&service] { service.rest(); },
            [&service] { service.bound_freed_memory(); }) {}

  ~Inside() {
    for (const auto& connection : all()) connection->abort();
  }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

  void accept() {
    listener.acceptor().async_accept([this](const Status& status, Socket socket) {
      if (!listener.acceptor().is_open()) return;
      if (status) {
        // A new connection without a descriptor gets that of one who waits for nothing.
        if (close_a_waiting_one([](const Connection&) { return true; })) return accept();
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

  void take(Socket socket) {
    Status ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    const auto made =
        std::make_shared<Connection>(std::move(socket), host, [this](Connection* c) { forget(c); });
    const bool is_extra = !has_room_for(*made);
    if (is_extra && extras >= kMostExtra) {
      close_a_waiting_one([](const Connection& one) { return one.is_extra(); });
      if (extras >= kMostExtra) return;
    }
    connections[made.get()] = made;
    open = connections.size();
    is_extra ? ++extras : ++of_peer[made->peer()];
    made->start(is_extra);
  }

  void forget(Connection* connection) {
    if (connections.erase(connection) == 0) return;
    open = connections.size();
    if (connection->is_extra()) {
      --extras;
    } else if (const auto peer = of_peer.find(connection->peer());
               peer != of_peer.end() && --peer->second == 0) {
      of_peer.erase(peer);
    }
    if (is_ending && connections.empty()) io.stop();
  }

  /// Whether a connection is one of those that the server takes; where there are many, the longest
  /// idle one is closed for it.
  bool has_room_for(const Connection& made) {
    const auto peer = of_peer.find(made.peer());
    const std::size_t own = peer == of_peer.end() ? 0 : peer->second;
    const std::size_t now = connections.size() - extras;
    const bool is_last_quarter = now >= limits.connections - limits.connections / 4;
    const bool has_its_share = !made.is_of_proxy() && is_last_quarter &&
                               own >= std::max<std::size_t>(1, limits.connections / 8);
    if (now < limits.connections && !has_its_share) return true;
    if (has_its_share) {
      return close_a_waiting_one(
          [&](const Connection& one) { return !one.is_extra() && one.peer() == made.peer(); });
    }
    return close_a_waiting_one([](const Connection& one) { return !one.is_extra(); });
  }

  /// Closes, of those that may be closed and wait for a request, the one that has waited longest
  /// among the connections of the client that has most.
  template <class MayBe>
  bool close_a_waiting_one(const MayBe& may_be) {
    std::shared_ptr<Connection> chosen;
    std::size_t most = 0;
    for (const auto& connection : all()) {
      const auto since = connection->waits_since();
      if (!since || !may_be(*connection)) continue;
      const auto peer = of_peer.find(connection->peer());
      const std::size_t has = peer == of_peer.end() ? 0 : peer->second;
      if (chosen && (has < most || (has == most && *since >= *chosen->waits_since()))) continue;
      chosen = connection;
      most = has;
    }
    if (chosen) chosen->abort();
    return chosen != nullptr;
  }

  void drain() {
    if (is_ending) return;
    if (host.drains || limits.draining.count() == 0) return end();
    host.drains = true;
    until_end.expires_after(limits.draining);
    until_end.async_wait([this](const Status& stopped) {
      if (!stopped) end();
    });
  }

  void end() {
    host.drains = is_ending = true;
    listener.close();
    for (const auto& connection : all()) connection->finish();
    if (connections.empty()) return io.stop();
    until_end.expires_after(limits.queueing + limits.computing + limits.writing);
    until_end.async_wait([this](const Status& stopped) {
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
  std::atomic<std::size_t> open{0};                      ///< Their number; other threads ask.
  std::unordered_map<std::string, std::size_t> of_peer;  ///< Connections, but for those beyond.
  std::size_t extras = 0;
  bool is_ending = false;
  ConnectionHost host;
  boost::asio::io_context io{1};
  Turns turns;  // Those that wait in it are connections, whose sockets are the context's.
  Listener listener;
  boost::asio::steady_timer pause, until_end;
  Admission admission;
};

Server::Server(const std::string& address, const Limits& limits, Service& service)
    : inside_(std::make_unique<Inside>(address, limits, service)) {}

Server::~Server() = default;

std::string Server::address() const { return inside_->listener.address(); }

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
  return {inside_->open, inside_->admission.waiting(), inside_->admission.running(),
          inside_->admission.memory()->lent()};
}

}  // namespace ptin::http
