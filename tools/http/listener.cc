// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/listener.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string_view>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/error.h"

namespace ptin::http {

namespace {

using boost::asio::ip::tcp;
using Local = boost::asio::local::stream_protocol;
using ListenStatus = boost::system::error_code;

constexpr std::string_view kUnix = "unix:";

tcp::endpoint endpoint_of(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  const char* const wanted =
      "; expected ADDRESS:PORT, as in 127.0.0.1:8080 or [::1]:8080, or unix:/PATH";
  if (colon == std::string::npos) refuse("the address has no port" + std::string(wanted), address);
  std::string host = address.substr(0, colon);
  if (host.size() > 1 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  if (host == "localhost") host = "127.0.0.1";
  std::uint16_t port = 0;
  const char* const end = address.data() + address.size();
  const auto [stopped, bad_port] = std::from_chars(address.data() + colon + 1, end, port);
  ListenStatus status;
  const auto ip = boost::asio::ip::make_address(host, status);
  if (status || bad_port != std::errc() || stopped != end) {
    refuse("not an address to listen on" + std::string(wanted), address);
  }
  return {ip, port};
}

struct SocketFile {
  std::string path;
  mode_t mode = 0600;
};

/// Of "unix:/run/ptin.sock,mode=660".
SocketFile socket_file_of(const std::string& address) {
  SocketFile file{address.substr(kUnix.size())};
  constexpr std::string_view kMode = ",mode=";
  if (const std::size_t at = file.path.rfind(kMode); at != std::string::npos) {
    const std::string digits = file.path.substr(at + kMode.size());
    const char* const end = digits.data() + digits.size();
    unsigned mode = 0;
    const auto [stopped, bad] = std::from_chars(digits.data(), end, mode, 8);
    if (bad != std::errc() || stopped != end || mode > 0777) {
      refuse("the mode of the socket is none; expected octal digits, as in unix:/PATH,mode=660",
             address);
    }
    file.mode = mode;
    file.path.resize(at);
  }
  if (!file.path.starts_with('/') || file.path.size() >= sizeof(sockaddr_un{}.sun_path)) {
    refuse("a socket has a path from the root of at most " +
               std::to_string(sizeof(sockaddr_un{}.sun_path) - 1) + " bytes, as in unix:/PATH",
           address);
  }
  return file;
}

/// Removes a socket that nobody listens on any more.
void remove_left_socket(boost::asio::io_context& io, const SocketFile& file,
                        const std::string& address) {
  struct stat facts {};
  if (::lstat(file.path.c_str(), &facts) != 0) return;
  if (!S_ISSOCK(facts.st_mode)) {
    refuse("something else than a socket stands under this path; choose another one", address);
  }
  Local::socket socket(io);
  ListenStatus status;
  socket.connect(Local::endpoint(file.path), status);
  if (status != boost::asio::error::connection_refused) {
    throw Error(ErrorCode::io_error,
                status ? "cannot tell whether somebody listens there: " + status.message()
                       : "somebody listens there already",
                address);
  }
  if (::unlink(file.path.c_str()) != 0) throw system_error(errno, "cannot remove", address);
}

/// Binds to a socket that nobody may open before it has its mode.
void bind_with_mode(Listener::Acceptor& acceptor, const SocketFile& file, ListenStatus& status) {
  const mode_t before = ::umask(0777 & ~file.mode);
  acceptor.bind(Local::endpoint(file.path), status);
  ::umask(before);
}

}  // namespace

Listener::Listener(boost::asio::io_context& io, const std::string& address) : acceptor_(io) {
  ListenStatus status;
  if (address.starts_with(kUnix)) {
    const SocketFile file = socket_file_of(address);
    remove_left_socket(io, file, address);
    acceptor_.open(Local(), status);
    if (!status) bind_with_mode(acceptor_, file, status);
    struct stat facts {};
    if (!status && ::lstat(file.path.c_str(), &facts) == 0) {
      path_ = file.path;
      device_ = facts.st_dev;
      inode_ = facts.st_ino;
    }
  } else {
    const tcp::endpoint endpoint = endpoint_of(address);
    acceptor_.open(endpoint.protocol(), status);
    if (!status) acceptor_.set_option(boost::asio::socket_base::reuse_address(true), status);
    if (!status) acceptor_.bind(endpoint, status);
  }
  if (!status) acceptor_.listen(boost::asio::socket_base::max_listen_connections, status);
  if (!status) return;
  remove_socket();
  throw system_error(status.value(), "cannot listen on", address);
}

Listener::~Listener() { remove_socket(); }

std::string Listener::address() const {
  if (!path_.empty()) return std::string(kUnix) + path_;
  const auto end = acceptor_.local_endpoint();
  tcp::endpoint of_ip;
  std::memcpy(of_ip.data(), end.data(), std::min(end.size(), of_ip.capacity()));
  const std::string host = of_ip.address().to_string();
  return (of_ip.address().is_v6() ? "[" + host + "]" : host) + ":" + std::to_string(of_ip.port());
}

void Listener::close() {
  ListenStatus ignored;
  acceptor_.close(ignored);
  remove_socket();
}

void Listener::remove_socket() noexcept {
  struct stat facts {};
  const bool is_ours = !path_.empty() && ::lstat(path_.c_str(), &facts) == 0 &&
                       facts.st_dev == device_ && facts.st_ino == inode_;
  if (is_ours) ::unlink(path_.c_str());
}

}  // namespace ptin::http
