// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fields of CSV.
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "tools/formats/number_text.h"

namespace ptin::tools {

/// Appends a field, in quotes by RFC 4180 where it needs them to be read back as it is.
inline void append_csv_field(std::string& text, std::string_view field) {
  const bool needs_quotes = field.find_first_of(",;\"\r\n\t") != std::string_view::npos ||
                            field.starts_with('#') || field.starts_with(' ') ||
                            field.ends_with(' ');
  if (!needs_quotes) {
    text += field;
    return;
  }
  text += '"';
  for (const char c : field) text.append(c == '"' ? 2 : 1, c);
  text += '"';
}

/// Appends a comma and a number; nothing behind the comma where it is infinite or unknown.
inline void append_csv_number(std::string& text, double value) {
  text += ',';
  if (std::isfinite(value)) append_number(text, value);
}

}  // namespace ptin::tools
