// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/facts/human.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string_view>

#include "engine/error.h"
#include "engine/number.h"

namespace ptin::tools {

std::string grouped(std::uint64_t n) {
  std::string text = std::to_string(n);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ',');
  return text;
}

std::string counted(std::uint64_t n, const std::string& one, const std::string& plural) {
  return grouped(n) + " " + (n == 1 ? one : plural.empty() ? one + "s" : plural);
}

namespace {

/// A decimal number with commas between groups of three digits before the point.
std::string in_groups(std::string text) {
  const std::size_t first = text.starts_with('-') ? 1 : 0;
  std::size_t at = std::min(text.find('.'), text.size());
  for (; at > first + 3; at -= 3) text.insert(at - 3, ",");
  return text;
}

}  // namespace

std::string grouped_number(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.10g", value == 0 ? 0.0 : value);
  std::string text = digits;
  if (!std::isfinite(value) || text.find('e') != std::string::npos) return text;
  return in_groups(std::move(text));
}

std::string grouped_number(double value, double uncertain) {
  constexpr int kDigits = 7;
  const double size = std::abs(value);
  if (!(size >= 1e-4 && size < 1e15)) return grouped_number(value);
  const int before = std::max(1, static_cast<int>(std::floor(std::log10(size))) + 1);
  const double certain =
      uncertain > 0 ? std::floor(-std::log10(2 * uncertain)) : static_cast<double>(kDigits);
  const int decimals =
      static_cast<int>(std::clamp(certain, 0.0, std::max(0.0, 1.0 * kDigits - before)));
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.*f", decimals, value);
  std::string text = digits;
  if (decimals > 0) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return in_groups(std::move(text));
}

std::string plural_of(const std::string& unit) {
  constexpr std::string_view kFoot = "foot";
  if (unit.ends_with(kFoot)) return unit.substr(0, unit.size() - kFoot.size()) + "feet";
  return unit + "s";
}

std::string human_bytes(std::uint64_t bytes) {
  if (bytes < 1024) return std::to_string(bytes).append(" bytes");
  const char* const units[] = {"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  double value = static_cast<double>(bytes) / 1024.0;
  std::size_t unit = 0;
  for (; value >= 1024.0 && unit < 5; ++unit) value /= 1024.0;
  char text[32];
  std::snprintf(text, sizeof text, "%.*f %s", value < 10 ? 2 : 1, value, units[unit]);
  return text;
}

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text,
                std::abs(value) >= 1e5 && std::abs(value) < 1e15 ? "%.2f" : "%.6g", value);
  std::string shown = text;
  if (shown.find('.') != std::string::npos && shown.find('e') == std::string::npos) {
    while (shown.back() == '0') shown.pop_back();
    if (shown.back() == '.') shown.pop_back();
  }
  return shown;
}

std::string human_duration(double seconds) {
  std::array<char, 32> text{};
  if (seconds < 120.0) {
    std::snprintf(text.data(), text.size(), "%.0f s", std::max(1.0, seconds));
  } else if (seconds < 7200.0) {
    std::snprintf(text.data(), text.size(), "%.0f min", seconds / 60.0);
  } else {
    std::snprintf(text.data(), text.size(), "%.1f h", seconds / 3600.0);
  }
  return text.data();
}

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return (c >= '\0' && c < ' ') || c == '\x7f'; }, '?');
  return text;
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 64;
  if (text.size() <= kMost) return std::string(text);
  std::size_t end = kMost;  // Bytes that go on with a character are 10xxxxxx.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return std::string(text.substr(0, end)) + "...";
}

std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines;
  std::istringstream given(text);
  for (std::string line; std::getline(given, line);) {
    std::size_t begin = 0;
    while (line.size() - begin > width) {
      std::size_t end = line.rfind(' ', begin + width);
      if (end == std::string::npos || end <= begin) end = line.find(' ', begin + width);
      if (end == std::string::npos) break;
      lines.push_back(line.substr(begin, end - begin));
      begin = end + 1;
    }
    lines.push_back(line.substr(begin));
  }
  return lines;
}

std::string shell_word(const std::string& name) {
  const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("-_./+,:=@%").find(c) != std::string_view::npos;
  });
  if (is_plain && !name.empty()) return name;
  std::string word = "'";
  for (const char c : name) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string exact_number(double value) {
  std::array<char, 32> text{};
  const auto [end, fault] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

std::uint64_t parse_bytes(const std::string& text, const std::string& option) {
  std::string_view rest = text;
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
  const double value = take_number<double>(rest).value_or(-1.0);
  double factor = 1.0;
  if (!rest.empty()) {
    const std::string suffixes = "KMGT";
    const std::size_t place = suffixes.find(static_cast<char>(std::toupper(rest.front())));
    rest.remove_prefix(1);
    factor = place == std::string::npos || !(rest.empty() || rest == "B" || rest == "iB")
                 ? -1.0
                 : std::pow(1024.0, static_cast<double>(place + 1));
  }
  if (!(value > 0) || factor < 0 || value * factor > 1e18) {
    throw Error(ErrorCode::invalid_argument,
                std::string("not a size: ").append(text).append("; write it as 512M or 2G"),
                option);
  }
  return static_cast<std::uint64_t>(value * factor);
}

std::uint64_t parse_memory(const std::string& text, const std::string& option) {
  const std::uint64_t bytes = parse_bytes(text, option);
  const bool has_suffix = std::isalpha(static_cast<unsigned char>(text.back())) != 0;
  constexpr std::uint64_t kFewestBytes = 65536;
  if (has_suffix || bytes >= kFewestBytes) return bytes;
  throw Error(ErrorCode::invalid_argument,
              text + " is " + counted(bytes, "byte") + "; did you mean " + text +
                  (bytes < 16 ? "G?" : "M?"),
              option);
}

}  // namespace ptin::tools
