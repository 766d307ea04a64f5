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
#include <utility>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "tools/http/limits.h"
#include "tools/http/memory_budget.h"
#include "tools/http/problem.h"
#include "tools/http/service.h"
#include "tools/http/turns.h"
#include "tools/http/worker_pool.h"

namespace ptin::http {

/// What all connections of a server share. Used on its one thread.
struct ConnectionHost {
  const Limits& limits;
  Service& service;
  WorkerPool& pool;
  /// Of bodies that arrive or are answered.
  std::shared_ptr<MemoryBudget> bodies;
  Turns& turns;  ///< Of answers that take more than one piece.
  std::uint64_t next_request = 1;
  bool drains = false;  ///< No request is taken any more.
};

/// Reads a request, has it answered, writes the answer, and begins again. Everything runs on the
/// one thread of the executor but the computing of answers. A connection keeps itself alive while
/// it waits for something.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  /// @param closed  Called once, on the executor's thread, when the connection is over.
  Connection(boost::asio::ip::tcp::socket socket, ConnectionHost& host,
             std::function<void(Connection*)> closed);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void start();
  /// Closes the connection when it waits for a request, or else after the answer at hand.
  void drain();
  /// Closes the connection now; a question that it asked is stopped.
  void abort();
  /// Writes a refusal and closes: of a server that has too many connections.
  void turn_away(const Problem& problem);

 private:
  using Clock = std::chrono::steady_clock;
  using Parser = boost::beast::http::request_parser<boost::beast::http::string_body>;
  using Status = boost::system::error_code;
  enum class State { kIdle, kReading, kComputing, kWriting, kLingering, kClosed };

  void wait_for_request(std::chrono::milliseconds most);
  void read_head();
  void take_head(const Status& status);
  [[nodiscard]] std::optional<Problem> problem_of_framing() const;
  void make_room_for_body();
  void read_body();
  void take_body(const Status& status);
  void take_request(const std::shared_ptr<Request>& request);
  void refuse_reading(const Status& status);
  void refuse(const Problem& problem);
  [[nodiscard]] Problem problem_of_head(const Status& status) const;

  void compute();
  void watch_for_hang_up();
  void look_for_hang_up();
  void give_up(GivenUp why);
  void take_answer(std::uint64_t request, Response response, double queued, double computed);

  /// @param then_close  The answer is the last one of the connection.
  void write(Response response, bool then_close);
  void write_next(Status status, std::size_t bytes);
  void write_piece();
  void wait_for_room();
  void write_long_piece();
  void end_of_answer(bool is_whole);
  void linger();
  void drop_what_comes();

  /// Calls `then` after `time`, unless set_deadline() or clear_deadline() is called before.
  void set_deadline(std::chrono::milliseconds time, std::function<void()> then);
  void clear_deadline();
  void close();

  boost::asio::ip::tcp::socket socket_;
  ConnectionHost& host_;
  std::function<void(Connection*)> closed_;
  boost::asio::steady_timer timer_;
  boost::asio::steady_timer look_;  ///< For a hang-up behind bytes that wait.
  std::uint64_t deadline_ = 0;      ///< Number of the deadline in force.
  bool late_ = false;               ///< The deadline of reading passed.
  State state_ = State::kIdle;
  boost::beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  std::shared_ptr<const Request> request_;
  std::shared_ptr<MemoryBudget::Lease> body_room_;
  std::stop_source stop_;
  GivenUp given_up_ = GivenUp::kNot;
  bool keeps_ = false;  ///< Another request may follow.

  Response response_;
  std::string head_;
  std::vector<char> piece_;
  std::uint64_t body_written_ = 0, bytes_written_ = 0, dropped_ = 0;
  Clock::time_point began_writing_, write_by_;
  double queued_ = 0.0, computed_ = 0.0;
};

}  // namespace ptin::http
