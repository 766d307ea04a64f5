// SPDX-License-Identifier: GPL-3.0-or-later
//
// The file of a collection, whole or by a range: for whoever keeps a copy, or reads it remotely.
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "tools/http/etag.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Problem;

/// A file that is open for reading.
class Descriptor {
 public:
  explicit Descriptor(const std::string& path) : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (fd_ < 0) throw system_error(errno, "cannot open", path);
  }
  ~Descriptor() { ::close(fd_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void read(std::uint64_t offset, std::span<char> into) const {
    while (!into.empty()) {
      const ssize_t got = ::pread(fd_, into.data(), into.size(), static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) throw Error(ErrorCode::io_error, "the file ends early, or cannot be read");
      into = into.subspan(static_cast<std::size_t>(got));
      offset += static_cast<std::uint64_t>(got);
    }
  }

 private:
  int fd_;
};

/// The first and the last byte of a range.
struct Range {
  std::uint64_t first, last;
};

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

[[noreturn]] void throw_unsatisfiable(const std::string& why, std::uint64_t bytes) {
  throw Problem(416, why).of_bytes(bytes);
}

/// The unit is a word of HTTP: capitals do not matter.
bool is_of_bytes(std::string_view header) {
  constexpr std::string_view kUnit = "bytes=";
  return header.size() >= kUnit.size() &&
         std::equal(kUnit.begin(), kUnit.end(), header.begin(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

/// The range of a header; none where it is of no form that is known, and then is to be ignored (RFC
/// 9110, section 14.2).
std::optional<Range> range_of(std::string_view header, std::uint64_t bytes) {
  if (!is_of_bytes(header)) return std::nullopt;
  header.remove_prefix(header.find('=') + 1);
  if (header.find(',') != std::string_view::npos) {
    throw_unsatisfiable("one range is answered at once; ask for others by requests of their own",
                        bytes);
  }
  const std::size_t dash = header.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto first = whole_number(header.substr(0, dash));
  const auto last = whole_number(header.substr(dash + 1));
  if (!first && dash == 0 && last) {
    if (*last == 0) throw_unsatisfiable("a range of no bytes", bytes);
    return Range{bytes - std::min(bytes, *last), bytes - 1};
  }
  if (!first || (!last && dash + 1 != header.size())) return std::nullopt;
  if (last && *last < *first) return std::nullopt;
  if (*first >= bytes) {
    throw_unsatisfiable(
        "the file has " + std::to_string(bytes) + " bytes, and the range begins behind them",
        bytes);
  }
  return Range{*first, std::min(last.value_or(bytes - 1), bytes - 1)};
}

}  // namespace

http::Response answer_file(const Asked& asked) {
  if (!asked.options.offers_files) {
    throw Problem(403, "this service does not give out its files; it would with --files");
  }
  const StoreFile& store = asked.terrain().store();
  if (store.remote_cost()) {
    throw Problem(403, "the file lies elsewhere, and this service reads parts of it alone");
  }
  const std::optional<FileIdentity> now = identity_of(store.path());
  if (!now) throw Problem(404, "the file is gone; questions are answered from what was open");
  const auto file = std::make_shared<Descriptor>(store.path());
  if (now != asked.collection->identity || identity_of(store.path()) != now) {
    asked.catalogue.check_whole(asked.collection->id);
    throw Problem(409, "the file was replaced at this moment; ask again").retry_after(1);
  }
  const std::string etag = "\"" + asked.collection->fingerprint + "\"";
  http::Response response;
  response.add("ETag", etag);
  response.add("Accept-Ranges", "bytes");
  if (http::names_etag(asked.request.header("if-none-match").value_or(""), etag)) {
    response.status = 304;
    return response;
  }
  const std::uint64_t bytes = store.file_bytes();
  const auto if_range = asked.request.header("if-range");
  const bool is_same = !if_range || *if_range == etag;  // A weak tag does not say that much.
  const bool is_head = asked.request.method == "HEAD";
  const auto header = is_head ? std::nullopt : asked.request.header("range");
  const std::optional<Range> range = header && is_same ? range_of(*header, bytes) : std::nullopt;
  const Range part = range.value_or(Range{0, bytes - 1});
  response.content_type = "application/vnd.ptin";
  response.status = range ? 206 : 200;
  if (range) {
    response.add("Content-Range", "bytes " + std::to_string(part.first) + "-" +
                                      std::to_string(part.last) + "/" + std::to_string(bytes));
  }
  response.long_body = std::make_unique<http::LongBody>();
  response.long_body->bytes = part.last - part.first + 1;
  response.long_body->read = [file, first = part.first](std::uint64_t offset,
                                                        std::span<char> into) {
    file->read(first + offset, into);
  };
  return response;
}

}  // namespace ptin::serve
