// SPDX-License-Identifier: GPL-3.0-or-later
//
// The web server of tests/support/range_server.py, which counts and misbehaves.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace ptin::test {

/// Serves a folder until it goes; it ends with this process too.
class RangeServer {
 public:
  static constexpr const char* kNeeded = "needs python3";
  [[nodiscard]] static bool is_possible() {
    return std::system("python3 -c '' > /dev/null 2>&1") == 0;
  }

  explicit RangeServer(const std::string& folder, const std::string& delay = "0") {
    int to_server[2];
    int from_server[2];
    if (::pipe2(to_server, O_CLOEXEC) != 0 || ::pipe2(from_server, O_CLOEXEC) != 0) {
      throw std::runtime_error("no pipes for the range server");
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, to_server[0], 0);
    posix_spawn_file_actions_adddup2(&actions, from_server[1], 1);
    std::vector<std::string> words{"python3", PTIN_RANGE_SERVER, folder, "--delay", delay};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int fault =
        ::posix_spawnp(&process_, "python3", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(to_server[0]);
    ::close(from_server[1]);
    input_ = to_server[1];
    std::FILE* const lines = ::fdopen(from_server[0], "r");
    if (fault != 0 || lines == nullptr || std::fscanf(lines, "%d", &port_) != 1) {
      throw std::runtime_error("the range server does not start");
    }
    std::fclose(lines);
  }
  RangeServer(const RangeServer&) = delete;
  RangeServer& operator=(const RangeServer&) = delete;
  ~RangeServer() {
    ::close(input_);
    ::waitpid(process_, nullptr, 0);
  }

  [[nodiscard]] int port() const { return port_; }
  /// @param path  "plain/dem.ptin": how it behaves, and the file.
  [[nodiscard]] std::string url(const std::string& path) const {
    return "http://127.0.0.1:" + std::to_string(port_) + "/" + path;
  }

  struct Counts {
    std::uint64_t requests = 0, bytes = 0, most = 0;
    std::vector<std::string> ranges;
  };
  /// Since the last call, or the start.
  Counts take_counts() const {
    const auto json = nlohmann::json::parse(get("/reset"));
    return {json["requests"], json["bytes"], json["most"], json["ranges"]};
  }

 private:
  /// The body of an answer.
  [[nodiscard]] std::string get(const std::string& path) const {
    const int connection = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const std::string request = "GET " + path + " HTTP/1.1\r\nHost: t\r\nConnection: close\r\n\r\n";
    std::string answer;
    if (::connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
        ::write(connection, request.data(), request.size()) ==
            static_cast<ssize_t>(request.size())) {
      char part[4096];
      for (ssize_t n = 0; (n = ::read(connection, part, sizeof part)) > 0;) {
        answer.append(part, static_cast<std::size_t>(n));
      }
    }
    ::close(connection);
    return answer.substr(answer.find("\r\n\r\n") + 4);
  }

  pid_t process_ = 0;
  int input_ = -1;
  int port_ = 0;
};

}  // namespace ptin::test
