// SPDX-License-Identifier: GPL-3.0-or-later
//
// The way of a request until there is an answer.
#include <algorithm>
#include <cerrno>
#include <exception>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include "tools/http/connection.h"
#include "tools/http/deliver.h"

namespace ptin::http {

namespace {

using std::chrono::milliseconds;

double seconds_between(std::chrono::steady_clock::time_point from,
                       std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// Whose time ran out before it began. The limit is the one that is to be raised so that more begin.
Problem problem_of_waiting(WaitsFor lack, const Limits& limits) {
  const std::string waited =
      "the question waited " + std::to_string(limits.queueing.count()) + " ms for ";
  if (lack == WaitsFor::kTurn) {
    return Problem(503, waited + "its turn behind others; come again later")
        .beyond("queueing")
        .retry_after(1);
  }
  return Problem(503, waited + "memory: too little of the " + std::to_string(limits.memory_bytes) +
                          " bytes for all questions came back from those before it; come again "
                          "later")
      .beyond("memory_bytes")
      .retry_after(1);
}

/// The memory of a question becomes that of its answer. What one piece holds the system takes at once.
void keep_for_answer(const std::shared_ptr<MemoryBudget::Lease>& lease, Response& response) {
  if (!lease || response.held != lease) return;
  if (lease->bytes() <= kPieceBytes) return response.held.reset();
  if (lease->change_use(MemoryUse::kAnswer)) return;
  throw Problem(503,
                "answers that clients have not taken yet hold all memory that the server has for "
                "them; come again later")
      .beyond("memory_bytes")
      .retry_after(1);
}

}  // namespace

void Connection::compute() {
  state_ = State::kComputing;
  asked_ = Clock::now();
  const Needs needs = host_.service.needs(*request_);
  if (needs.memory > host_.admission.memory()->bytes()) {
    return refuse_ticket(Problem(503, "the question takes more memory than the server has at all")
                             .beyond("memory_bytes")
                             .retry_after(1));
  }
  const auto kept = std::make_shared<Response>();  // Later there may be no memory for it.
  ticket_ = std::make_shared<Ticket>();
  ticket_->lane = needs.lane;
  ticket_->memory = needs.memory;
  ticket_->client = request_->share;
  ticket_->run = [self = shared_from_this(), request = request_, kept,
                  asked = asked_](std::shared_ptr<MemoryBudget::Lease> lease) {
    request->memory = std::move(lease);
    self->answer(request, kept, asked);
  };
  const Problem full = Problem(503, "more requests wait than the server queues; come again later")
                           .beyond("waiting")
                           .retry_after(1);
  ticket_->displaced = [self = shared_from_this(), full] { self->refuse_ticket(full); };
  if (!host_.admission.add(ticket_)) return refuse_ticket(full);
  set_deadline(std::min(host_.limits.queueing, host_.limits.computing),
               [this] { look_at_the_time(); });
  watch_for_hang_up();
}

void Connection::answer(const std::shared_ptr<Request>& request,
                        const std::shared_ptr<Response>& kept, Clock::time_point asked) {
  const auto begun = Clock::now();
  const auto self = shared_from_this();
  Response response;
  try {
    if (request->stop.stop_requested()) throw Problem(503, "nobody waits for the answer");
    response = host_.service.answer(*request);
    keep_for_answer(request->memory, response);
  } catch (...) {
    // given_up_ is read on the thread of connections, where it is written.
    auto thrown = std::current_exception();
    request->memory.reset();
    deliver(socket_.get_executor(), [self, request, asked, begun, thrown] {
      Response failed = self->host_.service.failure(*request, thrown, self->given_up_);
      self->take_answer(request->id, std::move(failed), seconds_between(asked, begun),
                        seconds_between(begun, Clock::now()));
    });
    return;
  }
  request->memory.reset();
  *kept = std::move(response);
  const double queued = seconds_between(asked, begun);
  const double computed = seconds_between(begun, Clock::now());
  deliver(socket_.get_executor(), [self, request, kept, queued, computed] {
    self->take_answer(request->id, std::move(*kept), queued, computed);
  });
}

/// The deadline of waiting, and then that of computing.
void Connection::look_at_the_time() {
  if (state_ != State::kComputing || !ticket_) return;
  const Limits& limits = host_.limits;
  const bool has_begun = ticket_->has_begun();
  const auto due = has_begun ? ticket_->begun() + limits.computing : asked_ + limits.queueing;
  const auto left = std::chrono::ceil<milliseconds>(due - Clock::now());
  if (left.count() > 0) {
    return set_deadline(has_begun ? left : std::min(left, limits.computing),
                        [this] { look_at_the_time(); });
  }
  if (has_begun) return give_up(GivenUp::kDeadline);
  const auto lack = host_.admission.withdraw(*ticket_);
  if (!lack) {  // It has begun by now.
    return set_deadline(milliseconds(1), [this] { look_at_the_time(); });
  }
  refuse_ticket(problem_of_waiting(*lack, limits));
}

/// Answers in the place of a ticket that will not run.
void Connection::refuse_ticket(const Problem& problem) {
  if (state_ != State::kComputing) return;
  clear_deadline();
  ticket_.reset();
  queued_ = seconds_between(asked_, Clock::now());
  Response response = problem.response();
  host_.service.finish(*request_, response);
  write(std::move(response), !keeps_);
}

/// Bytes that come, or wait already, are of a next request, which is not read yet.
void Connection::watch_for_hang_up() {
  buffer_.size() > 0 ? look_again_for_hang_up() : wait_for_bytes();
}

void Connection::look_for_hang_up() {
  char byte = 0;
  const ssize_t got = ::recv(socket_.native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  if (got > 0) return look_again_for_hang_up();
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return wait_for_bytes();
  keeps_ = false;
  give_up(GivenUp::kHungUp);
}

/// Where further bytes wait, only the system's own state of the socket shows: it is looked at.
void Connection::look_again_for_hang_up() {
  look_.expires_after(kBetweenLooks);
  look_.async_wait([self = shared_from_this(), id = request_->id](const Status& status) {
    if (self->state_ != State::kComputing || self->request_->id != id || status) return;
    pollfd look{self->socket_.native_handle(), POLLRDHUP, 0};
    if (::poll(&look, 1, 0) <= 0) return self->look_again_for_hang_up();
    self->keeps_ = false;
    self->give_up(GivenUp::kHungUp);
  });
}

void Connection::give_up(GivenUp why) {
  if (given_up_ == GivenUp::kNot) given_up_ = why;
  stop_.request_stop();
  if (why != GivenUp::kHungUp || state_ != State::kComputing || !ticket_) return;
  if (!host_.admission.withdraw(*ticket_)) return;
  queued_ = seconds_between(asked_, Clock::now());
  end_of_answer(false);
}

void Connection::take_answer(std::uint64_t request, Response response, double queued,
                             double computed) {
  if (state_ != State::kComputing || request_->id != request) return;
  clear_deadline();
  ticket_.reset();
  queued_ = queued;
  computed_ = computed;
  if (given_up_ == GivenUp::kHungUp) {
    response_ = std::move(response);
    return end_of_answer(false);
  }
  host_.service.finish(*request_, response);
  write(std::move(response), !keeps_);
}

}  // namespace ptin::http
