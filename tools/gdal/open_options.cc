// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/gdal/open_options.h"

#include <array>
#include <string>
#include <string_view>

#include "engine/error.h"
#include "engine/number.h"

namespace ptin::tools {

namespace {

std::optional<double> number_at(CSLConstList options, const char* name, const NumberRange& range) {
  const char* const text = CSLFetchNameValue(options, name);
  if (text == nullptr) return std::nullopt;
  const std::optional<double> number = parse_number<double>(text);
  if (number && range.holds(*number)) return number;
  refuse("\"" + std::string(text) + "\" is not " + words_of(range), name);
}

PixelValue band_at(CSLConstList options) {
  constexpr std::array<const char*, 4> kNames = {"height", "slope", "aspect", "hillshade"};
  const std::string_view text = CSLFetchNameValueDef(options, "BAND", kNames.front());
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (EQUAL(text.data(), kNames.at(i))) return static_cast<PixelValue>(i);
  }
  refuse("\"" + std::string(text) + "\" is not height, slope, aspect or hillshade", "BAND");
}

}  // namespace

const char* const kOpenOptionList =
    "<OpenOptionList>"
    "<Option name='ERROR' type='string' default='AUTO' description='Certified error in the unit of "
    "the heights; 0: exact; AUTO: a TIN as fine as the pixels'/>"
    "<Option name='BAND' type='string-select' default='height' description='What pixels say'>"
    "<Value>height</Value><Value>slope</Value><Value>aspect</Value><Value>hillshade</Value>"
    "</Option>"
    "<Option name='PIXEL_SIZE' type='float' description='Side of a pixel in map units'/>"
    "<Option name='INTERVAL' type='float' description='Distance between the heights of the layer "
    "isolines, which is not there without it'/>"
    "<Option name='MEMORY_MB' type='int' default='1024' description='Most memory of a question'/>"
    "</OpenOptionList>";

OpenOptions open_options_of(CSLConstList options) {
  OpenOptions result;
  if (!EQUAL(CSLFetchNameValueDef(options, "ERROR", "AUTO"), "AUTO")) {
    result.error = number_at(options, "ERROR", NumberRange::kTolerance);
  }
  result.content.value = band_at(options);
  result.pixel_size = number_at(options, "PIXEL_SIZE", NumberRange::kPositive);
  result.interval = number_at(options, "INTERVAL", NumberRange::kPositive);
  if (const auto memory = number_at(options, "MEMORY_MB", {.least = 1, .most = 1e9})) {
    result.memory_bytes = static_cast<std::uint64_t>(*memory) * kMiB;
  }
  return result;
}

}  // namespace ptin::tools
