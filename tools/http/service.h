// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a server asks for answers.
#pragma once

#include <cstdint>
#include <exception>

#include "tools/http/admission.h"
#include "tools/http/request.h"
#include "tools/http/response.h"

namespace ptin::http {

/// Why nobody waits for an answer any more.
enum class GivenUp : std::uint8_t { kNot, kDeadline, kHungUp };

/// Resources that a question takes before it works.
struct Needs {
  Lane lane = Lane::kPoint;
  std::uint64_t memory = 0;  ///< Bytes; request.memory has them when it is answered.
};

/// What became of a request: for the log and for counts.
struct Served {
  const Request& request;    ///< Its target may be empty: the head could not be read.
  const Response* response;  ///< Null: the client hung up before there was one.
  double queue_seconds = 0.0, compute_seconds = 0.0, write_seconds = 0.0;
  std::uint64_t bytes_written = 0;  ///< Heads included.
  bool is_whole = false;            ///< All of the answer was taken by the system.
};

/// Answers requests. Threads: answer(), rest() and bound_freed_memory() may be called on several at once; the server
/// calls all other functions on the thread of its connections, which they must not block.
class Service {
 public:
  virtual ~Service() = default;

  /// Called first, as soon as the path of a request is known: may take away what a proxy put before it.
  virtual void enter(Request& /*request*/) const {}
  /// Whether the request goes to answer_quickly(), beside all lanes and their limits.
  [[nodiscard]] virtual bool is_quick(const Request& request) const = 0;
  /// Looks at the head of a request before its body is read: throws a Problem where it is refused
  /// whatever its body says.
  virtual void check(const Request& head) const = 0;
  /// The needs of the request, now with its body.
  [[nodiscard]] virtual Needs needs(const Request& request) const = 0;
  /// May throw as answer().
  [[nodiscard]] virtual Response answer_quickly(const Request& request) = 0;
  /// Called on one of the threads for computing. May throw a Problem, or anything else, which
  /// becomes the answer that failure() gives.
  [[nodiscard]] virtual Response answer(const Request& request) = 0;
  /// The answer to a request whose computing threw.
  /// @param why  What made the stop token of the request fire, if anything did.
  [[nodiscard]] virtual Response failure(const Request& request, std::exception_ptr thrown,
                                         GivenUp why) noexcept = 0;
  /// Looks at every answer before it is written: adds headers that all have.
  virtual void finish(const Request& request, Response& response) = 0;
  /// Called on one of the threads for computing, some time after the last long question: the time to
  /// give memory back.
  virtual void rest() noexcept {}
  /// Called on one of the threads for computing, whenever questions have given back half as much memory as is
  /// kept (Limits::kept_bytes): the time to see that no more is.
  virtual void bound_freed_memory() noexcept {}
  /// Called once for every request.
  virtual void note(const Served& served) noexcept = 0;
};

}  // namespace ptin::http
