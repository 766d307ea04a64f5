// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/client_address.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "engine/error.h"

namespace ptin::http {

namespace {

namespace ip = boost::asio::ip;

ip::address plain(const ip::address& address) {
  if (address.is_v6() && address.to_v6().is_v4_mapped()) {
    return ip::make_address_v4(ip::v4_mapped, address.to_v6());
  }
  return address;
}

template <class Bytes>
bool begin_alike(const Bytes& a, const Bytes& b, unsigned bits) {
  for (std::size_t i = 0; i < a.size() && bits > 0; ++i) {
    const unsigned here = std::min(bits, 8U);
    if (((a[i] ^ b[i]) >> (8U - here)) != 0) return false;
    bits -= here;
  }
  return true;
}

bool is_in(const Network& network, const ip::address& address) {
  if (network.address.is_v4() != address.is_v4()) return false;
  return address.is_v4() ? begin_alike(address.to_v4().to_bytes(),
                                       network.address.to_v4().to_bytes(), network.bits)
                         : begin_alike(address.to_v6().to_bytes(),
                                       network.address.to_v6().to_bytes(), network.bits);
}

/// "192.0.2.1", "192.0.2.1:4711", "2001:db8::1" or "[2001:db8::1]:4711".
std::optional<ip::address> address_in(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  if (text.starts_with('[')) {
    text = text.substr(1, text.find(']') - 1);
  } else if (std::count(text.begin(), text.end(), ':') == 1) {
    text = text.substr(0, text.find(':'));
  }
  boost::system::error_code status;
  const ip::address address = ip::make_address(std::string(text), status);
  if (status) return std::nullopt;
  return plain(address);
}

}  // namespace

Network parse_network(const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  boost::system::error_code status;
  Network network{plain(ip::make_address(text.substr(0, slash), status)), 0};
  const unsigned most = network.address.is_v4() ? 32 : 128;
  network.bits = most;
  bool is_one = !status;
  if (is_one && slash < text.size()) {
    const char* const end = text.data() + text.size();
    const auto [stopped, bad] = std::from_chars(text.data() + slash + 1, end, network.bits);
    is_one = bad == std::errc() && stopped == end && network.bits <= most;
  }
  if (!is_one) {
    refuse("not an address; expected ADDRESS or ADDRESS/BITS, as in 127.0.0.1 or 10.0.0.0/8", text);
  }
  return network;
}

bool is_in(const std::vector<Network>& networks, const ip::address& address) {
  const ip::address known = plain(address);
  return std::any_of(networks.begin(), networks.end(),
                     [&](const Network& network) { return is_in(network, known); });
}

ip::address client_of(const ip::address& connected, std::string_view forwarded_for,
                      const std::vector<Network>& trusted) {
  ip::address client = plain(connected);
  while (!forwarded_for.empty() && is_in(trusted, client)) {
    const std::size_t comma = forwarded_for.rfind(',');
    const bool is_last = comma == std::string_view::npos;
    const auto before = address_in(is_last ? forwarded_for : forwarded_for.substr(comma + 1));
    if (!before) break;  // A name, or "unknown": the proxy itself is all that is known.
    client = *before;
    forwarded_for = is_last ? std::string_view() : forwarded_for.substr(0, comma);
  }
  return client;
}

std::string share_of(const ip::address& address) {
  const ip::address known = plain(address);
  if (known.is_v4()) return known.to_string();
  auto bytes = known.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), static_cast<unsigned char>(0));
  return ip::make_address_v6(bytes).to_string() + "/64";
}

}  // namespace ptin::http
