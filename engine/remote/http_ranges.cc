// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/remote/http_ranges.h"

#include <algorithm>
#include <utility>

#include "engine/stop.h"

namespace ptin {

namespace {

/// So long is waited for a server before it is looked whether a stop was requested.
constexpr int kLookMilliseconds = 50;

void require_curl() {
  static const bool is_ready = curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
  if (!is_ready) {
    throw Error(ErrorCode::io_error, "libcurl cannot be used on this system");
  }
}

}  // namespace

HttpRanges::HttpRanges(std::string name, ObjectUrl url, const RemoteOptions& options)
    : name_(std::move(name)), url_(std::move(url)), options_(options) {
  require_curl();
  multi_.reset(curl_multi_init());
  if (!multi_) throw std::bad_alloc();
  // As many are kept as may be under way, which `running_` bounds: transfers that curl itself makes wait
  // for a connection may wait for ever (its issues 2369, 21396).
  curl_multi_setopt(multi_.get(), CURLMOPT_MAXCONNECTS, long{kMostRequests});
  front_.resize(kFrontBytes);
  Round round;
  round.transfers.emplace_back(name_, RangeRead{0, front_}, nullptr, options_);
  run(round);
  identity_ = round.transfers[0].identity();
  front_.resize(round.transfers[0].received());
}

void HttpRanges::read(std::span<const RangeRead> ranges) {
  Round round;
  round.transfers.reserve(ranges.size());
  for (const RangeRead& range : ranges) {
    if (!range.out.empty()) round.transfers.emplace_back(name_, range, &identity_, options_);
  }
  run(round);
}

/// Waits until all transfers of a round are done. Throws what the first of them failed by.
void HttpRanges::run(Round& round) {
  std::unique_lock lock(mutex_);
  for (HttpTransfer& transfer : round.transfers) {
    waiting_.push_back({&transfer, &round});
    ++round.left;
  }
  if (is_driven_) curl_multi_wakeup(multi_.get());
  const auto leave = [&] {
    moved_.wait(lock, [&] { return !is_driven_; });
    forget(round);
    moved_.notify_all();
  };
  try {
    while (round.left > 0) {
      stop_if_asked(options_.stop, "reading from the server", name_);
      if (is_driven_) {
        moved_.wait_for(lock, std::chrono::milliseconds(kLookMilliseconds));
      } else {
        drive(lock);
      }
      const auto failed = std::find_if(round.transfers.begin(), round.transfers.end(),
                                       [](const HttpTransfer& t) { return t.failure(); });
      if (failed != round.transfers.end()) throw *failed->failure();
    }
  } catch (...) {
    leave();  // the rest of the round is of no use
    throw;
  }
}

/// One step for all rounds: begins what may begin, waits for bytes, takes what is done.
void HttpRanges::drive(std::unique_lock<std::mutex>& lock) {
  start_what_may();
  is_driven_ = true;
  lock.unlock();
  int running = 0;
  CURLMcode code = curl_multi_perform(multi_.get(), &running);
  if (code == CURLM_OK) {
    code = curl_multi_poll(multi_.get(), nullptr, 0, kLookMilliseconds, nullptr);
  }
  if (code == CURLM_OK) {
    code = curl_multi_perform(multi_.get(), &running);
  }
  lock.lock();
  is_driven_ = false;
  reap();
  moved_.notify_all();
  if (code != CURLM_OK) {
    throw Error(ErrorCode::io_error, std::string("cannot read: ") + curl_multi_strerror(code),
                name_);
  }
}

void HttpRanges::start_what_may() {
  const auto now = HttpTransfer::Clock::now();
  for (std::size_t left = waiting_.size(); left > 0 && running_.size() < kMostRequests; --left) {
    Waiting work = waiting_.front();
    waiting_.pop_front();
    if (work.transfer->not_before() > now) {
      waiting_.push_back(work);
      continue;
    }
    try {
      start(work);
    } catch (const Error& error) {  // The thread whose transfer it is throws it.
      work.transfer->fail(error);
      --work.round->left;
    }
  }
}

void HttpRanges::start(const Waiting& work) {
  CurlHandle handle;
  if (idle_.empty()) {
    handle.reset(curl_easy_init());
    if (!handle) {
      throw Error(ErrorCode::resource_exhausted, "there is no memory for a connection", name_);
    }
  } else {
    handle = std::move(idle_.back());
    idle_.pop_back();
  }
  work.transfer->begin(handle.get(), url_.get(work.is_second_url));
  curl_multi_add_handle(multi_.get(), handle.get());
  running_.push_back({std::move(handle), work});
}

void HttpRanges::reap() {
  int left = 0;
  while (const CURLMsg* const message = curl_multi_info_read(multi_.get(), &left)) {
    if (message->msg != CURLMSG_DONE) continue;
    const auto done = std::find_if(running_.begin(), running_.end(), [&](const Running& r) {
      return r.handle.get() == message->easy_handle;
    });
    const CURLcode code = message->data.result;
    curl_multi_remove_handle(multi_.get(), done->handle.get());
    Waiting work = done->work;
    idle_.push_back(std::move(done->handle));
    running_.erase(done);
    if (!work.transfer->finish(code)) {
      waiting_.push_back(work);
    } else if (work.transfer->was_refused() && url_.is_signed && !work.is_second_url) {
      work.is_second_url = true;  // The URL may be too old, or the credentials changed.
      work.transfer->forgive();
      waiting_.push_back(work);
    } else {
      --work.round->left;
    }
  }
}

/// Takes back what of a round is not done.
void HttpRanges::forget(const Round& round) {
  std::erase_if(waiting_, [&](const Waiting& w) { return w.round == &round; });
  std::erase_if(running_, [&](const Running& r) {
    if (r.work.round != &round) return false;
    curl_multi_remove_handle(multi_.get(), r.handle.get());
    return true;
  });
}

}  // namespace ptin
