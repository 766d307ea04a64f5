// SPDX-License-Identifier: GPL-3.0-or-later
//
// The file of a collection, whole or by a range: for whoever keeps a copy, or reads it remotely.
#include <cerrno>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "tools/http/preconditions.h"
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
  response.add("Last-Modified", http::date_text(now->seconds));
  if (http::is_unchanged(asked.request, etag, now->seconds)) {
    response.status = 304;
    return response;
  }
  response.content_type = "application/vnd.ptin";
  response.long_body = std::make_unique<http::LongBody>();
  response.long_body->bytes = store.file_bytes();
  response.long_body->read = [file](std::uint64_t offset, std::span<char> into) {
    file->read(offset, into);
  };
  return response;
}

}  // namespace ptin::serve
