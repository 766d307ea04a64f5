// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body that takes memory as it arrives, and not when it is announced.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/optional.hpp>

namespace ptin::http {

/// A body type of Beast's. The text grows within its capacity alone: whoever reads makes room first.
struct GrowingBody {
  struct value_type {
    std::string text;
    bool is_dropped = false;  ///< Bytes that arrive are not kept.
    std::uint64_t arrived = 0;
  };

  class reader {
   public:
    template <bool is_request, class Fields>
    reader(boost::beast::http::header<is_request, Fields>&, value_type& body) : body_(body) {}

    void init(const boost::optional<std::uint64_t>&, boost::system::error_code& status) {
      status = {};
    }
    template <class Buffers>
    std::size_t put(const Buffers& buffers, boost::system::error_code& status) {
      status = {};
      const std::size_t arrived = boost::asio::buffer_size(buffers);
      if (body_.is_dropped) {
        body_.arrived += arrived;
        return arrived;
      }
      const std::size_t room = body_.text.capacity() - body_.text.size();
      const std::size_t taken = std::min(arrived, room);
      if (taken == 0 && arrived > 0) {
        status = boost::beast::http::error::need_buffer;
        return 0;
      }
      body_.arrived += taken;
      const std::size_t before = body_.text.size();
      body_.text.resize(before + taken);
      boost::asio::buffer_copy(boost::asio::buffer(body_.text.data() + before, taken), buffers);
      return taken;
    }
    void finish(boost::system::error_code& status) { status = {}; }

   private:
    value_type& body_;
  };
};

}  // namespace ptin::http
