// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/serve_fixture.h"

#include <cctype>

#include "tools/http/etag.h"

namespace ptin::tools::testing {

serve::ServeOptions serve_options(const TestFolder& folder) {
  serve::ServeOptions options;
  options.files = {{"mountains", built(folder, "mountains_257.tif", "mountains.ptin")},
                   {"coast", built(folder, "coast_257.tif", "coast.ptin")}};
  options.http.threads = 2;
  options.version = "test";
  return options;
}

std::string encoded(const std::string& text) {
  std::string code;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '.' || c == '-') {
      code += c;
    } else {
      code += "%" + http::hex_of(byte).substr(14);
    }
  }
  return code;
}

}  // namespace ptin::tools::testing
