// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/scratch/manifest.h"

#include <array>
#include <charconv>
#include <utility>

#include <nlohmann/json.hpp>

#include "storage/file/checksum.h"
#include "storage/file/file_questions.h"

namespace ptin {

namespace {

constexpr std::size_t kChecksumDigits = 16;

std::string checksum_text(const std::string& text) {
  std::array<char, kChecksumDigits> digits{};
  const std::uint64_t checksum = checksum_of(std::as_bytes(std::span(text)));
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), checksum, 16).ptr;
  const std::string shown(digits.data(), end);
  return std::string(kChecksumDigits - shown.size(), '0') + shown;
}

}  // namespace

Manifest::Manifest(FileLayer& files, const std::string& path)
    : path_(path), file_(files, path, ScratchFile::kept_at(path)) {
  read();
}

Manifest::~Manifest() = default;

void Manifest::read() {
  std::string text(bytes_of_file(path_), '\0');
  file_.read_at(std::as_writable_bytes(std::span(text)), 0);
  while (true) {
    const std::size_t end = text.find('\n', bytes_);
    if (end == std::string::npos || end - bytes_ <= kChecksumDigits + 1) {
      break;
    }
    const std::string body =
        text.substr(bytes_ + kChecksumDigits + 1, end - bytes_ - kChecksumDigits - 1);
    if (text.compare(bytes_, kChecksumDigits, checksum_text(body)) != 0) {
      break;
    }
    for (nlohmann::json& entry : nlohmann::json::parse(body)) {
      entries_.push_back(std::move(entry));
    }
    bytes_ = end + 1;
  }
  file_bytes_ = text.size();
}

void Manifest::append(const std::vector<nlohmann::json>& group) {
  // Names of files need not be UTF-8.
  const std::string body =
      nlohmann::json(group).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const std::string text = checksum_text(body) + ' ' + body + '\n';
  if (has_more()) {
    file_.truncate(bytes_);
  }
  file_.write_at(std::as_bytes(std::span(text)), bytes_);
  file_bytes_ = bytes_ += text.size();
  file_.sync();
}

}  // namespace ptin
