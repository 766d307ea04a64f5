// SPDX-License-Identifier: GPL-3.0-or-later
//
// One client: requests in, answers out, each within its time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>

#include "tools/http/admission.h"
#include "tools/http/growing_body.h"
#include "tools/http/limits.h"
#include "tools/http/problem.h"
#include "tools/http/service.h"
#include "tools/http/turns.h"

namespace ptin::http {

/// What all connections of a server share. Used on its one thread.
struct ConnectionHost {
  const Limits& limits;
  Service& service;
  Admission& admission;
  Turns& turns;  ///< Turns of answers that take more than one piece.
  std::uint64_t next_request = 1;
  /// The one body that waits for memory and goes on beyond their share: else many that have a part of
  /// theirs might wait for each other.
  const void* first_body = nullptr;
  bool drains = false;  ///< No question is taken any more.
};

/// Reads a request, has it answered, writes the answer, and begins again. Everything runs on the
/// one thread of the executor but the computing of answers and the reading of files. A connection
/// keeps itself alive while it waits for something. It waits for its socket alone, and then reads and
/// writes what can be at once: no operation holds its parser or a buffer in between, so that it may be
/// closed, or refuse a request, at any time.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param closed  Called once, on the executor's thread, when the connection is over.
  Connection(boost::asio::generic::stream_protocol::socket socket, ConnectionHost& host,
             std::function<void(Connection*)> closed);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// @param is_extra  One more than the server takes: it is answered what is quick, and hears that
  ///                  there are too many, and closed.
  void start(bool is_extra);
  /// The connection ends when it waits for a request, or else after the answer at hand.
  void finish();
  /// Closes the connection now; a question that it asked is stopped.
  void abort();

  /// Since when it waits for the whole head of a request, or for the client to close; none: it does
  /// something else.
  [[nodiscard]] std::optional<Clock::time_point> waits_since() const;
  /// The share of who connects.
  [[nodiscard]] const std::string& peer() const noexcept { return peer_share_; }
  [[nodiscard]] bool is_of_proxy() const noexcept { return is_of_proxy_; }
  [[nodiscard]] bool is_extra() const noexcept { return is_extra_; }

 private:
  using Parser = boost::beast::http::request_parser<GrowingBody>;
  using Status = boost::system::error_code;
  enum class State { kIdle, kReading, kComputing, kWriting, kLingering, kClosed };

  /// Between two looks whether there is memory again, or a client hung up.
  static constexpr std::chrono::milliseconds kBetweenLooks{25};

  void wait_for_bytes();
  void look_at_bytes();
  void wait_for_request(std::chrono::milliseconds most);
  void begin_request();
  void set_reading_deadline();
  void read_more();
  void parse();
  [[nodiscard]] Status parse_next();
  [[nodiscard]] bool take_head();
  [[nodiscard]] std::optional<Problem> problem_of_framing() const;
  [[nodiscard]] std::shared_ptr<Request> request_of_head();
  void check_head();
  [[nodiscard]] bool skip_empty_lines();
  [[nodiscard]] std::string_view begun_line() const;
  [[nodiscard]] bool expects_continue() const;
  [[nodiscard]] bool is_worth_reading() const;
  [[nodiscard]] bool begin_body();
  [[nodiscard]] bool make_room_for_body();
  void wait_for_memory();
  void take_body();
  void give_back_body();
  void refuse_late();
  void refuse(const Problem& problem);
  [[nodiscard]] Problem problem_of_head(const Status& status) const;

  void compute();
  /// Runs on a thread for computing.
  void answer(const std::shared_ptr<Request>& request, const std::shared_ptr<Response>& kept,
              Clock::time_point asked);
  void look_at_the_time();
  void watch_for_hang_up();
  void look_for_hang_up();
  void look_again_for_hang_up();
  void give_up(GivenUp why);
  void refuse_ticket(const Problem& problem);
  void take_answer(std::uint64_t request, Response response, double queued, double computed);

  /// @param then_close  The answer is the last one of the connection.
  void write(Response response, bool then_close);
  void write_more();
  void wait_for_room();
  void read_long_piece();
  void write_long_piece(const std::vector<char>& piece);
  void end_of_answer(bool is_whole);
  void linger();
  void drop_what_comes();

  /// Calls `then` after `time`, unless set_deadline() or clear_deadline() is called before.
  void set_deadline(std::chrono::milliseconds time, std::function<void()> then);
  void clear_deadline();
  void withdraw_ticket();
  void close();

  boost::asio::generic::stream_protocol::socket socket_;
  ConnectionHost& host_;
  std::function<void(Connection*)> closed_;
  boost::asio::ip::address peer_;
  std::string peer_share_;
  bool is_of_proxy_ = false, is_extra_ = false;
  boost::asio::steady_timer timer_;
  boost::asio::steady_timer look_;  ///< For a hang-up behind bytes that wait, and for memory.
  std::uint64_t deadline_ = 0;      ///< Number of the deadline in force.
  bool is_short_ = false;           ///< There is no memory for the body.
  bool awaits_bytes_ = false;
  State state_ = State::kIdle;
  bool has_head_ = false;
  Clock::time_point waits_since_, read_by_;
  boost::beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  std::uint64_t framing_ = 0;  ///< Bytes of a body in chunks that are neither body nor needed.
  std::shared_ptr<Request> request_;
  std::optional<Response> refusal_;  ///< Known from the head; the body is dropped first.
  std::shared_ptr<MemoryBudget::Lease> body_room_;
  std::shared_ptr<Ticket> ticket_;
  Clock::time_point asked_;
  std::stop_source stop_;
  GivenUp given_up_ = GivenUp::kNot;
  bool keeps_ = false;  ///< Another request may follow.

  Response response_;
  std::string head_;
  std::size_t head_written_ = 0;
  std::uint64_t body_written_ = 0, bytes_written_ = 0, dropped_ = 0;
  Clock::time_point began_writing_, write_by_;
  double queued_ = 0.0, computed_ = 0.0;
};

}  // namespace ptin::http
