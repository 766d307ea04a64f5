// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/read_only_file.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <boost/interprocess/exceptions.hpp>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/error.h"

namespace ptin {

namespace ip = boost::interprocess;

namespace {

[[noreturn]] void throw_irregular(const std::string& path, const struct stat& facts) {
  const std::string kind = S_ISDIR(facts.st_mode) ? "a folder" : "no regular file";
  refuse("this is " + kind + "; a .ptin file is expected", path);
}

// Looked at before opening, since opening a pipe would wait for its other end.
void require_regular(const std::string& path) {
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0) {
    throw system_error(errno, "cannot open", path);
  }
  if (!S_ISREG(s.st_mode)) {
    throw_irregular(path, s);
  }
}

ip::file_mapping opened(const std::string& path) {
  require_regular(path);
  try {
    return {path.c_str(), ip::read_only};
  } catch (const ip::interprocess_exception& e) {
    throw system_error(e.get_native_error(), "cannot open", path);
  }
}

}  // namespace

ReadOnlyFile::ReadOnlyFile(const std::string& path, std::shared_ptr<Announcer> announcer,
                           ReplacedFile replaced)
    : path_(path), file_(opened(path)), announcer_(std::move(announcer)), replaced_(replaced) {
  ::fcntl(descriptor(), F_SETFD, FD_CLOEXEC);
  seen_ = look();
}

int ReadOnlyFile::descriptor() const noexcept { return file_.get_mapping_handle().handle; }

ReadOnlyFile::Seen ReadOnlyFile::look() const {
  struct stat s {};
  if (::fstat(descriptor(), &s) != 0) {
    throw system_error(errno, "cannot look at the open file", path_);
  }
  // Another file can have taken the name since require_regular() looked at it.
  if (!S_ISREG(s.st_mode)) {
    throw_irregular(path_, s);
  }
  return {static_cast<std::uint64_t>(s.st_size), s.st_mtim.tv_sec, s.st_mtim.tv_nsec,
          s.st_ctim.tv_sec, s.st_ctim.tv_nsec};
}

void ReadOnlyFile::read_at(std::span<std::byte> out, std::uint64_t offset) const {
  while (!out.empty()) {
    const ssize_t n = ::pread(descriptor(), out.data(), out.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) {
      continue;
    }
    if (n < 0) {
      throw system_error(errno, "cannot read at byte " + std::to_string(offset), path_);
    }
    if (n == 0) {
      throw Error(ErrorCode::corruption,
                  "the file ends at byte " + std::to_string(offset) + " and should go on for " +
                      std::to_string(out.size()) + " more; it was cut short",
                  path_);
    }
    out = out.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
}

void ReadOnlyFile::expect_jumps() const noexcept {
  ::posix_fadvise(descriptor(), 0, 0, POSIX_FADV_RANDOM);
}

void ReadOnlyFile::will_need(std::span<const ByteRange> ranges) const noexcept {
  for (const ByteRange& range : ranges) {
    start_reading(range);
  }
}

void ReadOnlyFile::start_reading(const ByteRange& range) const noexcept {
  const auto [offset, bytes] = range;
  if (announcer_) {
    announcer_->announce(descriptor(), offset, bytes);
    return;
  }
  // The kernel cuts one call short at its read-ahead limit, commonly 128 KiB. What it leaves out of
  // a mapping is then faulted in page by page.
  constexpr std::uint64_t kStep = std::uint64_t{128} << 10;
  for (std::uint64_t at = 0; at < bytes; at += kStep) {
    ::posix_fadvise(descriptor(), static_cast<off_t>(offset + at),
                    static_cast<off_t>(std::min(kStep, bytes - at)), POSIX_FADV_WILLNEED);
  }
}

void ReadOnlyFile::check_unchanged() const {
  Seen now = look();
  if (replaced_ == ReplacedFile::kAnswers) {
    now.changed_s = seen_.changed_s;
    now.changed_ns = seen_.changed_ns;
  }
  if (!(now == seen_)) {
    throw Error(ErrorCode::corruption,
                "the file was replaced, cut short or written to while it was open; open it again",
                path_);
  }
}

}  // namespace ptin
