// SPDX-License-Identifier: GPL-3.0-or-later
//
// LandXML 1.0 to 1.2: Surfaces/Surface/Definition with Pnts/P (northing easting height) and Faces/F
// (three ids; i="1" is hidden).
#include <memory>
#include <string>

#include "engine/construct/read/land_xml.h"
#include "engine/construct/read/tin_reader.h"
#include "engine/error.h"

namespace ptin {

namespace {

constexpr std::size_t kLongestText = 1024;  // of a P or an F

/// Gathers the chosen surface.
class LandXml final : public LandXmlElements {
 public:
  LandXml(ByteReader& in, const TinReading& reading, TinFileSink& sink)
      : LandXmlElements(in), reading_(reading), tin_(in, reading, sink) {}

  TinFileFacts read() {
    parse();
    return finish();
  }

 private:
  void start_element(std::string_view name, const char** attributes) override {
    if (name == "Surface") {
      start_surface(attributes);
    } else if (in_surface_ && name == "Definition") {
      const std::string_view type = attribute(attributes, "surfType");
      if (!type.empty() && type != "TIN") {
        refuse_here("the surface is a " + std::string(type.substr(0, 40)) + "; only TINs are read");
      }
    } else if (in_surface_ && name == "Pnts") {
      in_points_ = true;
    } else if (in_surface_ && name == "Faces") {
      in_faces_ = true;
    } else if ((in_points_ && name == "P") || (in_faces_ && name == "F")) {
      gather(kLongestText, "a point or face holds more text than three numbers");
      id_ = attribute(attributes, "id");
      is_hidden_ = name == "F" && attribute(attributes, "i") == "1";
    }
  }

  void end_element(std::string_view name) override {
    if (name == "Surface") {
      in_surface_ = false;
    } else if (name == "Pnts") {
      in_points_ = false;
    } else if (name == "Faces") {
      in_faces_ = false;
    } else if (is_gathering() && name == "P") {
      stop_gathering();
      end_point();
    } else if (is_gathering() && name == "F") {
      stop_gathering();
      end_face();
    }
  }

  void start_surface(const char** attributes) {
    const std::string name(attribute(attributes, "name"));
    constexpr std::size_t kMostNames = 400;  // bytes that an error needs
    if (names_.size() < kMostNames) {
      names_ += (names_.empty() ? "'" : ", '") + name.substr(0, 60) + "'";
    }
    if (!reading_.surface.empty() && name != reading_.surface) {
      return;
    }
    if (has_surface_) {
      refuse_here("there are several surfaces, " + names_ + " among them; name one with --layer");
    }
    has_surface_ = in_surface_ = true;
  }

  void split_text(std::size_t wanted, const char* what) {
    for (char& c : text_) {
      if (c == '\n' || c == '\r') {
        c = ' ';
      }
    }
    split_words(text_, words_);
    if (words_.size() != wanted) {
      refuse_here(std::string(what) + " has " + std::to_string(words_.size()) + " numbers, not " +
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
    if (!crs_.empty()) {
      tin_.set_crs(crs_);
    }
    tin_.set_units(units_);
    return tin_.finish();
  }

  const TinReading& reading_;
  TinReceiver tin_;
  bool has_surface_ = false, in_surface_ = false, in_points_ = false, in_faces_ = false;
  bool is_hidden_ = false;
  std::string id_, names_;
  std::vector<std::string_view> words_;
};

}  // namespace

TinFileFacts read_land_xml(ByteReader& in, const TinReading& reading, TinFileSink& sink) {
  return LandXml(in, reading, sink).read();
}

}  // namespace ptin
