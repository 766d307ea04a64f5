// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/viewer_page.h"

#include <algorithm>

#include "engine/check.h"

namespace ptin::tools {

namespace {

constexpr std::string_view kIndex = "index.html";
constexpr std::string_view kNoStream = R"(<meta name="ptin-stream" content="">)";
constexpr std::string_view kPolicy = R"(<meta http-equiv="Content-Security-Policy" content=")";
constexpr std::string_view kAnyHost = "https: http:";
constexpr std::string_view kHeadEnd = "</head>";

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '_' || c == '-' || c == '~';
}

/// A file name as a relative address. What comes out holds nothing that HTML would read, and with
/// its `./` no scheme.
std::string address_of(std::string_view name) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string address = "./";
  for (const char c : name) {
    if (is_plain(c)) {
      address += c;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    address.append({'%', kDigits[byte >> 4], kDigits[byte & 15U]});
  }
  return address;
}

std::string_view index_page() {
  const auto files = viewer_files();
  const auto index = std::find_if(files.begin(), files.end(),
                                  [](const ViewerFile& file) { return file.name == kIndex; });
  PTIN_CHECK(index != files.end());
  return index->content;
}

}  // namespace

std::string viewer_page_with(std::string_view first_mesh) {
  std::string page(index_page());
  const std::size_t at = page.find(kHeadEnd);
  PTIN_CHECK(at != std::string::npos);
  page.insert(at, first_mesh);
  return page;
}

std::string viewer_page_for(std::string_view stream, std::string_view first_mesh) {
  std::string page = viewer_page_with(first_mesh);
  const std::size_t at = page.find(kNoStream);
  PTIN_CHECK(at != std::string::npos);
  page.insert(at + kNoStream.size() - std::string_view("\">").size(), address_of(stream));
  return page;
}

std::string viewer_policy(bool in_frames, std::optional<std::string_view> asked) {
  const std::string_view page = index_page();
  const std::size_t begin = page.find(kPolicy);
  PTIN_CHECK(begin != std::string_view::npos);
  const std::string_view said = page.substr(begin + kPolicy.size());
  std::string policy(said.substr(0, said.find('"')));
  if (asked) {
    const std::size_t at = policy.find(kAnyHost);
    PTIN_CHECK(at != std::string::npos);
    policy.replace(at, kAnyHost.size(), *asked);
  }
  return policy + "; frame-ancestors " + (in_frames ? "*" : "'self'");
}

}  // namespace ptin::tools
