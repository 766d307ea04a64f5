// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading of requests.
#include "tools/http/connection.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/read_size.hpp>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http/error.hpp>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "tools/http/letters.h"
#include "tools/http/partial_target.h"

namespace ptin::http {

namespace {

namespace beast_http = boost::beast::http;
using std::chrono::milliseconds;

/// So much of an answer waits in the system's memory, beside what is on its way: without a bound it
/// takes megabytes for each client that does not read.
constexpr int kMostUnsentBytes = 128 << 10;
/// The first room of a body, which each connection has; each further one is twice as large, and lent.
constexpr std::size_t kFirstBodyBytes = std::size_t{4} << 10;
/// A body of so many bytes is read to its end though the request is refused: the connection goes on.
constexpr std::uint64_t kMostDroppedBody = std::uint64_t{64} << 10;
/// The size of a chunk, and the ends of lines around it.
constexpr std::uint64_t kChunkLine = 20;

}  // namespace

Connection::Connection(boost::asio::generic::stream_protocol::socket socket, ConnectionHost& host,
                       std::function<void(Connection*)> closed)
    : socket_(std::move(socket)),
      host_(host),
      closed_(std::move(closed)),
      timer_(socket_.get_executor()),
      look_(socket_.get_executor()),
      buffer_(host.limits.request_line_bytes + host.limits.header_bytes + kPieceBytes) {
  Status status;
  const auto end = socket_.remote_endpoint(status);
  if (!status && (end.data()->sa_family == AF_INET || end.data()->sa_family == AF_INET6)) {
    boost::asio::ip::tcp::endpoint of_ip;
    std::memcpy(of_ip.data(), end.data(), std::min(end.size(), of_ip.capacity()));
    peer_ = of_ip.address();
  }
  peer_share_ = share_of(peer_);
  is_of_proxy_ = is_in(host_.limits.trusted_proxies, peer_);
}

Connection::~Connection() { close(); }

void Connection::start(bool is_extra) {
  is_extra_ = is_extra;
  // Where the system does not know it, it keeps its own bound.
  static_cast<void>(::setsockopt(socket_.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT,
                                 &kMostUnsentBytes, sizeof kMostUnsentBytes));
  Status status;
  socket_.non_blocking(true, status);
  if (status) return close();
  wait_for_request(host_.limits.reading);
}

void Connection::finish() {
  keeps_ = false;
  if (state_ == State::kIdle) close();
}

void Connection::abort() {
  give_up(GivenUp::kHungUp);
  close();
}

std::optional<Connection::Clock::time_point> Connection::waits_since() const {
  if (state_ == State::kIdle || state_ == State::kLingering) return waits_since_;
  if (state_ == State::kReading && !has_head_) return waits_since_;
  return std::nullopt;
}

// --- reading

/// One wait at once, whatever it is for by the time that it ends.
void Connection::wait_for_bytes() {
  if (awaits_bytes_) return;
  socket_.async_wait(boost::asio::socket_base::wait_read,
                     [self = shared_from_this()](const Status& status) {
                       self->awaits_bytes_ = false;
                       if (status) return self->close();
                       self->look_at_bytes();
                     });
  awaits_bytes_ = true;
}

void Connection::look_at_bytes() {
  switch (state_) {
    case State::kIdle:
      return begin_request();
    case State::kReading:
      return read_more();
    case State::kComputing:
      return look_for_hang_up();
    case State::kLingering:
      return drop_what_comes();
    case State::kWriting:
    case State::kClosed:
      return;
  }
}

void Connection::wait_for_request(milliseconds most) {
  state_ = State::kIdle;
  has_head_ = false;
  waits_since_ = Clock::now();
  if (buffer_.size() > 0) return begin_request();
  if (buffer_.capacity() > kFirstBodyBytes) buffer_.shrink_to_fit();
  set_deadline(most, [this] { close(); });
  wait_for_bytes();
}

void Connection::begin_request() {
  state_ = State::kReading;
  is_short_ = false;
  framing_ = 0;
  parser_.emplace();
  parser_->eager(false);
  parser_->header_limit(
      static_cast<std::uint32_t>(host_.limits.request_line_bytes + host_.limits.header_bytes));
  parser_->body_limit(host_.limits.body_bytes);
  set_reading_deadline();
  if (buffer_.size() == 0) return read_more();
  // Requests that came together are answered in turn with those of others, and not from within the
  // last answer.
  boost::asio::post(socket_.get_executor(), [self = shared_from_this()] { self->parse(); });
}

/// The timer is for who sends nothing; each step looks at the clock itself.
void Connection::set_reading_deadline() {
  read_by_ = Clock::now() + host_.limits.reading;
  set_deadline(host_.limits.reading, [this] { refuse_late(); });
}

/// One read, so that others have their turn before the next.
void Connection::read_more() {
  const std::size_t room = boost::beast::read_size(buffer_, kPieceBytes);
  if (room == 0) return refuse(problem_of_head(beast_http::error::buffer_overflow));
  Status status;
  const std::size_t bytes = socket_.read_some(buffer_.prepare(room), status);
  if (status == boost::asio::error::would_block || status == boost::asio::error::try_again) {
    return wait_for_bytes();
  }
  if (status) return close();  // Nobody is there to be told.
  buffer_.commit(bytes);
  parse();
}

/// All that has arrived, as far as there is memory and time for it.
void Connection::parse() {
  while (state_ == State::kReading) {
    if (Clock::now() >= read_by_) return refuse_late();
    if (has_head_ && !make_room_for_body()) return wait_for_memory();
    const bool had_head = has_head_;
    const Status status = parse_next();
    if (status == beast_http::error::need_more) return wait_for_bytes();
    if (status && status != beast_http::error::need_buffer) return refuse(problem_of_head(status));
    if (!had_head && !take_head()) return;
    if (had_head && parser_->is_done()) return take_body();
  }
}

/// Before a request: some clients end a body with one more (RFC 9112, section 2.2). False: half a line
/// end stands there.
bool Connection::skip_empty_lines() {
  const auto* const bytes = static_cast<const char*>(buffer_.data().data());
  const std::string_view begun(bytes, buffer_.size());
  std::size_t empty = 0;
  while (begun.substr(empty, 2) == "\r\n") empty += 2;
  buffer_.consume(empty);
  return begun.substr(empty) != "\r";
}

/// The head, or else a chunk's line, the trailers or a part of the body.
Connection::Status Connection::parse_next() {
  Status status = beast_http::error::need_more;
  if (!parser_->got_some() && !skip_empty_lines()) return status;
  if (buffer_.size() == 0) return status;
  const std::uint64_t before = parser_->get().body().arrived;
  const std::size_t used = parser_->put(buffer_.data(), status);
  buffer_.consume(used);
  const std::uint64_t beside = used - (parser_->get().body().arrived - before);
  if (has_head_ && beside > kChunkLine) framing_ += beside - kChunkLine;
  if (framing_ > host_.limits.header_bytes) status = beast_http::error::header_limit;
  return status;
}

/// Whether a body is to be read.
bool Connection::take_head() {
  const auto& head = parser_->get();
  std::size_t lines = 0;
  for (const auto& field : head) lines += field.name_string().size() + field.value().size() + 4;
  if (head.target().size() + head.method_string().size() > host_.limits.request_line_bytes ||
      lines > host_.limits.header_bytes) {
    refuse(problem_of_head(beast_http::error::header_limit));
    return false;
  }
  request_ = request_of_head();
  has_head_ = true;
  if (const auto problem = problem_of_framing()) {
    refuse(*problem);
    return false;
  }
  check_head();
  if (parser_->is_done()) {
    take_body();
    return false;
  }
  if (refusal_ && !is_worth_reading()) {
    Response response = std::move(*refusal_);
    write(std::move(response), true);
    return false;
  }
  const bool is_quick = request_->is_parsed && host_.service.is_quick(*request_);
  parser_->get().body().is_dropped = refusal_.has_value() || is_quick;
  return begin_body();
}

std::shared_ptr<Request> Connection::request_of_head() {
  const auto& head = parser_->get();
  auto request = std::make_shared<Request>();
  request->id = host_.next_request++;
  request->method = std::string(head.method_string());
  request->target = std::string(head.target());
  for (const auto& field : head) {
    request->headers.emplace_back(
        lower_letters({field.name_string().data(), field.name_string().size()}),
        std::string(field.value()));
  }
  if (is_of_proxy_) request->forwarded = forwarded_of(request->headers);
  const auto client = client_of(peer_, request->forwarded.client, host_.limits.trusted_proxies);
  request->remote = client.is_unspecified() ? "unix" : client.to_string();
  request->share = share_of(client);
  request->is_secure = request->forwarded.proto == "https";
  stop_ = std::stop_source();
  request->stop = stop_.get_token();
  given_up_ = GivenUp::kNot;
  queued_ = computed_ = 0.0;
  body_written_ = bytes_written_ = 0;
  keeps_ = head.keep_alive() && !host_.drains && !is_extra_;
  return request;
}

/// Whether the request is refused whatever its body says.
void Connection::check_head() {
  refusal_.reset();
  request_->path = path_of(request_->target);  // Where the rest of the target is refused.
  try {
    host_.service.enter(*request_);
    const bool is_of_all = request_->method == "OPTIONS" && request_->target == "*";
    Target target = parse_target(is_of_all ? "/" : request_->target);
    request_->path = std::move(target.path);
    request_->parameters = std::move(target.parameters);
    request_->is_parsed = true;
    host_.service.enter(*request_);
    if (host_.service.is_quick(*request_)) return;
    if (is_extra_) {
      throw Problem(503, "the server has as many connections as it takes; come again later")
          .beyond("connections")
          .retry_after(1);
    }
    if (host_.drains) throw Problem(503, "the service ends; ask again").retry_after(1);
    host_.service.check(*request_);
    const auto coding = request_->header("content-encoding");
    if (coding && lower_letters(*coding) != "identity" && !parser_->is_done()) {
      throw Problem(415, "the body comes packed; send it as it is, without Content-Encoding");
    }
  } catch (...) {
    refusal_ = host_.service.failure(*request_, std::current_exception(), GivenUp::kNot);
    host_.service.finish(*request_, *refusal_);
  }
}

/// An expectation of HTTP/1.0 is to be ignored (RFC 9110, section 10.1.1).
bool Connection::expects_continue() const {
  const auto& head = parser_->get();
  return head.version() >= 11 && boost::beast::iequals(head["Expect"], "100-continue");
}

/// Whether the body of a refused request is read to its end, so that the connection goes on.
bool Connection::is_worth_reading() const {
  const auto length = parser_->content_length();
  return length && *length <= kMostDroppedBody && !expects_continue();
}

/// False: the connection is closed.
bool Connection::begin_body() {
  set_reading_deadline();
  if (!expects_continue()) return true;
  static constexpr std::string_view kGoOn = "HTTP/1.1 100 Continue\r\n\r\n";
  Status status;
  const std::size_t sent = socket_.write_some(boost::asio::buffer(kGoOn), status);
  // A client whose earlier answers fill the way to it sends its body after a while all the same.
  if (status == boost::asio::error::would_block || sent == kGoOn.size()) return true;
  close();
  return false;
}

/// Room for more of the body; false where no memory is lent for it now.
bool Connection::make_room_for_body() {
  GrowingBody::value_type& body = parser_->get().body();
  if (body.is_dropped || body.text.size() < body.text.capacity()) return true;
  const std::size_t most = static_cast<std::size_t>(
      parser_->content_length().value_or(std::uint64_t{host_.limits.body_bytes}));
  const std::size_t wanted = std::max(
      std::min(most, std::max(2 * body.text.capacity(), kFirstBodyBytes)), body.text.size() + 1);
  if (!body_room_) {
    body_room_ = host_.admission.memory()->lend(0, request_->share, MemoryUse::kBody);
  }
  if (wanted > kFirstBodyBytes && !body_room_->grow_to(wanted)) {
    if (host_.first_body == nullptr) host_.first_body = this;
    if (host_.first_body != this || !body_room_->grow_to(wanted, true)) return false;
  }
  is_short_ = false;
  body.text.reserve(wanted);
  // Beast reads as much at once as its buffer holds.
  if (wanted > kFirstBodyBytes) buffer_.reserve(std::min(wanted, kPieceBytes));
  return true;
}

void Connection::wait_for_memory() {
  is_short_ = true;
  look_.expires_after(kBetweenLooks);
  look_.async_wait([self = shared_from_this()](const Status& status) {
    if (status || self->state_ != State::kReading) return;
    pollfd look{self->socket_.native_handle(), POLLRDHUP, 0};
    if (::poll(&look, 1, 0) > 0) return self->close();
    self->parse();
  });
}

void Connection::take_body() {
  clear_deadline();
  request_->body = std::move(parser_->get().body().text);
  parser_.reset();
  Response response;
  try {
    if (!refusal_ && !host_.service.is_quick(*request_)) return compute();
    if (refusal_) {
      response = std::move(*refusal_);
    } else {
      response = host_.service.answer_quickly(*request_);
      host_.service.finish(*request_, response);
    }
  } catch (...) {
    if (state_ != State::kReading && state_ != State::kComputing) throw;
    withdraw_ticket();
    response = host_.service.failure(*request_, std::current_exception(), GivenUp::kNot);
    host_.service.finish(*request_, response);
  }
  write(std::move(response), !keeps_);
}

/// Lets the body go: nobody reads it once the request is answered or refused.
void Connection::give_back_body() {
  if (request_) std::string().swap(request_->body);
  parser_.reset();
  if (host_.first_body == this) host_.first_body = nullptr;
  body_room_.reset();
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

void Connection::withdraw_ticket() {
  if (!ticket_) return;
  const std::shared_ptr<Ticket> ticket = std::move(ticket_);
  host_.admission.withdraw(*ticket);
}

void Connection::close() {
  if (state_ == State::kClosed) return;
  state_ = State::kClosed;
  clear_deadline();
  withdraw_ticket();
  give_back_body();
  look_.cancel();
  Status ignored;
  socket_.close(ignored);
  if (closed_) closed_(this);
}

}  // namespace ptin::http
