// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/remote/http_transfer.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include <cpl_conv.h>
#include <cpl_string.h>

#include "engine/number.h"

namespace ptin {

namespace {

constexpr double kMostPauseSeconds = 10;
constexpr std::size_t kMostWords = 4096;

/// What stores of objects say of a refusal, in XML, as the end of a sentence.
std::string message_in(const std::string& words) {
  constexpr std::string_view kBegin = "<Message>";
  const std::size_t begin = words.find(kBegin);
  const std::size_t end = words.find("</Message>");
  if (begin == std::string::npos || end == std::string::npos || end < begin) return "";
  std::string message = words.substr(begin + kBegin.size(), end - begin - kBegin.size());
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 127; };
  std::replace_if(message.begin(), message.end(), is_control, ' ');
  return ": " + message;
}

std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

bool is_header(std::string_view name, const char* wanted) {
  return name.size() == std::strlen(wanted) &&
         std::equal(name.begin(), name.end(), wanted, [](unsigned char a, unsigned char b) {
           return std::tolower(a) == std::tolower(b);
         });
}

bool may_pass(long status) {
  return status == 429 || status == 500 || status == 502 || status == 503 || status == 504;
}

bool may_pass(CURLcode code) {
  switch (code) {
    case CURLE_COULDNT_CONNECT:
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_OPERATION_TIMEDOUT:
    case CURLE_GOT_NOTHING:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_PARTIAL_FILE:
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_HTTP2:
    case CURLE_HTTP2_STREAM:
      return true;
    default:
      return false;
  }
}

Error replaced(const std::string& name) {
  return {ErrorCode::corruption,
          "the object was replaced or cut short while it was open; open it again", name};
}

std::string option_of(const char* name) { return CPLGetConfigOption(name, ""); }

void append(CurlList& list, const std::string& line) {
  curl_slist* const longer = curl_slist_append(list.get(), line.c_str());
  if (longer == nullptr) throw std::bad_alloc();
  static_cast<void>(list.release());
  list.reset(longer);
}

/// What GDAL's options of its own HTTP requests say that holds for ours too.
void set_options_of_gdal(CURL* handle) {
  const auto set = [&](const char* name, CURLoption option) {
    if (const std::string value = option_of(name); !value.empty()) {
      curl_easy_setopt(handle, option, value.c_str());
    }
  };
  set("GDAL_HTTP_USERPWD", CURLOPT_USERPWD);
  set("GDAL_HTTP_PROXY", CURLOPT_PROXY);
  set("GDAL_HTTP_PROXYUSERPWD", CURLOPT_PROXYUSERPWD);
  set("CURL_CA_BUNDLE", CURLOPT_CAINFO);
  if (CPLTestBool(CPLGetConfigOption("GDAL_HTTP_UNSAFESSL", "NO"))) {
    curl_easy_setopt(handle, CURLOPT_SSL_VERIFYPEER, 0L);
    curl_easy_setopt(handle, CURLOPT_SSL_VERIFYHOST, 0L);
  }
}

}  // namespace

void AnswerHead::take(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with("HTTP/")) {
    *this = {};
    const std::size_t space = line.find(' ');
    if (space != std::string_view::npos) {
      status = parse_number<long>(line.substr(space + 1, 3)).value_or(0);
    }
    return;
  }
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return;
  const std::string_view name = trimmed(line.substr(0, colon));
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (is_header(name, "etag")) {
    etag = value;
  } else if (is_header(name, "last-modified")) {
    modified = value;
  } else if (is_header(name, "content-encoding")) {
    encoding = value;
  } else if (is_header(name, "retry-after")) {
    retry_after = parse_number<double>(value);
  } else if (is_header(name, "content-range") && value.starts_with("bytes ")) {
    const std::string_view range = trimmed(value.substr(6));
    const std::size_t dash = range.find('-');
    const std::size_t slash = range.find('/');
    if (slash == std::string_view::npos) return;
    total = parse_number<std::uint64_t>(trimmed(range.substr(slash + 1)));
    if (dash == std::string_view::npos || dash > slash) return;
    first = parse_number<std::uint64_t>(trimmed(range.substr(0, dash)));
    last = parse_number<std::uint64_t>(trimmed(range.substr(dash + 1, slash - dash - 1)));
  }
}

HttpTransfer::HttpTransfer(const std::string& name, const RangeRead& range,
                           const ObjectIdentity* expected, const RemoteOptions& options)
    : name_(name),
      range_(range),
      expected_(expected),
      options_(options),
      range_text_(std::to_string(range.offset) + "-" +
                  std::to_string(range.offset + range.out.size() - 1)) {
  // A server that sees that it would send another object says so without sending it. Weak tags are
  // not compared by it.
  if (expected != nullptr && expected->etag.starts_with('"')) {
    append(headers_, "If-Match: " + expected->etag);
  }
  append(headers_, "Accept-Encoding: identity");
  if (const std::string bearer = option_of("GDAL_HTTP_BEARER"); !bearer.empty()) {
    append(headers_, "Authorization: Bearer " + bearer);
  }
  for (std::string lines = option_of("GDAL_HTTP_HEADERS"); !lines.empty();) {
    const std::size_t end = std::min(lines.find_first_of(",\n"), lines.size());
    if (end > 0) append(headers_, std::string(trimmed(lines.substr(0, end))));
    lines.erase(0, end + 1);
  }
}

void HttpTransfer::begin(CURL* handle, const std::string& url) {
  ++tries_;
  head_ = {};
  received_ = 0;
  refused_ = is_judged_ = false;
  bad_.reset();
  words_.clear();
  curl_easy_reset(handle);  // keeps its connections
  curl_easy_setopt(handle, CURLOPT_URL, url.c_str());
  curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(handle, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(handle, CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(handle, CURLOPT_MAXREDIRS, 5L);
  curl_easy_setopt(handle, CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_2TLS));
  curl_easy_setopt(handle, CURLOPT_PIPEWAIT, 1L);
  curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(handle, CURLOPT_USERAGENT, "ptin");
  curl_easy_setopt(handle, CURLOPT_RANGE, range_text_.c_str());
  curl_easy_setopt(handle, CURLOPT_HTTPHEADER, headers_.get());
  curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, options_.most_seconds_to_connect);
  curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, options_.most_silent_seconds);
  curl_easy_setopt(handle, CURLOPT_HEADERFUNCTION, &HttpTransfer::take_header);
  curl_easy_setopt(handle, CURLOPT_HEADERDATA, this);
  curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, &HttpTransfer::take_body);
  curl_easy_setopt(handle, CURLOPT_WRITEDATA, this);
  set_options_of_gdal(handle);
}

std::size_t HttpTransfer::take_header(char* data, std::size_t size, std::size_t count, void* self) {
  try {
    static_cast<HttpTransfer*>(self)->head_.take({data, size * count});
    return size * count;
  } catch (const std::bad_alloc&) {
    return 0;
  }
}

/// Takes a part of the body: only of an answer that is the range that was asked for, so that a server
/// that sends whole files is not listened to.
std::size_t HttpTransfer::take_body(char* data, std::size_t size, std::size_t count, void* self) {
  HttpTransfer& t = *static_cast<HttpTransfer*>(self);
  const std::size_t bytes = size * count;
  try {
    if (!t.is_judged_) {
      t.is_judged_ = true;
      t.bad_ = t.fault_of_head();
    }
    if (t.bad_) return 0;
    if (t.head_.status != 206) {
      t.words_.append(data, std::min(bytes, kMostWords - t.words_.size()));
      return bytes;
    }
    if (bytes > t.range_.out.size() - t.received_) {
      t.bad_.emplace(ErrorCode::io_error, "the server sent more bytes than were asked for",
                     t.name_);
      return 0;
    }
    std::memcpy(t.range_.out.data() + t.received_, data, bytes);
    t.received_ += bytes;
    return bytes;
  } catch (const std::bad_alloc&) {
    return 0;
  }
}

/// What is wrong with an answer that is a success.
std::optional<Error> HttpTransfer::fault_of_head() {
  if (head_.status == 200) {
    return Error(
        ErrorCode::invalid_argument,
        "the server sends whole files and no ranges of them (status 200 to a request for a "
        "range): copy the file, or put it on a server that sends ranges",
        name_);
  }
  if (head_.status != 206) return std::nullopt;
  if (!head_.encoding.empty() && !is_header(head_.encoding, "identity")) {
    return Error(ErrorCode::invalid_argument,
                 "the server sends ranges of a packed file (Content-Encoding: " + head_.encoding +
                     "): switch its compression off for this file",
                 name_);
  }
  return fault_of_place();
}

std::optional<Error> HttpTransfer::fault_of_place() {
  if (!head_.first || !head_.last || !head_.total) {
    return Error(ErrorCode::io_error,
                 "the server does not say which bytes it sends, and of how many (Content-Range)",
                 name_);
  }
  identity_ = {*head_.total, head_.etag, head_.modified};
  if (expected_ != nullptr && !expected_->is_that_of(identity_)) return replaced(name_);
  const std::uint64_t asked = range_.offset + range_.out.size();
  const std::uint64_t end = expected_ != nullptr ? asked : std::min(asked, *head_.total);
  if (*head_.first != range_.offset || *head_.last + 1 != end) {
    return Error(ErrorCode::io_error,
                 "the server sent bytes " + std::to_string(*head_.first) + " to " +
                     std::to_string(*head_.last) + ", and " + range_text_ + " were asked for",
                 name_);
  }
  range_.out = range_.out.first(end - range_.offset);
  return std::nullopt;
}

bool HttpTransfer::finish(CURLcode code) {
  if (code == CURLE_OK && !is_judged_) bad_ = fault_of_head();
  if (bad_) {
    failure_ = std::move(bad_);
    return true;
  }
  if (code != CURLE_OK) {
    if (may_pass(code)) {
      return try_again(code == CURLE_OPERATION_TIMEDOUT
                           ? "the server does not answer, or stopped sending"
                       : code == CURLE_PARTIAL_FILE || code == CURLE_GOT_NOTHING
                           ? "the connection ended before the answer did"
                           : curl_easy_strerror(code));
    }
    fail({ErrorCode::io_error, std::string("cannot read: ") + curl_easy_strerror(code), name_});
    return true;
  }
  const long status = head_.status;
  if (status == 206) {
    if (received_ == range_.out.size()) return true;
    return try_again("the answer is shorter than the range");
  }
  if (may_pass(status)) return try_again("the server answers " + std::to_string(status));
  refused_ = status == 401 || status == 403;
  if (refused_) {
    fail({ErrorCode::io_error,
          "the server refuses access (status " + std::to_string(status) +
              "): look at the credentials, and at the region and the name of the object" +
              message_in(words_),
          name_});
  } else if (status == 404 || status == 410) {
    fail({ErrorCode::not_found, "there is no such object (status " + std::to_string(status) + ")",
          name_});
  } else if (status == 412 || (status == 416 && expected_ != nullptr)) {
    failure_ = replaced(name_);
  } else if (status == 416) {
    fail({ErrorCode::corruption, "the object is empty; a .ptin file is expected", name_});
  } else {
    fail({ErrorCode::io_error, "the server answers " + std::to_string(status) + message_in(words_),
          name_});
  }
  return true;
}

/// Sets the time of the next try; true when there is none.
bool HttpTransfer::try_again(const std::string& why) {
  if (tries_ >= std::max(options_.tries, 1)) {
    fail({ErrorCode::io_error,
          why + (tries_ > 1 ? "; " + std::to_string(tries_) + " tries were made" : ""), name_});
    return true;
  }
  const double pause = std::min(
      kMostPauseSeconds, head_.retry_after.value_or(options_.first_pause * std::exp2(tries_ - 1)));
  not_before_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(std::max(pause, 0.0)));
  return false;
}

}  // namespace ptin
