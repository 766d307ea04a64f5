// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/spill_file.h"

#include <algorithm>
#include <utility>

#include "engine/error.h"
#include "storage/file/file_questions.h"
#include "tools/output/output_file.h"

namespace ptin::tools {

namespace {

constexpr std::size_t kSpillBufferBytes = std::size_t{1} << 20;

/// Returns what `act` returns; the errors of `act` name the output, which is the file that the user
/// knows.
template <typename Act>
auto for_output(const std::string& output, const Act& act) {
  try {
    return act();
  } catch (const Error& error) {
    throw Error(error.code(), "its temporary file: " + error.message(), output);
  }
}

}  // namespace

SpillFile::SpillFile(std::string output, FileLayer& files)
    : output_(std::move(output)), file_(for_output(output_, [&] {
        return ScratchFile(files, folder_of(output_), "ptin-spill", true);
      })) {
  buffer_.reserve(kSpillBufferBytes);
}

void SpillFile::write(const void* data, std::size_t bytes) {
  if (buffer_.size() + bytes > kSpillBufferBytes) flush();
  const char* from = static_cast<const char*>(data);
  buffer_.insert(buffer_.end(), from, from + bytes);
}

void SpillFile::flush() {
  for_output(output_, [&] { file_.write_at(std::as_bytes(std::span(buffer_)), written_); });
  written_ += buffer_.size();
  buffer_.clear();
}

std::span<const char> SpillFile::read() {
  if (!reading_) flush();
  reading_ = true;
  buffer_.resize(
      static_cast<std::size_t>(std::min<std::uint64_t>(kSpillBufferBytes, written_ - read_)));
  for_output(output_, [&] { file_.read_at(std::as_writable_bytes(std::span(buffer_)), read_); });
  read_ += buffer_.size();
  return buffer_;
}

}  // namespace ptin::tools
