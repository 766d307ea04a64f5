// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/remote/remote_file.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <utility>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include "engine/error.h"
#include "engine/handle.h"
#include "engine/remote/http_ranges.h"
#include "engine/remote/vsi_ranges.h"

namespace ptin {

namespace {

struct Scheme {
  std::string_view begin, vsi;  ///< "s3://bucket/key" is "/vsis3/bucket/key".
  const char* unsigned_option;  ///< GDAL's option that wants no signature.
};
constexpr std::array<Scheme, 3> kStores{{{"s3://", "/vsis3/", "AWS_NO_SIGN_REQUEST"},
                                         {"gs://", "/vsigs/", "GS_NO_SIGN_REQUEST"},
                                         {"az://", "/vsiaz/", "AZURE_NO_SIGN_REQUEST"}}};

/// GDAL's numbers for all HTTP requests, where they are set, before ours.
RemoteOptions configured(RemoteOptions options) {
  const auto number = [](const char* name, double otherwise) {
    const char* const text = CPLGetConfigOption(name, nullptr);
    return text != nullptr && *text != '\0' ? std::max(CPLAtof(text), 0.0) : otherwise;
  };
  options.tries =
      static_cast<int>(std::min(number("GDAL_HTTP_MAX_RETRY", options.tries - 1), 100.0) + 1);
  options.first_pause = number("GDAL_HTTP_RETRY_DELAY", options.first_pause);
  options.most_seconds_to_connect = static_cast<long>(
      number("GDAL_HTTP_CONNECTTIMEOUT", static_cast<double>(options.most_seconds_to_connect)));
  options.most_silent_seconds = static_cast<long>(
      number("GDAL_HTTP_LOW_SPEED_TIME", static_cast<double>(options.most_silent_seconds)));
  return options;
}

/// The URL of an object in a store, signed by GDAL with the credentials that it finds; empty: it
/// cannot. It is taken again before it ages, since it is good for an hour.
class SignedUrl {
 public:
  explicit SignedUrl(std::string path) : path_(std::move(path)) {}

  std::string get(bool anew) {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (url_.empty() || anew || now - taken_ > std::chrono::minutes(15)) {
      CPLStringList options;
      options.SetNameValue("EXPIRATION_DELAY", "3600");
      options.SetNameValue("VERB", "GET");
      const Handle<char, &VSIFree> url(VSIGetSignedURL(path_.c_str(), options.List()));
      url_ = url ? url.get() : "";
      taken_ = now;
    }
    return url_;
  }

 private:
  std::string path_;
  std::mutex mutex_;
  std::string url_;
  std::chrono::steady_clock::time_point taken_;
};

std::shared_ptr<RangeSource> open_url(const std::string& name, std::string url,
                                      const RemoteOptions& options) {
  return std::make_shared<HttpRanges>(
      name, ObjectUrl{[url = std::move(url)](bool) { return url; }, false}, options);
}

std::shared_ptr<RangeSource> open_in_store(const std::string& name, const std::string& path,
                                           const char* unsigned_option,
                                           const RemoteOptions& options) {
  if (CPLTestBool(CPLGetConfigOption(unsigned_option, "NO"))) {
    const char* const url = VSIGetActualURL(path.c_str());
    if (url != nullptr) return open_url(name, url, options);
  } else if (const auto url = std::make_shared<SignedUrl>(path); !url->get(false).empty()) {
    return std::make_shared<HttpRanges>(
        name, ObjectUrl{[url](bool anew) { return url->get(anew); }, true}, options);
  }
  return std::make_shared<VsiRanges>(name, path, options);
}

}  // namespace

bool is_remote(const std::string& name) noexcept {
  const std::string_view n = name;
  return n.starts_with("http://") || n.starts_with("https://") || n.starts_with("/vsi") ||
         std::any_of(kStores.begin(), kStores.end(),
                     [&](const Scheme& s) { return n.starts_with(s.begin); });
}

std::shared_ptr<RangeSource> open_remote(const std::string& name, const RemoteOptions& given) {
  const RemoteOptions options = configured(given);
  constexpr std::string_view kCurl = "/vsicurl/";
  if (name.starts_with("http")) return open_url(name, name, options);
  if (name.starts_with(kCurl)) return open_url(name, name.substr(kCurl.size()), options);
  for (const Scheme& s : kStores) {
    if (name.starts_with(s.begin)) {
      const std::string path = std::string(s.vsi) + name.substr(s.begin.size());
      return open_in_store(name, path, s.unsigned_option, options);
    }
    if (name.starts_with(s.vsi)) return open_in_store(name, name, s.unsigned_option, options);
  }
  return std::make_shared<VsiRanges>(name, name, options);
}

std::shared_ptr<const StoreFile> open_remote_store(const std::string& name,
                                                   const RemoteOptions& options) {
  return StoreFile::open(open_remote(name, options), options.caches);
}

}  // namespace ptin
