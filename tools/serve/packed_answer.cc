// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/packed_answer.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "tools/http/etag.h"
#include "tools/http/gzip.h"

namespace ptin::serve {

namespace {

/// Smaller answers are sent as they are.
constexpr std::size_t kLeastPacked = 1024;

bool packs_well(std::string_view type) {
  for (const std::string_view known : {"json", "text/", "xml", "javascript", "wasm",
                                       "quantized-mesh", "vector-tile", "gltf-binary", "ply"}) {
    if (type.find(known) != std::string_view::npos) return true;
  }
  return false;
}

}  // namespace

void add_vary(http::Response& response, const std::string& header) {
  for (auto& [name, value] : response.headers) {
    if (name != "Vary") continue;
    value += ", " + header;
    return;
  }
  response.add("Vary", header);
}

void pack(bool takes_gzip, http::Response& response) {
  if (!packs_well(response.content_type) || response.long_body) return;
  add_vary(response, "Accept-Encoding");
  const bool is_packed = std::any_of(response.headers.begin(), response.headers.end(),
                                     [](const auto& h) { return h.first == "Content-Encoding"; });
  if (response.body_bytes() < kLeastPacked || is_packed || !takes_gzip) return;
  response.body = http::gzip(response.lasting_body.empty() ? response.body : response.lasting_body);
  response.lasting_body = {};
  response.add("Content-Encoding", "gzip");
  for (auto& [name, value] : response.headers) {
    if (name == "ETag") value = http::gzip_etag_of(value);
  }
}

}  // namespace ptin::serve
