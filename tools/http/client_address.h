// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whose request it is: the address of a connection, or what a proxy that is trusted says of it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/address.hpp>

namespace ptin::http {

/// Addresses that begin with the same bits.
struct Network {
  boost::asio::ip::address address;
  unsigned bits = 0;
};

/// "127.0.0.1", "10.0.0.0/8", "fd00::/8".  @throws Error invalid_argument
[[nodiscard]] Network parse_network(const std::string& text);

/// Addresses of version 4 within those of version 6 are the same ones.
[[nodiscard]] bool is_in(const std::vector<Network>& networks,
                         const boost::asio::ip::address& address);

/// The client of a request: who connects, or, where that is a trusted proxy, the last address of the
/// header X-Forwarded-For that is none. Anybody may have written what stands before it.
[[nodiscard]] boost::asio::ip::address client_of(const boost::asio::ip::address& connected,
                                                 std::string_view forwarded_for,
                                                 const std::vector<Network>& trusted);

/// Under this name a client has its share: of version 6 the 64 bits that one subscriber has.
[[nodiscard]] std::string share_of(const boost::asio::ip::address& address);

}  // namespace ptin::http
