// SPDX-License-Identifier: GPL-3.0-or-later
//
// serve_load: an open-loop load for `ptin serve`.
//
// usage: serve_load ADDRESS RATE SECONDS CONNECTIONS TARGETS
//
// Sends GET requests for the lines of the file TARGETS, one after the other and again, RATE a second,
// whatever the answers do. A request whose time has come waits for a free connection; its latency
// counts from the time at which it was due, so that a server that stalls is not measured by the few
// requests that it let through (coordinated omission). Prints one line of JSON: rate reached,
// percentiles in milliseconds, answers by status, bytes.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace {

using Clock = std::chrono::steady_clock;

struct Load {
  std::string address;
  double rate = 0;
  double seconds = 0;
  std::size_t connections = 0;
  std::vector<std::string> requests;
};

struct Connection {
  int fd = -1;
  bool is_asked = false;
  Clock::time_point due;
  std::string received;
  std::size_t wanted = 0;  ///< Bytes of the whole answer; 0: its head is not whole yet.
};

struct Tally {
  std::vector<double> milliseconds;
  std::map<int, std::uint64_t> statuses;
  std::uint64_t bytes = 0;
};

int connected(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1))));
  ::inet_pton(AF_INET, address.substr(0, colon).c_str(), &to.sin_addr);
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  const int one = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    throw std::runtime_error("cannot connect to " + address);
  }
  ::fcntl(fd, F_SETFL, O_NONBLOCK);
  return fd;
}

class Generator {
 public:
  explicit Generator(const Load& load) : load_(load), epoll_(::epoll_create1(0)) {
    all_.resize(load.connections);
    for (std::size_t i = 0; i < all_.size(); ++i) {
      connect(i);
      idle_.push_back(i);
    }
  }

  Tally run() {
    const auto begin = Clock::now();
    const auto total = static_cast<std::uint64_t>(load_.rate * load_.seconds);
    std::uint64_t due = 0, answered = 0;
    while (answered < total) {
      const double now = std::chrono::duration<double>(Clock::now() - begin).count();
      for (; due < total && static_cast<double>(due) / load_.rate <= now; ++due) {
        waiting_.push_back(
            begin + std::chrono::duration_cast<Clock::duration>(
                        std::chrono::duration<double>(static_cast<double>(due) / load_.rate)));
      }
      while (!waiting_.empty() && !idle_.empty()) send_one();
      answered += take_answers();
      if (now > 3 * load_.seconds + 10) throw std::runtime_error("the server does not keep up");
    }
    return std::move(tally_);
  }

 private:
  void connect(std::size_t i) {
    all_[i] = {};
    all_[i].fd = connected(load_.address);
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.u64 = i;
    ::epoll_ctl(epoll_, EPOLL_CTL_ADD, all_[i].fd, &event);
  }

  void send_one() {
    Connection& c = all_[idle_.back()];
    idle_.pop_back();
    c.is_asked = true;
    c.due = waiting_.front();
    waiting_.pop_front();
    const std::string& request = load_.requests[next_++ % load_.requests.size()];
    if (::send(c.fd, request.data(), request.size(), MSG_NOSIGNAL) !=
        static_cast<ssize_t>(request.size())) {
      throw std::runtime_error("a request was not taken");
    }
  }

  std::uint64_t take_answers() {
    std::array<epoll_event, 256> events{};
    const int n = ::epoll_wait(epoll_, events.data(), static_cast<int>(events.size()), 0);
    std::uint64_t answered = 0;
    for (int i = 0; i < n; ++i) {
      const std::size_t number = events[static_cast<std::size_t>(i)].data.u64;
      if (!all_[number].is_asked) {  // It was idle for too long for the server.
        ::close(all_[number].fd);
        connect(number);
        continue;
      }
      if (receive(all_[number])) {
        idle_.push_back(number);
        ++answered;
      }
    }
    return answered;
  }

  /// @return True once the answer is whole.
  bool receive(Connection& c) {
    std::array<char, 65536> bytes{};
    const ssize_t got = ::recv(c.fd, bytes.data(), bytes.size(), 0);
    if (got <= 0) throw std::runtime_error("the server closed a connection");
    c.received.append(bytes.data(), static_cast<std::size_t>(got));
    if (c.wanted == 0) {
      const std::size_t end = c.received.find("\r\n\r\n");
      if (end == std::string::npos) return false;
      const std::size_t length = c.received.find("Content-Length: ");
      c.wanted = end + 4 + (length < end ? std::stoull(c.received.substr(length + 16)) : 0);
    }
    if (c.received.size() < c.wanted) return false;
    ++tally_.statuses[std::stoi(c.received.substr(9, 3))];
    tally_.bytes += c.received.size();
    tally_.milliseconds.push_back(
        std::chrono::duration<double, std::milli>(Clock::now() - c.due).count());
    c.is_asked = false;
    c.received.clear();
    c.wanted = 0;
    return true;
  }

  const Load& load_;
  int epoll_;
  std::vector<Connection> all_;
  std::vector<std::size_t> idle_;
  std::deque<Clock::time_point> waiting_;
  std::size_t next_ = 0;
  Tally tally_;
};

Load load_of(char** arguments) {
  Load load{arguments[1],
            std::atof(arguments[2]),
            std::atof(arguments[3]),
            static_cast<std::size_t>(std::atoi(arguments[4])),
            {}};
  std::ifstream in(arguments[5]);
  for (std::string line; std::getline(in, line);) {
    load.requests.push_back("GET " + line + " HTTP/1.1\r\nHost: " + load.address + "\r\n\r\n");
  }
  if (load.requests.empty()) throw std::runtime_error("no targets in the file");
  return load;
}

void print(Tally& tally, double seconds) {
  if (tally.milliseconds.empty())
    throw std::runtime_error("nothing was asked: give a higher rate, or more time");
  std::sort(tally.milliseconds.begin(), tally.milliseconds.end());
  const auto at = [&](double share) {
    const double last = static_cast<double>(tally.milliseconds.size() - 1);
    return tally.milliseconds[static_cast<std::size_t>(share * last)];
  };
  std::printf(
      "{\"answers\": %zu, \"seconds\": %.2f, \"a_second\": %.0f, \"ms\": {\"50\": %.3f, "
      "\"95\": %.3f, \"99\": %.3f, \"99.9\": %.3f, \"100\": %.3f}, \"bytes\": %llu, "
      "\"statuses\": {",
      tally.milliseconds.size(), seconds, static_cast<double>(tally.milliseconds.size()) / seconds,
      at(0.5), at(0.95), at(0.99), at(0.999), at(1.0),
      static_cast<unsigned long long>(tally.bytes));
  const char* comma = "";
  for (const auto& [status, count] : tally.statuses) {
    std::printf("%s\"%d\": %llu", comma, status, static_cast<unsigned long long>(count));
    comma = ", ";
  }
  std::printf("}}\n");
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 6) {
    std::fprintf(stderr, "usage: serve_load ADDRESS RATE SECONDS CONNECTIONS TARGETS\n");
    return 2;
  }
  const Load load = load_of(arguments);
  Generator generator(load);
  const auto begin = Clock::now();
  Tally tally = generator.run();
  print(tally, std::chrono::duration<double>(Clock::now() - begin).count());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "serve_load: %s\n", error.what());
  return 1;
}
