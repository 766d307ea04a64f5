// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/spill_file.h"

#include <cerrno>
#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>

#include "engine/error.h"
#include "tools/output_file.h"

namespace ptin::tools {

namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

int open_nameless(const std::string& folder) {
  int fd = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (fd < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL || errno == ENOENT)) {
    std::string name = folder + "/.ptin-spill-XXXXXX";  // a file system without nameless files
    fd = mkostemp(name.data(), O_CLOEXEC);
    if (fd >= 0) unlink(name.c_str());
  }
  return fd;
}

}  // namespace

SpillFile::SpillFile(std::string output)
    : output_(std::move(output)), fd_(open_nameless(folder_of(output_))) {
  if (fd_ < 0) throw system_error(errno, "cannot create a temporary file", output_);
  buffer_.reserve(kBufferBytes);
}

SpillFile::~SpillFile() { close(fd_); }

void SpillFile::write(const void* data, std::size_t bytes) {
  if (buffer_.size() + bytes > kBufferBytes) flush();
  const char* from = static_cast<const char*>(data);
  buffer_.insert(buffer_.end(), from, from + bytes);
}

void SpillFile::flush() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t n = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw system_error(errno, "cannot write a temporary file", output_);
    done += static_cast<std::size_t>(n);
  }
  buffer_.clear();
}

std::span<const char> SpillFile::read() {
  if (!reading_) flush();
  reading_ = true;
  buffer_.resize(kBufferBytes);
  ssize_t n = 0;
  do {
    n = pread(fd_, buffer_.data(), buffer_.size(), static_cast<off_t>(at_));
  } while (n < 0 && errno == EINTR);
  if (n < 0) throw system_error(errno, "cannot read a temporary file", output_);
  at_ += static_cast<std::uint64_t>(n);
  return {buffer_.data(), static_cast<std::size_t>(n)};
}

}  // namespace ptin::tools
