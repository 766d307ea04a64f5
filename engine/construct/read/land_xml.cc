// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/land_xml.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <utility>

#include <expat.h>
#include <iconv.h>

#include "engine/construct/read/tin_reader.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"

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

/// An unknown encoding handler of expat: encodings of one byte a character, as Windows-1252, and of
/// up to two, as Shift JIS.
/// @param name  As the XML declaration has it.
/// @return  XML_STATUS_OK, or XML_STATUS_ERROR where nobody knows it, or it is of another kind.
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

constexpr int kDeepest = 64;                       // elements inside of elements
constexpr int kUnitsDepth = 3;                     // LandXML/Units/Metric
constexpr std::uint64_t kLongestToken = 1U << 20;  // bytes without an event

constexpr std::size_t kLongestName = 100;  // in a message

/// True for digits that are not all 0.
bool is_code(std::string_view text) {
  return !text.empty() && text.size() < 10 &&
         text.find_first_not_of("0123456789") == std::string_view::npos &&
         text.find_first_not_of('0') != std::string_view::npos;
}

std::string_view local_name(const XML_Char* name) {
  const std::string_view all(name);
  const std::size_t colon = all.rfind(':');
  return colon == std::string_view::npos ? all : all.substr(colon + 1);
}

}  // namespace

LandXmlElements::LandXmlElements(ByteReader& in) : in_(in), parser_(XML_ParserCreate(nullptr)) {
  if (!parser_) {
    throw Error(ErrorCode::resource_exhausted, "no memory for a parser", in.path());
  }
  XML_SetUserData(parser_.get(), this);
  XML_SetElementHandler(parser_.get(), &LandXmlElements::start, &LandXmlElements::end);
  XML_SetCharacterDataHandler(parser_.get(), &LandXmlElements::add_text);
  XML_SetStartDoctypeDeclHandler(parser_.get(), &LandXmlElements::doctype);
  XML_SetUnknownEncodingHandler(parser_.get(), &find_xml_encoding, nullptr);
}

LandXmlElements::~LandXmlElements() = default;

void LandXmlElements::parse() {
  for (auto bytes = in_.some();; bytes = in_.some()) {
    const bool is_last = bytes.empty();
    const XML_Status status =
        XML_Parse(parser_.get(), bytes.data(), static_cast<int>(bytes.size()), is_last ? 1 : 0);
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    if (status == XML_STATUS_ERROR) {
      const XML_Error error = XML_GetErrorCode(parser_.get());
      refuse_here(std::string("this is no XML that can be read: ") + XML_ErrorString(error) +
                  (error == XML_ERROR_UNKNOWN_ENCODING ? "; save it as UTF-8" : ""));
    }
    const XML_Index at = XML_GetCurrentByteIndex(parser_.get());
    if (at >= 0 && in_.position() - static_cast<std::uint64_t>(at) > kLongestToken + (1U << 17)) {
      refuse_here("a piece of XML is longer than a mebibyte");
    }
    if (is_last) {
      break;
    }
  }
}

void LandXmlElements::gather(std::size_t most, const char* too_long) {
  gathering_ = true;
  most_text_ = most;
  too_long_ = too_long;
  text_.clear();
}

void LandXmlElements::end_gathering() {
  gathering_ = false;
  std::replace_if(
      text_.begin(), text_.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  split_words(text_, words_);
}

bool LandXmlElements::begin_surface(const char** attributes, const std::string& wish) {
  const std::string name(attribute(attributes, "name"));
  constexpr std::size_t kMostNames = 400;  // bytes that an error needs
  if (names_.size() < kMostNames) {
    names_ += (names_.empty() ? "'" : ", '") + name.substr(0, 60) + "'";
  }
  ++surfaces_;
  return wish.empty() || name == wish || wish == "#" + std::to_string(surfaces_);
}

std::string LandXmlElements::place() const {
  return in_.path() + ":" + std::to_string(XML_GetCurrentLineNumber(parser_.get()));
}

void LandXmlElements::refuse_here(const std::string& sentence) const {
  throw Error(ErrorCode::invalid_argument, sentence, place());
}

/// Runs a handler; no exception may pass through expat.
template <typename Handler>
void LandXmlElements::guarded(void* self, const Handler& handler) {
  auto& me = *static_cast<LandXmlElements*>(self);
  if (me.failure_) {
    return;
  }
  try {
    handler(me);
  } catch (...) {
    me.failure_ = std::current_exception();
    XML_StopParser(me.parser_.get(), XML_FALSE);
  }
}

void LandXmlElements::start(void* self, const char* name, const char** attributes) {
  guarded(self, [&](LandXmlElements& me) { me.begin(local_name(name), attributes); });
}

void LandXmlElements::end(void* self, const char* name) {
  guarded(self, [&](LandXmlElements& me) {
    --me.depth_;
    me.end_element(local_name(name));
  });
}

void LandXmlElements::add_text(void* self, const char* s, int length) {
  guarded(self, [&](LandXmlElements& me) {
    if (!me.gathering_) {
      return;
    }
    me.text_.append(s, static_cast<std::size_t>(length));
    if (me.text_.size() > me.most_text_) {
      me.refuse_here(me.too_long_);
    }
  });
}

void LandXmlElements::doctype(void* self, const char*, const char*, const char*, int) {
  guarded(self, [](LandXmlElements& me) {
    me.refuse_here(
        "a document type declaration is not read: LandXML has none, and it may hide what "
        "grows without end");
  });
}

std::string_view LandXmlElements::attribute(const char** attributes, std::string_view name) {
  for (; *attributes != nullptr; attributes += 2) {
    if (name == attributes[0]) {
      return attributes[1];
    }
  }
  return {};
}

void LandXmlElements::begin(std::string_view name, const char** attributes) {
  if (++depth_ > kDeepest) {
    refuse_here("elements lie more than 64 deep");
  }
  if (depth_ == 1 && name != "LandXML") {
    refuse_here("the first element is '" + std::string(name.substr(0, 40)) +
                "', not LandXML; a raster that XML describes is named as GDAL does, by its driver, "
                "as PDS4:FILE.xml:1:1, or given a name that does not end in .xml");
  }
  if (depth_ == 2 && name == "CoordinateSystem") {
    read_crs(attributes);
  } else if (depth_ == kUnitsDepth && (name == "Metric" || name == "Imperial")) {
    read_units(attributes);
  } else {
    start_element(name, attributes);
  }
}

void LandXmlElements::warn(std::string kind, std::string message) {
  warnings_.add({.kind = std::move(kind), .message = std::move(message), .file = in_.path()});
}

void LandXmlElements::read_crs(const char** attributes) {
  const auto told = [&](std::string_view name) {
    return std::string(attribute(attributes, name).substr(0, kLongestName));
  };
  const auto first_of = [&](std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) {
      if (!attribute(attributes, name).empty()) {
        return told(name);
      }
    }
    return std::string();
  };
  std::string code = told("epsgCode");
  if (code.starts_with("EPSG:")) {
    code.erase(0, 5);
  }
  const std::string wkt(attribute(attributes, "ogcWktCode"));
  const std::string name = first_of(
      {"horizontalCoordinateSystemName", "projectedCoordinateSystemName",
       "geographicCoordinateSystemName", "horizontalDatum", "datum", "epsgCode", "name", "desc"});
  if (is_code(code)) {
    crs_ = "EPSG:" + code;
  } else if (!wkt.empty()) {
    crs_ = wkt;
  } else if (name.starts_with("EPSG:") && is_code(name.substr(5))) {
    crs_ = name;
  } else if (!name.empty()) {
    warn("crs_in_words", "the CRS is told as '" + name +
                             "' and by no code, which is not understood; name it with --a-srs");
  }
  const std::string vertical = first_of({"verticalCoordinateSystemName", "verticalDatum"});
  const std::string vertical_code = vertical.starts_with("EPSG:") ? vertical.substr(5) : vertical;
  if (is_code(vertical_code)) {
    vertical_crs_ = "EPSG:" + vertical_code;
  } else if (!vertical.empty()) {
    warn("vertical_crs_in_words",
         "the heights are told to be above '" + vertical +
             "', which is no code and not used; name the vertical CRS with --vertical-crs");
  }
  const std::string angle = told("rotationAngle");
  if (angle.find_first_of("123456789") != std::string::npos) {
    warn("turned_coordinates",
         "the file says that its coordinate system is turned by " + angle +
             " against the CRS, which is not undone; bring the coordinates to "
             "the CRS first where they are not in it");
  }
}

/// Heights are coordinates and so in the linear unit, unless the file names another one for them.
/// Its "feet" are those of the linear unit, where that is a foot.
void LandXmlElements::read_units(const char** attributes) {
  const auto unit = [&](const char* name) {
    const std::string text(attribute(attributes, name));
    return text.empty() ? text : height_unit_named(text);
  };
  units_ = {unit("linearUnit"), unit("elevationUnit")};
  const bool is_same_foot = units_.heights == "foot" && units_.plane == "US survey foot";
  if (units_.heights.empty() || is_same_foot) {
    units_.heights = units_.plane;
  }
}

}  // namespace ptin
