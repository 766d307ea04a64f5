// SPDX-License-Identifier: GPL-3.0-or-later
//
// One range on its way: what is asked, what the server answers, and whether that is what was asked.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <curl/curl.h>

#include "engine/error.h"
#include "engine/handle.h"
#include "engine/remote/remote_file.h"

namespace ptin {

/// What sets an object apart from the one that takes its place.
struct ObjectIdentity {
  std::uint64_t bytes = 0;
  std::string etag, modified;  ///< As the server says them; empty: it does not.
  /// Whether an answer is of this object, as far as it says.
  [[nodiscard]] bool is_that_of(const ObjectIdentity& answer) const noexcept {
    return bytes == answer.bytes && (etag.empty() || answer.etag.empty() || etag == answer.etag) &&
           (!etag.empty() || modified.empty() || answer.modified.empty() ||
            modified == answer.modified);
  }
};

/// What the headers of an answer say.
struct AnswerHead {
  long status = 0;
  std::optional<std::uint64_t> first, last, total;  ///< Content-Range.
  std::string etag, modified, encoding;
  std::optional<double> retry_after;  ///< Seconds.
  /// Takes a line; a status line begins the head of another answer, as behind a redirection.
  void take(std::string_view line);
};

/// libcurl's handles of both kinds are void.
using CurlHandle = Handle<CURL, &curl_easy_cleanup>;
using CurlMulti = Handle<CURLM, &curl_multi_cleanup>;
using CurlList = Handle<curl_slist, &curl_slist_free_all>;

/// A range of an object by one GET, tried again where that may help. Threads: one at a time.
class HttpTransfer {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param expected  The object at its opening; null: this is its opening, of which the object may
  ///                  hold fewer bytes than `out` does. Borrowed, as `name` and `options` are.
  HttpTransfer(const std::string& name, const RangeRead& range, const ObjectIdentity* expected,
               const RemoteOptions& options);

  /// Prepares a handle for the next try; `url` may differ from try to try.
  void begin(CURL* handle, const std::string& url);
  /// What became of the try. True: there is nothing more to do, and failure() is set or not. False:
  /// to be tried again, from not_before() on.
  [[nodiscard]] bool finish(CURLcode code);
  /// Gives up: with the reason of the last try.
  void fail(Error error) { failure_.emplace(std::move(error)); }
  /// The failure is none: there will be another try.
  void forgive() { failure_.reset(); }

  [[nodiscard]] const std::optional<Error>& failure() const noexcept { return failure_; }
  [[nodiscard]] Clock::time_point not_before() const noexcept { return not_before_; }
  [[nodiscard]] bool was_refused() const noexcept { return refused_; }
  [[nodiscard]] const ObjectIdentity& identity() const noexcept { return identity_; }
  [[nodiscard]] std::size_t received() const noexcept { return received_; }

 private:
  static std::size_t take_header(char* data, std::size_t size, std::size_t count, void* self);
  static std::size_t take_body(char* data, std::size_t size, std::size_t count, void* self);
  [[nodiscard]] std::optional<Error> fault_of_head();
  [[nodiscard]] std::optional<Error> fault_of_place();
  bool try_again(const std::string& why);

  const std::string& name_;
  RangeRead range_;
  const ObjectIdentity* expected_;
  const RemoteOptions& options_;
  CurlList headers_;
  std::string range_text_;
  AnswerHead head_;
  ObjectIdentity identity_;
  std::size_t received_ = 0;
  int tries_ = 0;
  std::string words_;         ///< The beginning of a body that is no range.
  bool refused_ = false;      ///< The last try met 401 or 403.
  bool is_judged_ = false;    ///< The head was looked at.
  std::optional<Error> bad_;  ///< What the head of this try says that ends it.
  std::optional<Error> failure_;
  Clock::time_point not_before_{};
};

}  // namespace ptin
