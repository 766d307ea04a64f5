// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/preconditions.h"

#include <array>
#include <ctime>
#include <string_view>

#include "tools/http/etag.h"
#include "tools/http/list_header.h"
#include "tools/http/problem.h"

namespace ptin::http {

namespace {

constexpr std::array<std::string_view, 7> kDays = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
constexpr std::array<std::string_view, 12> kMonths = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                      "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};

/// Whether a list of tags stands for what there is. A star does for whatever there is.
bool names(std::string_view list, const std::string& etag, bool weak_too) {
  return list == "*" || names_etag(list, etag, weak_too);
}

std::string header_of(const Response& response, std::string_view name) {
  for (const auto& [known, value] : response.headers) {
    if (known == name) return value;
  }
  return {};
}

std::optional<std::int64_t> date_of(const Request& request, std::string_view name) {
  const auto text = request.header(name);
  return text ? seconds_of_date(std::string(*text)) : std::nullopt;
}

}  // namespace

void check_preconditions(const Request& request, Response& response) {
  const std::string etag = header_of(response, "ETag");
  if (etag.empty() || (response.status != 200 && response.status != 304)) return;
  bool holds = true;
  if (const std::string known = list_of(request, "if-match"); !known.empty()) {
    holds = names(known, etag, false);
  } else if (const auto date = date_of(request, "if-unmodified-since")) {
    const auto modified = seconds_of_date(header_of(response, "Last-Modified"));
    holds = !modified || *modified <= *date;
  }
  if (holds) return;
  response =
      Problem(412, "what is here is not in the state that the request names; ask for it anew")
          .response();
}

bool is_unchanged(const Request& request, const std::string& etag, std::int64_t modified) {
  if (const std::string known = list_of(request, "if-none-match"); !known.empty()) {
    return names(known, etag, true);
  }
  const auto date = date_of(request, "if-modified-since");
  return date && modified <= *date;
}

std::string date_text(std::int64_t seconds) {
  const auto time = static_cast<std::time_t>(seconds);
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  std::array<char, 32> text{};
  // Names of days and months would be those of a locale.
  const std::size_t n = std::strftime(text.data(), text.size(), ", %d xxx %Y %H:%M:%S GMT", &parts);
  std::string date(kDays[static_cast<std::size_t>(parts.tm_wday)]);
  date.append(text.data(), n);
  return date.replace(date.find("xxx"), 3, kMonths[static_cast<std::size_t>(parts.tm_mon)]);
}

std::optional<std::int64_t> seconds_of_date(const std::string& text) {
  std::tm parts{};
  const char* const end = ::strptime(text.c_str(), "%a, %d %b %Y %H:%M:%S GMT", &parts);
  if (end == nullptr || *end != '\0') return std::nullopt;
  return ::timegm(&parts);
}

}  // namespace ptin::http
