// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/http_client.h"

#include <cctype>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace ptin::tools::testing {

namespace {

/// A test that fails waits for so long, and no other: a busy machine may stand still for seconds.
constexpr std::chrono::milliseconds kPatience{120000};

std::string lower_of(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_readable(int fd, std::chrono::milliseconds time) {
  pollfd poll{fd, POLLIN, 0};
  return ::poll(&poll, 1, static_cast<int>(time.count())) > 0;
}

}  // namespace

HttpClient::HttpClient(const std::string& address, const std::string& source)
    : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
  if (!source.empty()) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    ::inet_pton(AF_INET, source.c_str(), &own.sin_addr);
    if (::bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
      throw std::runtime_error("cannot connect from " + source);
    }
  }
  const std::size_t colon = address.rfind(':');
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1))));
  ::inet_pton(AF_INET, address.substr(0, colon).c_str(), &to.sin_addr);
  if (::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    throw std::runtime_error("cannot connect to " + address);
  }
}

HttpClient::~HttpClient() { close(); }

void HttpClient::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

void HttpClient::shrink_receiving() {
  const int bytes = 1;
  ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

void HttpClient::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;  // The server closed: what it answered is read all the same.
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

bool HttpClient::fill() {
  char bytes[65536];
  if (!is_readable(fd_, kPatience)) return false;
  const ssize_t got = ::recv(fd_, bytes, sizeof bytes, 0);
  if (got <= 0) return false;
  waiting_.append(bytes, static_cast<std::size_t>(got));
  return true;
}

std::optional<HttpAnswer> HttpClient::receive(bool has_body) {
  std::size_t end = 0;
  while ((end = waiting_.find("\r\n\r\n")) == std::string::npos) {
    if (!fill()) return std::nullopt;
  }
  HttpAnswer answer;
  answer.status = std::stoi(waiting_.substr(9, 3));
  for (std::size_t at = waiting_.find("\r\n") + 2; at < end + 2;) {
    const std::size_t line = waiting_.find("\r\n", at);
    const std::size_t colon = waiting_.find(": ", at);
    answer.headers[lower_of(waiting_.substr(at, colon - at))] =
        waiting_.substr(colon + 2, line - colon - 2);
    at = line + 2;
  }
  waiting_.erase(0, end + 4);
  if (answer.status == 100) return receive(has_body);
  const std::size_t bytes = has_body && answer.headers.count("content-length") != 0
                                ? std::stoull(answer.headers["content-length"])
                                : 0;
  while (waiting_.size() < bytes) {
    if (!fill()) return std::nullopt;
  }
  answer.body = waiting_.substr(0, bytes);
  waiting_.erase(0, bytes);
  return answer;
}

bool HttpClient::is_closed() {
  char bytes[4096];
  while (is_readable(fd_, kPatience)) {
    if (::recv(fd_, bytes, sizeof bytes, 0) <= 0) return true;
  }
  return false;
}

bool HttpClient::is_readable_within(std::chrono::milliseconds time) const {
  return is_readable(fd_, time);
}

HttpAnswer HttpClient::ask(const std::string& method, const std::string& target,
                           const std::string& headers, const std::string& body) {
  std::string text = method + " " + target + " HTTP/1.1\r\nHost: test\r\n" + headers;
  if (!body.empty()) text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  send(text + "\r\n" + body);
  std::optional<HttpAnswer> answer = receive(method != "HEAD");
  if (!answer) throw std::runtime_error("no answer to " + method + " " + target);
  return *answer;
}

bool comes_true(const std::function<bool()>& is_so) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!is_so()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

HttpAnswer first_answer(const std::string& address, int status, const std::string& request) {
  HttpAnswer wanted;
  static_cast<void>(comes_true([&] {
    HttpClient client(address);
    client.send(request);
    const auto answer = client.receive();
    if (answer && answer->status == status) wanted = *answer;
    return wanted.status == status;
  }));
  return wanted;
}

}  // namespace ptin::tools::testing
