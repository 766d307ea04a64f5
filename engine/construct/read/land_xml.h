// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the readers of LandXML share: elements and texts from expat, units and CRS.
#pragma once

#include <cstdint>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <expat.h>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/read/byte_reader.h"
#include "engine/handle.h"

namespace ptin {

/// Reads LandXML as a stream, in any encoding that it names, and hands its elements to a derived
/// class. A document type declaration is refused, and with it every entity that a file could
/// define. Errors are kept and thrown outside of expat, which is C.
class LandXmlElements {
 public:
  LandXmlElements(const LandXmlElements&) = delete;
  LandXmlElements& operator=(const LandXmlElements&) = delete;

 protected:
  explicit LandXmlElements(ByteReader& in);
  virtual ~LandXmlElements();

  /// Reads to the end.  @throws Error io_error, invalid_argument, and what the functions below throw
  void parse();
  /// Names come without a prefix. CoordinateSystem and Units are looked at before.
  virtual void start_element(std::string_view name, const char** attributes) = 0;
  virtual void end_element(std::string_view name) = 0;

  /// From here on text is added to text_, which is cleared; until stop_gathering().
  /// @param most  Bytes; more are refused as `too_long` says.
  void gather(std::size_t most, const char* too_long);
  /// The words of what was gathered, in words_.
  void end_gathering();
  [[nodiscard]] bool is_gathering() const noexcept { return gathering_; }
  /// "path:line".
  [[nodiscard]] std::string place() const;
  [[noreturn]] void refuse_here(const std::string& sentence) const;
  [[nodiscard]] static std::string_view attribute(const char** attributes, std::string_view name);

  ByteReader& in_;
  /// Counts a surface that begins. True where it is the one that `wish` names, by its name or by its
  /// place in the file as "#2", since several may have one name; or where it names none.
  [[nodiscard]] bool begin_surface(const char** attributes, const std::string& wish);
  std::uint64_t surfaces_ = 0;  ///< That began so far.
  std::string names_;           ///< Those of the first of them, for errors.
  std::string text_;
  std::vector<std::string_view> words_;
  std::string crs_;           ///< The text for PointStreamFacts::crs, once it was read.
  std::string vertical_crs_;  ///< Likewise.
  DeclaredUnits units_;       ///< Likewise.
  SourceWarnings warnings_;   ///< Warnings of what the file declares and nobody follows.

  void warn(std::string kind, std::string message);

 private:
  template <typename Handler>
  static void guarded(void* self, const Handler& handler);
  static void start(void* self, const char* name, const char** attributes);
  static void end(void* self, const char* name);
  static void add_text(void* self, const char* s, int length);
  static void doctype(void* self, const char*, const char*, const char*, int);
  void begin(std::string_view name, const char** attributes);
  void read_crs(const char** attributes);
  void read_units(const char** attributes);

  Handle<XML_ParserStruct, &XML_ParserFree> parser_;
  std::exception_ptr failure_;
  int depth_ = 0;
  bool gathering_ = false;
  std::size_t most_text_ = 0;
  const char* too_long_ = "";
};

}  // namespace ptin
