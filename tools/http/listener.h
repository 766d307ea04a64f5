// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a server listens: an address of the network, or a socket in the file system.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <sys/types.h>

namespace ptin::http {

/// Listens from the beginning of its life. Used on one thread.
class Listener {
 public:
  using Protocol = boost::asio::generic::stream_protocol;
  using Acceptor = boost::asio::basic_socket_acceptor<Protocol>;

  /// @param address  "127.0.0.1:8080", "[::1]:8080", where port 0 lets the system choose one; or
  ///                 "unix:/run/ptin.sock", "unix:/run/ptin.sock,mode=660": a socket that those may open whom
  ///                 its mode lets (600 unless it is given). One that a service left behind is replaced.
  /// @throws Error invalid_argument  no such address; something else than a socket stands there
  ///               io_error          the system refuses it, or somebody listens there; names the address
  Listener(boost::asio::io_context& io, const std::string& address);
  /// Removes the socket of the file system, if it is still this one.
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  [[nodiscard]] Acceptor& acceptor() noexcept { return acceptor_; }
  /// "127.0.0.1:8080", "unix:/run/ptin.sock".
  [[nodiscard]] std::string address() const;
  /// Whether an address is a socket of the file system: whoever may open it is trusted as a proxy is.
  [[nodiscard]] static bool is_local(const std::string& address) noexcept {
    return address.starts_with("unix:");
  }
  /// Takes no connection from here on.
  void close();

 private:
  void remove_socket() noexcept;

  Acceptor acceptor_;
  std::string path_;  ///< Empty: an address of the network.
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace ptin::http
