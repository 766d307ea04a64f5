// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/text_encoding.h"

namespace ptin {
namespace {

using namespace std::string_view_literals;

std::string not_read(const std::string& name, const std::string& from) {
  return "this text is " + name + "; save it as UTF-8, as with 'iconv -f " + from + " -t UTF-8'";
}

}  // namespace

std::size_t bytes_of_byte_order_mark(std::string_view text) noexcept {
  return text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
}

std::optional<std::string> fault_of_encoding(std::string_view line, bool is_first) {
  if (is_first) {
    if (line.starts_with("\xFF\xFE\0\0"sv) || line.starts_with("\0\0\xFE\xFF"sv)) {
      return not_read("UTF-32", "UTF-32");
    }
    if (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF")) {
      return not_read("UTF-16", "UTF-16");
    }
  }
  const std::size_t zero = line.find('\0');
  if (zero == std::string_view::npos) {
    return std::nullopt;
  }
  // The first of a character's two bytes is 0 where the order is big-endian. A line behind the
  // first one of a little-endian text begins with the second byte of a line end.
  const bool is_little = is_first ? zero % 2 == 1 : zero == 0;
  return "this text has bytes of value 0, as UTF-16 without a byte order mark has; save it as "
         "UTF-8, "
         "as with 'iconv -f UTF-16" +
         std::string(is_little ? "LE" : "BE") + " -t UTF-8', or give a file of text";
}

}  // namespace ptin
