// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/byte_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <sys/stat.h>

#include "engine/construct/read/line_end.h"
#include "engine/construct/read/text_encoding.h"
#include "engine/error.h"

namespace ptin {

namespace {
constexpr std::size_t kBlockBytes = std::size_t{256} << 10;
}

ByteReader::ByteReader(std::string path)
    : path_(std::move(path)), file_(std::fopen(path_.c_str(), "rbe")) {
  if (!file_) {
    throw system_error(errno, "cannot open the file", path_);
  }
  struct stat status {};
  if (fstat(fileno(file_.get()), &status) != 0) {
    throw system_error(errno, "cannot look at the open file", path_);
  }
  if (S_ISDIR(status.st_mode)) {
    throw Error(ErrorCode::invalid_argument, "this is a folder; give a file", path_);
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
  buffer_.resize(kBlockBytes);
}

ByteReader::ByteReader(std::string name, std::string content)
    : path_(std::move(name)), buffer_(content.begin(), content.end()), end_(content.size()) {
  size_ = content.size();
}

void ByteReader::want(std::size_t count) {
  if (end_ - begin_ >= count || !file_) {
    return;
  }
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  while (end_ < count) {
    const std::size_t n = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
    end_ += n;
    if (n == 0) {
      if (std::ferror(file_.get()) != 0) {
        throw system_error(errno, "cannot read the file", path_);
      }
      return;
    }
  }
}

bool ByteReader::line(std::string_view& text) {
  want(1);
  if (begin_ == end_) {
    return false;
  }
  const auto find = [&] {
    const char* from = buffer_.data() + begin_;
    return end_of_line(from, from + std::min(end_ - begin_, kLongest));
  };
  const char* end = find();
  if (end == nullptr || end + 1 == buffer_.data() + end_) {
    want(kLongest + 2);
    end = find();
  }
  ++line_;
  const char* const from = buffer_.data() + begin_;
  if (end == nullptr && end_ - begin_ >= kLongest) {
    throw Error(ErrorCode::invalid_argument, "this line is longer than 64 KiB", place());
  }
  const std::size_t length = end != nullptr ? static_cast<std::size_t>(end - from) : end_ - begin_;
  std::size_t passed = length;
  if (end != nullptr) {
    passed += only_cr_ ? 1 : bytes_of_line_end(end, buffer_.data() + end_);
  }
  ended_in_cr_ = end != nullptr && *end == '\r' && passed == length + 1;
  text = {from, length};
  if (line_ == 1) {
    if (const auto fault = fault_of_encoding(text, true)) {
      throw Error(ErrorCode::invalid_argument, *fault, place());
    }
    text.remove_prefix(bytes_of_byte_order_mark(text));
  }
  take(passed);
  return true;
}

std::span<const char> ByteReader::bytes(std::size_t count) {
  want(count);
  const std::size_t n = std::min({count, end_ - begin_, kLongest});
  const char* const from = buffer_.data() + begin_;
  take(n);
  return {from, n};
}

void refuse_at(const ByteReader& in, const std::string& sentence) {
  throw Error(ErrorCode::invalid_argument, sentence, in.place());
}

}  // namespace ptin
