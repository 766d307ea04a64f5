// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/xml_encoding.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <iconv.h>

#include "engine/handle.h"

namespace ptin {
namespace {

// NOLINTNEXTLINE(performance-no-int-to-ptr): how POSIX says that there is none
const auto kNoConverter = reinterpret_cast<iconv_t>(-1);

/// The one character that some bytes are, as expat takes it; -1 where they are none.
int character_of(iconv_t converter, const char* bytes, std::size_t count) {
  std::array<char, 2> in{};
  std::memcpy(in.data(), bytes, count);
  std::array<char, 16> out{};
  char* from = in.data();
  char* to = out.data();
  std::size_t left = count, room = out.size();
  iconv(converter, nullptr, nullptr, nullptr, nullptr);
  const std::size_t result = iconv(converter, &from, &left, &to, &room);
  std::uint32_t code = 0;
  if (result == static_cast<std::size_t>(-1) || left != 0 || room != out.size() - sizeof code) {
    return -1;
  }
  std::memcpy(&code, out.data(), sizeof code);
  constexpr std::uint32_t kMost = 0xFFFF;  // expat takes no more
  return code <= kMost ? static_cast<int>(code) : -1;
}

int XMLCALL convert_pair(void* converter, const char* bytes) {
  return character_of(static_cast<iconv_t>(converter), bytes, 2);
}

void XMLCALL release(void* converter) { iconv_close(static_cast<iconv_t>(converter)); }

}  // namespace

int XMLCALL find_xml_encoding(void* /*ignored*/, const XML_Char* name, XML_Encoding* to) {
  const iconv_t opened = iconv_open("UTF-32LE", name);
  if (opened == kNoConverter) {
    return XML_STATUS_ERROR;
  }
  Handle<void, &iconv_close> converter(opened);
  for (int byte = 0; byte < 256; ++byte) {
    const char text = static_cast<char>(byte);
    const int character = character_of(opened, &text, 1);
    // A byte that is no character by itself may be the first half of one. XML is written in ASCII.
    to->map[byte] = byte < 0x80 ? byte : character >= 0 ? character : -2;
    if (byte < 0x80 && character != byte && byte >= 0x20 && byte != '\\' && byte != '~') {
      return XML_STATUS_ERROR;
    }
  }
  to->convert = convert_pair;
  to->release = release;
  to->data = converter.release();
  return XML_STATUS_OK;
}

}  // namespace ptin
