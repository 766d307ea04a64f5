// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writing of answers.
#include <algorithm>
#include <array>
#include <exception>
#include <span>
#include <string_view>

#include <boost/asio/buffer.hpp>

#include "tools/http/connection.h"
#include "tools/http/deliver.h"
#include "tools/http/response_head.h"

namespace ptin::http {

namespace {

/// Bytes of a refused request that are still read, and for how long, before the connection closes:
/// a socket that is closed while bytes wait in it resets, and the client loses the answer.
constexpr std::uint64_t kMostDropped = std::uint64_t{1} << 20;
constexpr std::size_t kDroppedPieceBytes = std::size_t{16} << 10;
constexpr std::chrono::milliseconds kLinger{1000};

}  // namespace

void Connection::write(Response response, bool then_close) {
  state_ = State::kWriting;
  began_writing_ = Clock::now();
  give_back_body();
  keeps_ = !then_close && !host_.drains;
  response_ = std::move(response);
  head_ = head_text(response_, keeps_);
  const std::uint64_t held = response_.long_body ? 0 : response_.body_bytes();
  write_by_ = began_writing_ + host_.limits.writing +
              std::chrono::seconds(held / host_.limits.least_bytes_a_second);
  bytes_written_ = head_written_ = 0;
  body_written_ = request_->method == "HEAD" ? response_.body_bytes() : 0;
  set_deadline(host_.limits.writing, [this] { end_of_answer(false); });
  write_more();
}

/// Writes what the system takes now: the head, and of an answer in memory the rest of a piece.
void Connection::write_more() {
  std::string_view body;
  if (!response_.long_body) {
    body = response_.lasting_body.empty() ? response_.body : response_.lasting_body;
    body = body.substr(body_written_, kPieceBytes - body_written_ % kPieceBytes);
  }
  const std::array<boost::asio::const_buffer, 2> rest{
      boost::asio::buffer(head_) + head_written_, boost::asio::buffer(body.data(), body.size())};
  Status status;
  const std::size_t taken = socket_.write_some(rest, status);
  if (status && status != boost::asio::error::would_block) return end_of_answer(false);
  const std::size_t of_head = std::min(taken, head_.size() - head_written_);
  head_written_ += of_head;
  body_written_ += taken - of_head;
  bytes_written_ += taken;
  if (head_written_ < head_.size()) return wait_for_room();
  if (body_written_ == response_.body_bytes()) return end_of_answer(true);
  if (response_.long_body || taken - of_head < body.size()) return wait_for_room();
  if (Clock::now() > write_by_) return end_of_answer(false);
  set_deadline(host_.limits.writing, [this] { end_of_answer(false); });
  host_.turns.wait([self = shared_from_this()] {
    if (self->state_ == State::kWriting) self->write_more();
  });
}

/// A piece is read when the socket takes some of it, so that no memory is held for clients that do
/// not read.
void Connection::wait_for_room() {
  socket_.async_wait(boost::asio::socket_base::wait_write,
                     [self = shared_from_this()](const Status& status) {
                       if (self->state_ != State::kWriting) return;
                       if (status) return self->end_of_answer(false);
                       const bool has_head = self->head_written_ == self->head_.size();
                       if (self->response_.long_body && has_head) return self->read_long_piece();
                       self->write_more();
                     });
}

/// Runs on a thread of its own lane: a disk may take its time.
void Connection::read_long_piece() {
  const std::uint64_t left = response_.long_body->bytes - body_written_;
  const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(left, kPieceBytes));
  ticket_ = std::make_shared<Ticket>();
  ticket_->lane = Lane::kRead;
  ticket_->memory = size;
  ticket_->client = request_->share;
  ticket_->run = [self = shared_from_this(), body = response_.long_body, offset = body_written_,
                  size](std::shared_ptr<MemoryBudget::Lease> lease) {
    auto piece = std::make_shared<std::vector<char>>();
    bool is_read = true;
    try {
      piece->resize(size);
      body->read(offset, *piece);
    } catch (const std::exception&) {
      is_read = false;
    }
    deliver(self->socket_.get_executor(), [self, piece, lease, is_read] {
      if (self->state_ != State::kWriting) return;
      self->ticket_.reset();
      // The connection closes before the announced length: the client notices.
      if (!is_read) return self->end_of_answer(false);
      self->write_long_piece(*piece);
    });
  };
  static_cast<void>(host_.admission.add(ticket_));  // This lane is never full.
}

void Connection::write_long_piece(const std::vector<char>& piece) {
  Status status;
  const std::size_t taken =
      socket_.write_some(boost::asio::buffer(piece.data(), piece.size()), status);
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
  const bool was_written = state_ == State::kWriting;
  const std::chrono::duration<double> written = Clock::now() - began_writing_;
  host_.service.note({*request_, given_up_ == GivenUp::kHungUp ? nullptr : &response_, queued_,
                      computed_, was_written ? written.count() : 0.0, bytes_written_, is_whole});
  if (!is_whole) close();
  response_ = {};
  request_.reset();
  head_.clear();
  if (!is_whole) return;
  if (!keeps_) return linger();
  wait_for_request(host_.limits.idle);
}

void Connection::linger() {
  state_ = State::kLingering;
  waits_since_ = Clock::now();
  Status ignored;
  socket_.shutdown(boost::asio::socket_base::shutdown_send, ignored);
  set_deadline(kLinger, [this] { close(); });
  dropped_ = 0;
  buffer_.consume(buffer_.size());
  drop_what_comes();
}

void Connection::drop_what_comes() {
  std::array<char, kDroppedPieceBytes> piece;
  Status status;
  dropped_ += socket_.read_some(boost::asio::buffer(piece), status);
  if (status && status != boost::asio::error::would_block) return close();
  if (dropped_ > kMostDropped) return close();
  wait_for_bytes();
}

}  // namespace ptin::http
