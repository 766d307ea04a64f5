// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/remote/vsi_ranges.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include <cpl_error.h>

#include "engine/error.h"
#include "engine/remote/http_ranges.h"
#include "engine/stop.h"

namespace ptin {

namespace {

/// What GDAL said last, as the end of a sentence.
std::string words_of_gdal() {
  const std::string words = CPLGetLastErrorMsg();
  return words.empty() ? "" : ": " + words;
}

}  // namespace

VsiRanges::VsiRanges(std::string name, const std::string& path, const RemoteOptions& options)
    : name_(std::move(name)), options_(options) {
  CPLErrorReset();
  VSIStatBufL facts;
  file_ = VSIFOpenExL(path.c_str(), "rb", TRUE);
  if (file_ == nullptr || VSIStatL(path.c_str(), &facts) != 0) {
    const std::string words = words_of_gdal();
    if (file_ != nullptr) VSIFCloseL(file_);
    throw Error(ErrorCode::not_found, "there is no such object, or GDAL cannot open it" + words,
                name_);
  }
  bytes_ = static_cast<std::uint64_t>(facts.st_size);
  front_.resize(std::min<std::uint64_t>(HttpRanges::kFrontBytes, bytes_));
  try {
    const RangeRead front{0, front_};
    read(std::span(&front, 1));
  } catch (...) {
    VSIFCloseL(file_);
    throw;
  }
}

VsiRanges::~VsiRanges() { VSIFCloseL(file_); }

void VsiRanges::read(std::span<const RangeRead> ranges) {
  const std::lock_guard lock(mutex_);
  for (std::size_t at = 0; at < ranges.size(); at += HttpRanges::kMostRequests) {
    const auto part = ranges.subspan(at, std::min(HttpRanges::kMostRequests, ranges.size() - at));
    double pause = options_.first_pause;
    for (int tries = 1; !try_reading(part); ++tries, pause *= 2) {
      stop_if_asked(options_.stop, "reading from the server", name_);
      if (tries >= options_.tries) {
        throw Error(ErrorCode::io_error, "GDAL cannot read the object" + words_of_gdal(), name_);
      }
      std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    }
  }
}

bool VsiRanges::try_reading(std::span<const RangeRead> ranges) {
  CPLErrorReset();
  if (ranges.size() == 1) {
    const RangeRead& r = ranges[0];
    return r.out.empty() || (VSIFSeekL(file_, r.offset, SEEK_SET) == 0 &&
                             VSIFReadL(r.out.data(), 1, r.out.size(), file_) == r.out.size());
  }
  std::vector<void*> to;
  std::vector<vsi_l_offset> offsets;
  std::vector<std::size_t> sizes;
  for (const RangeRead& r : ranges) {
    to.push_back(r.out.data());
    offsets.push_back(r.offset);
    sizes.push_back(r.out.size());
  }
  return VSIFReadMultiRangeL(static_cast<int>(ranges.size()), to.data(), offsets.data(),
                             sizes.data(), file_) == 0;
}

}  // namespace ptin
