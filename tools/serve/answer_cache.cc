// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/answer_cache.h"

namespace ptin::serve {

namespace {

/// What an answer takes beside its body and headers: nodes of the list and the table.
constexpr std::uint64_t kBesideBytes = 512;

}  // namespace

http::Response AnswerCache::shared(const Kept& kept) {
  http::Response response;
  response.content_type = kept.content_type;
  response.headers = kept.headers;
  response.add("Server-Timing", "cache;desc=\"hit\"");
  response.lasting_body = kept.body->text;
  response.held = kept.body;
  return response;
}

std::optional<http::Response> AnswerCache::find(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = places_.find(key);
  if (found == places_.end()) return std::nullopt;
  kept_.splice(kept_.begin(), kept_, found->second);
  return shared(kept_.front());
}

void AnswerCache::keep(const std::string& key, http::Response& response) {
  constexpr std::uint64_t kLargestShare = 16;
  std::uint64_t bytes = kBesideBytes + key.size() + response.body.size();
  for (const auto& [name, value] : response.headers) bytes += name.size() + value.size();
  if (bytes > most_bytes_ / kLargestShare) return;
  // A text that grew has up to twice its bytes, one that was packed as many as it had before.
  response.body.shrink_to_fit();
  const std::lock_guard lock(mutex_);
  if (places_.count(key) != 0) return;  // Two asked at once.
  auto room = room_->lend(bytes);
  if (!room) return;
  Kept made{key, response.content_type, response.headers, std::make_shared<Body>(), bytes};
  made.body->text = std::move(response.body);
  made.body->room = std::move(room);
  response.lasting_body = made.body->text;
  response.held = made.body;
  // What it cost was spent for the first who asked.
  std::erase_if(made.headers, [](const auto& header) { return header.first == "Server-Timing"; });
  kept_.push_front(std::move(made));
  places_.emplace(kept_.front().key, kept_.begin());
  bytes_ += bytes;
  while (bytes_ > most_bytes_) {
    bytes_ -= kept_.back().bytes;
    places_.erase(kept_.back().key);
    kept_.pop_back();
  }
}

std::uint64_t AnswerCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace ptin::serve
