// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/connection.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <ctime>
#include <exception>
#include <new>
#include <span>
#include <string_view>
#include <thread>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/read.hpp>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "tools/http/partial_target.h"

namespace ptin::http {

namespace {

namespace beast_http = boost::beast::http;

/// So much of an answer waits in the system's memory, beside what is on its way: without a bound it
/// takes megabytes for each client that does not read.
constexpr int kMostUnsentBytes = 128 << 10;
/// So much of a refused request is still read, for at most so long, before the connection closes:
/// a socket that is closed while bytes wait in it resets, and the client loses the answer.
constexpr std::uint64_t kMostDropped = std::uint64_t{1} << 20;
constexpr std::size_t kDroppedPieceBytes = std::size_t{4} << 10;
constexpr std::chrono::milliseconds kLinger{1000};

double seconds_between(std::chrono::steady_clock::time_point from,
                       std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

std::string address_of(const boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code status;
  const auto end = socket.remote_endpoint(status);
  return status ? std::string("unknown") : end.address().to_string();
}

std::string lower(std::string_view text) {
  std::string low(text);
  for (char& c : low) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return low;
}

/// Calls `then` on the thread of connections. An answer is not lost where the system gives no memory
/// at this moment: others that end give some back.
template <class Executor, class Then>
void deliver(const Executor& executor, const Then& then) {
  while (true) {
    try {
      boost::asio::post(executor, then);
      return;
    } catch (const std::bad_alloc&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
}

/// The time as RFC 9110 has it. The one thread of connections asks.
const std::string& date_now() {
  static std::time_t told = 0;
  static std::string text;
  if (const std::time_t now = std::time(nullptr); now != told) {
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    std::array<char, 40> date{};
    std::strftime(date.data(), date.size(), "%a, %d %b %Y %H:%M:%S GMT", &parts);
    text = date.data();
    told = now;
  }
  return text;
}

std::string head_text(const Response& response, bool keeps) {
  std::string head = "HTTP/1.1 " + std::to_string(response.status) + " ";
  head += reason_of(response.status) + "\r\nServer: ptin\r\nDate: " + date_now() + "\r\n";
  if (!response.content_type.empty()) head += "Content-Type: " + response.content_type + "\r\n";
  for (const auto& [name, value] : response.headers) head += name + ": " + value + "\r\n";
  if (response.status != 204 && response.status != 304) {
    head += "Content-Length: " + std::to_string(response.body_bytes()) + "\r\n";
  }
  return head + (keeps ? "Connection: keep-alive\r\n\r\n" : "Connection: close\r\n\r\n");
}

}  // namespace

Connection::Connection(boost::asio::ip::tcp::socket socket, ConnectionHost& host,
                       std::function<void(Connection*)> closed)
    : socket_(std::move(socket)),
      host_(host),
      closed_(std::move(closed)),
      timer_(socket_.get_executor()),
      look_(socket_.get_executor()),
      buffer_(host.limits.request_line_bytes + host.limits.header_bytes + kPieceBytes) {}

Connection::~Connection() { close(); }

void Connection::start() {
  // Where the system does not know it, it keeps its own bound.
  static_cast<void>(::setsockopt(socket_.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT,
                                 &kMostUnsentBytes, sizeof kMostUnsentBytes));
  wait_for_request(host_.limits.reading);
}

void Connection::drain() {
  keeps_ = false;
  if (state_ == State::kIdle) close();
}

void Connection::abort() {
  give_up(GivenUp::kHungUp);
  close();
}

void Connection::turn_away(const Problem& problem) {
  request_ = std::make_shared<Request>();
  Response response = problem.response();
  host_.service.finish(*request_, response);
  write(std::move(response), true);
}

// --- reading

void Connection::wait_for_request(std::chrono::milliseconds most) {
  state_ = State::kIdle;
  if (buffer_.size() > 0) return read_head();
  set_deadline(most, [this] { close(); });
  socket_.async_wait(boost::asio::ip::tcp::socket::wait_read,
                     [self = shared_from_this()](const Status& status) {
                       if (status || self->state_ != State::kIdle) return self->close();
                       self->read_head();
                     });
}

void Connection::read_head() {
  state_ = State::kReading;
  late_ = false;
  parser_.emplace();
  parser_->header_limit(
      static_cast<std::uint32_t>(host_.limits.request_line_bytes + host_.limits.header_bytes));
  parser_->body_limit(host_.limits.body_bytes);
  set_deadline(host_.limits.reading, [this] {
    late_ = true;
    socket_.cancel();
  });
  beast_http::async_read_header(
      socket_, buffer_, *parser_,
      [self = shared_from_this()](const Status& status, std::size_t) { self->take_head(status); });
}

void Connection::take_head(const Status& status) {
  if (status) return refuse_reading(status);
  const auto& head = parser_->get();
  if (head.target().size() + head.method_string().size() > host_.limits.request_line_bytes) {
    return refuse_reading(beast_http::error::header_limit);
  }
  std::size_t lines = 0;
  for (const auto& field : head) lines += field.name_string().size() + field.value().size() + 4;
  if (lines > host_.limits.header_bytes) return refuse_reading(beast_http::error::header_limit);
  if (const auto problem = problem_of_framing()) return refuse(*problem);
  if (parser_->is_done()) return take_body({});
  make_room_for_body();
}

/// What a proxy before this server might read in another way: it would take the body of one request
/// for another one (RFC 9112, sections 3.2 and 6.1).
std::optional<Problem> Connection::problem_of_framing() const {
  const auto& head = parser_->get();
  const std::string coding =
      lower({head["Transfer-Encoding"].data(), head["Transfer-Encoding"].size()});
  if (!coding.empty() && (coding != "chunked" || head.version() < 11)) {
    return Problem(501,
                   "the body comes in a transfer coding that is not answered; send it chunked, "
                   "or with Content-Length");
  }
  if (head.version() >= 11 && head.count("Host") != 1) {
    return Problem(400, "a request of HTTP/1.1 has one header Host");
  }
  return std::nullopt;
}

void Connection::make_room_for_body() {
  const auto length = parser_->content_length();
  body_room_ = host_.bodies->lend(length ? *length : host_.limits.body_bytes);
  if (!body_room_) {
    return refuse(Problem(503,
                          "the bodies of the requests at hand take all memory for them; come "
                          "again later")
                      .beyond("memory_bytes")
                      .retry_after(1));
  }
  const auto& head = parser_->get();
  if (lower({head["Expect"].data(), head["Expect"].size()}) != "100-continue") return read_body();
  static constexpr std::string_view kGoOn = "HTTP/1.1 100 Continue\r\n\r\n";
  boost::asio::async_write(socket_, boost::asio::buffer(kGoOn),
                           [self = shared_from_this()](const Status& written, std::size_t) {
                             if (written) return self->refuse_reading(written);
                             self->read_body();
                           });
}

void Connection::read_body() {
  set_deadline(host_.limits.reading, [this] {
    late_ = true;
    socket_.cancel();
  });
  beast_http::async_read(
      socket_, buffer_, *parser_,
      [self = shared_from_this()](const Status& status, std::size_t) { self->take_body(status); });
}

void Connection::take_body(const Status& status) {
  if (status) return refuse_reading(status);
  clear_deadline();
  const auto& message = parser_->get();
  keeps_ = message.keep_alive() && !host_.drains;
  const auto request = std::make_shared<Request>();
  request->id = host_.next_request++;
  request->method = std::string(message.method_string());
  request->target = std::string(message.target());
  request->body = std::move(parser_->get().body());
  request->remote = address_of(socket_);
  for (const auto& field : message) {
    request->headers.emplace_back(lower({field.name_string().data(), field.name_string().size()}),
                                  std::string(field.value()));
  }
  stop_ = std::stop_source();
  request->stop = stop_.get_token();
  given_up_ = GivenUp::kNot;
  queued_ = computed_ = 0.0;
  take_request(request);
}

void Connection::take_request(const std::shared_ptr<Request>& request) {
  request_ = request;
  request->path = path_of(request->target);  // Where the rest of the target is refused.
  try {
    Target target = parse_target(request->target);
    request->path = std::move(target.path);
    request->parameters = std::move(target.parameters);
    request->is_parsed = true;
    if (!host_.service.is_quick(*request_)) return compute();
    Response response = host_.service.answer_quickly(*request_);
    host_.service.finish(*request_, response);
    write(std::move(response), !keeps_);
  } catch (...) {
    Response response = host_.service.failure(*request_, std::current_exception(), GivenUp::kNot);
    host_.service.finish(*request_, response);
    write(std::move(response), !keeps_);
  }
}

Problem Connection::problem_of_head(const Status& status) const {
  const Limits& limits = host_.limits;
  if (late_) {
    return Problem(408, "the request did not arrive within " +
                            std::to_string(limits.reading.count()) + " ms; send it at once")
        .beyond("reading");
  }
  if (status == beast_http::error::body_limit) {
    return Problem(413, "the body is larger than " + std::to_string(limits.body_bytes) +
                            " bytes; send less at once")
        .beyond("body_bytes");
  }
  if (status == beast_http::error::header_limit || status == beast_http::error::buffer_overflow) {
    const std::string_view begun(static_cast<const char*>(buffer_.data().data()), buffer_.size());
    const bool has_line = parser_->get().target().size() > 0
                              ? parser_->get().target().size() <= limits.request_line_bytes
                              : begun.find("\r\n") < limits.request_line_bytes;
    if (!has_line) {
      return Problem(414, "the first line of the request is longer than " +
                              std::to_string(limits.request_line_bytes) +
                              " bytes; send the question as the body of a POST")
          .beyond("request_line_bytes");
    }
    return Problem(431, "the header lines take more than " + std::to_string(limits.header_bytes) +
                            " bytes; send fewer")
        .beyond("header_bytes");
  }
  return {400, "the request is no HTTP/1.1: " + status.message()};
}

void Connection::refuse_reading(const Status& status) {
  const bool is_gone = !late_ && (status == beast_http::error::end_of_stream ||
                                  status == beast_http::error::partial_message ||
                                  status.category() == boost::asio::error::get_system_category());
  // Nothing came before the deadline: there is nobody to tell.
  if (is_gone || state_ == State::kClosed || (late_ && buffer_.size() == 0 && !parser_->got_some()))
    return close();
  refuse(problem_of_head(status));
}

void Connection::refuse(const Problem& problem) {
  auto request = std::make_shared<Request>();
  request->id = host_.next_request++;
  request->remote = address_of(socket_);
  const auto& target = parser_->get().target();
  request->path = path_of(
      !target.empty()
          ? std::string_view(target.data(), target.size())
          : target_of_line({static_cast<const char*>(buffer_.data().data()), buffer_.size()}));
  request_ = std::move(request);
  Response response = problem.response();
  host_.service.finish(*request_, response);
  write(std::move(response), true);
}

// --- computing

void Connection::compute() {
  state_ = State::kComputing;
  const auto asked = Clock::now();
  const auto kept = std::make_shared<Response>();  // Later there may be no memory for it.
  const bool is_taken =
      host_.pool.add([self = shared_from_this(), request = request_, asked, kept] {
        const auto begun = Clock::now();
        Response response;
        try {
          if (request->stop.stop_requested()) throw Problem(503, "nobody waits for the answer");
          response = self->host_.service.answer(*request);
        } catch (...) {
          // given_up_ is read on the thread of connections, where it is written.
          auto thrown = std::current_exception();
          deliver(self->socket_.get_executor(), [self, request, asked, begun, thrown] {
            Response failed = self->host_.service.failure(*request, thrown, self->given_up_);
            self->take_answer(request->id, std::move(failed), seconds_between(asked, begun),
                              seconds_between(begun, Clock::now()));
          });
          return;
        }
        *kept = std::move(response);
        const double queued = seconds_between(asked, begun);
        const double computed = seconds_between(begun, Clock::now());
        deliver(self->socket_.get_executor(), [self, request, kept, queued, computed] {
          self->take_answer(request->id, std::move(*kept), queued, computed);
        });
      });
  if (!is_taken) {
    Response response = Problem(503, "more requests wait than the server queues; come again later")
                            .beyond("waiting")
                            .retry_after(1)
                            .response();
    host_.service.finish(*request_, response);
    return write(std::move(response), !keeps_);
  }
  set_deadline(host_.limits.computing, [this] { give_up(GivenUp::kDeadline); });
  watch_for_hang_up();
}

void Connection::watch_for_hang_up() {
  if (buffer_.size() > 0) return look_for_hang_up();
  socket_.async_wait(boost::asio::ip::tcp::socket::wait_read,
                     [self = shared_from_this(), id = request_->id](const Status& status) {
                       if (self->state_ != State::kComputing || self->request_->id != id || status)
                         return;
                       char byte = 0;
                       const ssize_t got =
                           ::recv(self->socket_.native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
                       if (got > 0) return self->look_for_hang_up();
                       if (got < 0 && (errno == EAGAIN || errno == EINTR))
                         return self->watch_for_hang_up();
                       self->keeps_ = false;
                       self->give_up(GivenUp::kHungUp);
                     });
}

/// Where further bytes wait, only the system's own state of the socket tells: it is looked at.
void Connection::look_for_hang_up() {
  constexpr std::chrono::milliseconds kBetweenLooks{25};
  look_.expires_after(kBetweenLooks);
  look_.async_wait([self = shared_from_this(), id = request_->id](const Status& status) {
    if (self->state_ != State::kComputing || self->request_->id != id || status) return;
    pollfd look{self->socket_.native_handle(), POLLRDHUP, 0};
    if (::poll(&look, 1, 0) <= 0) return self->look_for_hang_up();
    self->keeps_ = false;
    self->give_up(GivenUp::kHungUp);
  });
}

void Connection::give_up(GivenUp why) {
  if (given_up_ == GivenUp::kNot) given_up_ = why;
  stop_.request_stop();
}

void Connection::take_answer(std::uint64_t request, Response response, double queued,
                             double computed) {
  if (state_ != State::kComputing || request_->id != request) return;
  clear_deadline();
  queued_ = queued;
  computed_ = computed;
  if (given_up_ == GivenUp::kHungUp) {
    response_ = std::move(response);
    return end_of_answer(false);
  }
  host_.service.finish(*request_, response);
  write(std::move(response), !keeps_);
}

// --- writing

void Connection::write(Response response, bool then_close) {
  state_ = State::kWriting;
  began_writing_ = Clock::now();
  keeps_ = !then_close && !host_.drains;
  response_ = std::move(response);
  head_ = head_text(response_, keeps_);
  const std::uint64_t held = response_.long_body ? 0 : response_.body_bytes();
  write_by_ = began_writing_ + host_.limits.writing +
              std::chrono::seconds(held / host_.limits.least_bytes_a_second);
  body_written_ = bytes_written_ = 0;
  set_deadline(host_.limits.writing, [this] { end_of_answer(false); });
  const bool has_body = request_->method != "HEAD" && response_.body_bytes() > 0;
  std::array<boost::asio::const_buffer, 2> first{boost::asio::buffer(head_), {}};
  if (!has_body) {
    body_written_ = response_.body_bytes();
  } else if (!response_.long_body) {
    const std::string_view body =
        response_.lasting_body.empty() ? response_.body : response_.lasting_body;
    first[1] = boost::asio::buffer(body.data(), std::min(body.size(), kPieceBytes));
    body_written_ = first[1].size();
  }
  boost::asio::async_write(socket_, first,
                           [self = shared_from_this()](const Status& status, std::size_t bytes) {
                             self->write_next(status, bytes);
                           });
}

void Connection::write_next(Status status, std::size_t bytes) {
  bytes_written_ += bytes;
  if (state_ != State::kWriting) return;
  if (status) return end_of_answer(false);
  if (body_written_ == response_.body_bytes()) return end_of_answer(true);
  if (!response_.long_body && Clock::now() > write_by_) return end_of_answer(false);
  set_deadline(host_.limits.writing, [this] { end_of_answer(false); });
  if (response_.long_body) return wait_for_room();
  host_.turns.wait([self = shared_from_this()] {
    if (self->state_ == State::kWriting) self->write_piece();
  });
}

/// Of an answer in memory.
void Connection::write_piece() {
  const std::string_view body =
      response_.lasting_body.empty() ? response_.body : response_.lasting_body;
  const std::string_view piece = body.substr(body_written_, kPieceBytes);
  body_written_ += piece.size();
  boost::asio::async_write(socket_, boost::asio::buffer(piece),
                           [self = shared_from_this()](const Status& next, std::size_t n) {
                             self->write_next(next, n);
                           });
}

/// A piece is read when the socket takes some of it, so that no memory is held for clients that do
/// not read.
void Connection::wait_for_room() {
  socket_.async_wait(boost::asio::ip::tcp::socket::wait_write,
                     [self = shared_from_this()](const Status& status) {
                       if (self->state_ != State::kWriting) return;
                       if (status) return self->end_of_answer(false);
                       self->host_.turns.wait([self] {
                         if (self->state_ == State::kWriting) self->write_long_piece();
                       });
                     });
}

void Connection::write_long_piece() {
  std::vector<char>& piece = host_.turns.room();
  const std::uint64_t left = response_.long_body->bytes - body_written_;
  const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(left, kPieceBytes));
  try {
    response_.long_body->read(body_written_, std::span(piece).first(size));
  } catch (const std::exception&) {
    // The connection closes before the announced length: the client notices.
    return end_of_answer(false);
  }
  Status status;
  socket_.non_blocking(true, status);
  const std::size_t taken =
      status ? 0 : socket_.write_some(boost::asio::buffer(piece.data(), size), status);
  if (status && status != boost::asio::error::would_block) return end_of_answer(false);
  const std::uint64_t before = body_written_;
  body_written_ += taken;
  bytes_written_ += taken;
  if (body_written_ == response_.long_body->bytes) return end_of_answer(true);
  if (body_written_ / kPieceBytes != before / kPieceBytes) {
    set_deadline(host_.limits.writing, [this] { end_of_answer(false); });
  }
  wait_for_room();
}

void Connection::end_of_answer(bool is_whole) {
  clear_deadline();
  const double seconds = seconds_between(began_writing_, Clock::now());
  const bool was_written = state_ == State::kWriting;
  host_.service.note({*request_, given_up_ == GivenUp::kHungUp ? nullptr : &response_, queued_,
                      computed_, was_written ? seconds : 0.0, bytes_written_, is_whole});
  if (!is_whole) close();  // What is being written is let go only then.
  response_ = {};
  body_room_.reset();
  head_.clear();
  piece_ = {};
  if (!is_whole) return;
  if (!keeps_ || host_.drains) return linger();
  wait_for_request(host_.limits.idle);
}

void Connection::linger() {
  state_ = State::kLingering;
  Status ignored;
  socket_.shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
  set_deadline(kLinger, [this] { close(); });
  dropped_ = 0;
  buffer_.consume(buffer_.size());
  drop_what_comes();
}

void Connection::drop_what_comes() {
  piece_.resize(kDroppedPieceBytes);
  socket_.async_read_some(boost::asio::buffer(piece_),
                          [self = shared_from_this()](const Status& status, std::size_t bytes) {
                            self->dropped_ += bytes;
                            if (status || self->dropped_ > kMostDropped) return self->close();
                            self->drop_what_comes();
                          });
}

// --- time

void Connection::set_deadline(std::chrono::milliseconds time, std::function<void()> then) {
  timer_.expires_after(time);
  timer_.async_wait([weak = weak_from_this(), number = ++deadline_,
                     then = std::move(then)](const Status& status) {
    const auto self = weak.lock();
    // A timer that was set anew may have its old call on the way.
    if (!self || status || self->deadline_ != number) return;
    then();
  });
}

void Connection::clear_deadline() {
  ++deadline_;
  timer_.cancel();
}

void Connection::close() {
  if (state_ == State::kClosed) return;
  state_ = State::kClosed;
  clear_deadline();
  look_.cancel();
  Status ignored;
  socket_.close(ignored);
  if (closed_) closed_(this);
}

}  // namespace ptin::http
