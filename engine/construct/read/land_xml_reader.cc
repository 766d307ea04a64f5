// SPDX-License-Identifier: GPL-3.0-or-later
//
// LandXML 1.0 to 1.2: Surfaces/Surface/Definition with Pnts/P (northing easting height) and Faces/F
// (three ids; i="1" is hidden); Units/Metric or Units/Imperial. Read as a stream by expat. A document type declaration is refused,
// and with it every entity that a file could define.
#include <cctype>
#include <memory>
#include <string>

#include <expat.h>

#include "engine/construct/read/tin_reader.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"

namespace ptin {

namespace {

constexpr std::size_t kLongestText = 1024;         // of a P or an F
constexpr int kDeepest = 64;                       // elements inside of elements
constexpr int kUnitsDepth = 3;                     // LandXML/Units/Metric
constexpr std::uint64_t kLongestToken = 1U << 20;  // bytes without an event

/// Gathers the chosen surface. Errors are kept and thrown outside of expat, which is C.
class LandXml {
 public:
  LandXml(ByteReader& in, const TinReading& reading, TinFileSink& sink)
      : in_(in), reading_(reading), tin_(in, reading, sink), parser_(XML_ParserCreate(nullptr)) {
    if (!parser_) {
      throw Error(ErrorCode::resource_exhausted, "no memory for a parser", in.path());
    }
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &LandXml::start, &LandXml::end);
    XML_SetCharacterDataHandler(parser_.get(), &LandXml::text);
    XML_SetStartDoctypeDeclHandler(parser_.get(), &LandXml::doctype);
  }

  TinFileFacts read() {
    for (auto bytes = in_.some();; bytes = in_.some()) {
      const bool is_last = bytes.empty();
      const XML_Status status =
          XML_Parse(parser_.get(), bytes.data(), static_cast<int>(bytes.size()), is_last ? 1 : 0);
      if (failure_) {
        std::rethrow_exception(failure_);
      }
      if (status == XML_STATUS_ERROR) {
        refuse(std::string("this is no XML that can be read: ") +
               XML_ErrorString(XML_GetErrorCode(parser_.get())));
      }
      const XML_Index at = XML_GetCurrentByteIndex(parser_.get());
      if (at >= 0 && in_.position() - static_cast<std::uint64_t>(at) > kLongestToken + (1U << 17)) {
        refuse("a piece of XML is longer than a mebibyte");
      }
      if (is_last) {
        break;
      }
    }
    return finish();
  }

 private:
  struct ParserFree {
    void operator()(XML_Parser p) const { XML_ParserFree(p); }
  };

  [[nodiscard]] std::string place() const {
    return in_.path() + ":" + std::to_string(XML_GetCurrentLineNumber(parser_.get()));
  }
  [[noreturn]] void refuse(const std::string& sentence) const {
    throw Error(ErrorCode::invalid_argument, sentence, place());
  }

  /// Runs a handler; no exception may pass through expat.
  template <typename Handler>
  static void guarded(void* self, const Handler& handler) {
    auto& me = *static_cast<LandXml*>(self);
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
  static void XMLCALL start(void* self, const XML_Char* name, const XML_Char** attributes) {
    guarded(self, [&](LandXml& me) { me.start_element(local_name(name), attributes); });
  }
  static void XMLCALL end(void* self, const XML_Char* name) {
    guarded(self, [&](LandXml& me) { me.end_element(local_name(name)); });
  }
  static void XMLCALL text(void* self, const XML_Char* s, int length) {
    guarded(self, [&](LandXml& me) {
      if (!me.gathering_) {
        return;
      }
      me.text_.append(s, static_cast<std::size_t>(length));
      if (me.text_.size() > kLongestText) {
        me.refuse("a point or face holds more text than three numbers");
      }
    });
  }
  static void XMLCALL doctype(void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    guarded(self, [](LandXml& me) {
      me.refuse(
          "a document type declaration is not read: LandXML has none, and it may hide what "
          "grows without end");
    });
  }

  static std::string_view local_name(const XML_Char* name) {
    const std::string_view all(name);
    const std::size_t colon = all.rfind(':');
    return colon == std::string_view::npos ? all : all.substr(colon + 1);
  }
  static std::string_view attribute(const XML_Char** attributes, std::string_view name) {
    for (; *attributes != nullptr; attributes += 2) {
      if (name == attributes[0]) {
        return attributes[1];
      }
    }
    return {};
  }

  void start_element(std::string_view name, const XML_Char** attributes) {
    if (++depth_ > kDeepest) {
      refuse("elements lie more than 64 deep");
    }
    if (depth_ == 1 && name != "LandXML") {
      refuse("the first element is '" + std::string(name.substr(0, 40)) + "', not LandXML");
    }
    if (name == "CoordinateSystem") {
      read_crs(attributes);
    } else if (depth_ == kUnitsDepth && (name == "Metric" || name == "Imperial")) {
      read_units(attributes);
    } else if (name == "Surface") {
      start_surface(attributes);
    } else if (in_surface_ && name == "Definition") {
      const std::string_view type = attribute(attributes, "surfType");
      if (!type.empty() && type != "TIN") {
        refuse("the surface is a " + std::string(type.substr(0, 40)) + "; only TINs are read");
      }
    } else if (in_surface_ && name == "Pnts") {
      in_points_ = true;
    } else if (in_surface_ && name == "Faces") {
      in_faces_ = true;
    } else if ((in_points_ && name == "P") || (in_faces_ && name == "F")) {
      gathering_ = true;
      text_.clear();
      id_ = attribute(attributes, "id");
      is_hidden_ = name == "F" && attribute(attributes, "i") == "1";
    }
  }

  void end_element(std::string_view name) {
    --depth_;
    if (name == "Surface") {
      in_surface_ = false;
    } else if (name == "Pnts") {
      in_points_ = false;
    } else if (name == "Faces") {
      in_faces_ = false;
    } else if (gathering_ && name == "P") {
      gathering_ = false;
      end_point();
    } else if (gathering_ && name == "F") {
      gathering_ = false;
      end_face();
    }
  }

  void start_surface(const XML_Char** attributes) {
    const std::string name(attribute(attributes, "name"));
    constexpr std::size_t kMostNames = 400;  // bytes that an error needs
    if (names_.size() < kMostNames) {
      names_ += (names_.empty() ? "'" : ", '") + name.substr(0, 60) + "'";
    }
    if (!reading_.surface.empty() && name != reading_.surface) {
      return;
    }
    if (has_surface_) {
      refuse("there are several surfaces, " + names_ + " among them; name one with --layer");
    }
    has_surface_ = in_surface_ = true;
  }

  void read_crs(const XML_Char** attributes) {
    const std::string code(attribute(attributes, "epsgCode"));
    const bool is_number = !code.empty() && code.size() < 10 &&
                           code.find_first_not_of("0123456789") == std::string::npos;
    if (is_number && code != "0") {
      tin_.set_crs("EPSG:" + code);
    }
  }

  /// Heights are coordinates and so in the linear unit, unless the file names another one for them.
  /// Its "feet" are those of the linear unit, where that is a foot.
  void read_units(const XML_Char** attributes) {
    const auto unit = [&](const char* name) {
      const std::string text(attribute(attributes, name));
      return text.empty() ? text : height_unit_named(text);
    };
    DeclaredUnits units{unit("linearUnit"), unit("elevationUnit")};
    const bool is_same_foot = units.heights == "foot" && units.plane == "US survey foot";
    if (units.heights.empty() || is_same_foot) {
      units.heights = units.plane;
    }
    tin_.set_units(std::move(units));
  }

  void split_text(std::size_t wanted, const char* what) {
    for (char& c : text_) {
      if (c == '\n' || c == '\r') {
        c = ' ';
      }
    }
    split_words(text_, words_);
    if (words_.size() != wanted) {
      refuse(std::string(what) + " has " + std::to_string(words_.size()) + " numbers, not " +
             std::to_string(wanted));
    }
  }

  void end_point() {
    split_text(3, "a point");
    const std::string where = place();
    // Surveyors write northing before easting.
    tin_.add_vertex(whole_of(id_, where),
                    {coordinate_of(words_[1], where), coordinate_of(words_[0], where),
                     coordinate_of(words_[2], where)});
  }

  void end_face() {
    split_text(3, "a face");
    if (is_hidden_) {
      tin_.add_hidden();
      return;
    }
    const std::string where = place();
    tin_.add_triangle(
        {whole_of(words_[0], where), whole_of(words_[1], where), whole_of(words_[2], where)});
  }

  TinFileFacts finish() {
    if (!has_surface_) {
      throw Error(ErrorCode::invalid_argument,
                  reading_.surface.empty() || names_.empty()
                      ? "there is no surface in this file"
                      : "there is no surface '" + reading_.surface + "'; there is " + names_,
                  in_.path());
    }
    return tin_.finish();
  }

  ByteReader& in_;
  const TinReading& reading_;
  TinReceiver tin_;
  std::unique_ptr<XML_ParserStruct, ParserFree> parser_;
  std::exception_ptr failure_;
  int depth_ = 0;
  bool has_surface_ = false, in_surface_ = false, in_points_ = false, in_faces_ = false;
  bool gathering_ = false, is_hidden_ = false;
  std::string text_, id_, names_;
  std::vector<std::string_view> words_;
};

}  // namespace

TinFileFacts read_land_xml(ByteReader& in, const TinReading& reading, TinFileSink& sink) {
  return LandXml(in, reading, sink).read();
}

}  // namespace ptin
