// SPDX-License-Identifier: GPL-3.0-or-later
//
// LandXML 1.0 to 1.2: Surfaces/Surface/SourceData with Breaklines/Breakline and Boundaries/Boundary,
// each with a PntList3D: northing, easting and height of one vertex after the other; or a PntList2D,
// without heights.
#include "engine/construct/read/byte_reader.h"
#include "engine/construct/read/land_xml.h"
#include "engine/construct/read/line_file.h"
#include "engine/construct/read/tin_reader.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin {

namespace {

constexpr std::size_t kLongestList = std::size_t{16} << 20;  // bytes of text

class LandXmlLines final : public LandXmlElements {
 public:
  LandXmlLines(ByteReader& in, const LayerWish& wish, const TakeLine& take,
               const std::stop_token& stop)
      : LandXmlElements(in),
        wish_(wish),
        element_(wish.kind == LayerKind::kAreas ? "Boundary" : "Breakline"),
        take_(take),
        stop_(stop) {}

  LineFileCrs read() {
    parse();
    if (lines_ == 0) {
      refuse(std::string("there is no ") + element_ + " with a PntList3D or PntList2D in " +
                 (wish_.name.empty() ? "this file" : "the surface '" + wish_.name + "'") +
                 (names_.empty() ? "" : "; its surfaces are " + names_),
             in_.path());
    }
    if (outer_ == 0 && voids_ > 0) {
      refuse(
          "the boundary has voids and no outer ring, and what lies within a ring is kept; give it "
          "the ring that is around them",
          in_.path());
    }
    return {crs_, units_, is_flat_, warnings_};
  }

 private:
  void start_element(std::string_view name, const char** attributes) override {
    if (name == "Surface") {
      is_wanted_ = begin_surface(attributes, wish_.name);
      lines_of_surface_ = 0;
    } else if (name == element_) {
      in_line_ = is_wanted_;
      if (in_line_) {
        note_type(attributes);
      }
    } else if (in_line_ && (name == "PntList3D" || name == "PntList2D")) {
      numbers_of_vertex_ = name == "PntList3D" ? 3 : 2;
      gather(kLongestList, "a list of points holds more text than 16 MiB");
    }
  }

  void end_element(std::string_view name) override {
    if (name == "Surface") {
      is_wanted_ = false;
    } else if (name == element_) {
      in_line_ = false;
    } else if (is_gathering() && (name == "PntList3D" || name == "PntList2D")) {
      end_gathering();
      end_line();
    }
  }

  /// The kind of a boundary or breakline.
  void note_type(const char** attributes) {
    if (wants_areas()) {
      ++(attribute(attributes, "bndType") == "void" ? voids_ : outer_);
      return;
    }
    const std::string_view type = attribute(attributes, "brkType");
    if (type == "wall" || type == "proximity") {
      warnings_.add({.kind = "breakline_type",
                     .message = "breaklines of the type " + std::string(type) +
                                " are taken as they are drawn, at the heights of their vertices",
                     .file = in_.path(),
                     .subject = std::string(type),
                     .count = 1});
    }
  }

  void end_line() {
    stop_if_asked(stop_, "reading", in_.path());
    if (lines_of_surface_++ == 0 && lines_ > 0) {
      refuse_here("several surfaces have such lines, " + names_ + "; name one with " +
                  wish_.option + ", or by its place as '#2'");
    }
    const std::size_t n = numbers_of_vertex_;
    if (words_.empty() || words_.size() % n != 0) {
      refuse_here("a PntList" + std::to_string(n) + "D has " + std::to_string(words_.size()) +
                  " numbers, which are not northing" +
                  (n == 3 ? ", easting and height" : " and easting") + " of some points");
    }
    is_flat_ = is_flat_ || n == 2;
    const std::string where = place();
    vertices_.clear();
    for (std::size_t i = 0; i < words_.size(); i += n) {
      vertices_.push_back({coordinate_of(words_[i + 1], where), coordinate_of(words_[i], where),
                           n == 3 ? coordinate_of(words_[i + 2], where) : Decimal{}});
    }
    const SourcePoint first = vertices_.front(), last = vertices_.back();
    if (wants_areas() && !(first.x == last.x && first.y == last.y)) {
      vertices_.push_back(first);
    }
    ++lines_;
    take_(vertices_, n == 3);
  }

  [[nodiscard]] bool wants_areas() const { return wish_.kind == LayerKind::kAreas; }

  const LayerWish& wish_;
  const char* element_;
  const TakeLine& take_;
  std::stop_token stop_;
  bool is_wanted_ = false, in_line_ = false;
  std::uint64_t lines_ = 0, lines_of_surface_ = 0;
  std::uint64_t outer_ = 0, voids_ = 0;  ///< Boundaries by their type.
  std::size_t numbers_of_vertex_ = 3;
  bool is_flat_ = false;
  std::vector<SourcePoint> vertices_;
};

}  // namespace

LineFileCrs read_land_xml_lines(const std::string& path, const LayerWish& wish,
                                const TakeLine& take, const std::stop_token& stop) {
  ByteReader in(path);
  return LandXmlLines(in, wish, take, stop).read();
}

}  // namespace ptin
