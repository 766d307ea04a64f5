// SPDX-License-Identifier: GPL-3.0-or-later
//
// LandXML 1.0 to 1.2: Surfaces/Surface/Definition with Pnts/P (northing easting height; where none has
// an id they are numbered from 1) and Faces/F (three or four ids; i="1" is hidden).
#include <array>
#include <memory>
#include <span>
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
      start_definition(attributes);
    } else if (in_surface_ && name == "Boundary") {
      ++boundaries_;
    } else if (in_surface_ && (name == "Pnts" || name == "Faces")) {
      if (!in_definition_) {
        start_definition(attributes);  // some programs write none
      }
      (name == "Pnts" ? in_points_ : in_faces_) = true;
    } else if ((in_points_ && name == "P") || (in_faces_ && name == "F")) {
      gather(kLongestText, "a point or face holds more text than three numbers");
      id_ = attribute(attributes, "id");
      reference_ = attribute(attributes, "pntRef");
      is_hidden_ = name == "F" && attribute(attributes, "i") == "1";
    }
  }

  void end_element(std::string_view name) override {
    if (name == "Surface") {
      in_surface_ = in_definition_ = false;
    } else if (name == "Definition") {
      in_definition_ = false;
    } else if (name == "Pnts") {
      in_points_ = false;
    } else if (name == "Faces") {
      in_faces_ = false;
    } else if (is_gathering() && name == "P") {
      end_gathering();
      end_point();
    } else if (is_gathering() && name == "F") {
      end_gathering();
      end_face();
    }
  }

  void start_surface(const char** attributes) {
    in_surface_ = begin_surface(attributes, reading_.surface);
    has_surface_ = has_surface_ || in_surface_;
    state_ = attribute(attributes, "state");
  }

  void start_definition(const char** attributes) {
    if (read_ != 0) {
      refuse_here((reading_.surface.empty()
                       ? "there are several surfaces, " + names_ + " among them"
                       : "there are several surfaces '" + reading_.surface + "'") +
                  "; name one with --layer" +
                  (reading_.surface.empty() ? "" : " by its place in the file") +
                  ", as in --layer '#" + std::to_string(surfaces_) + "'");
    }
    const std::string_view type = attribute(attributes, "surfType");
    if (!type.empty() && type != "TIN") {
      refuse_here("the surface is a " + std::string(type.substr(0, 40)) +
                  "; only TINs are read: save it as a TIN, or name another surface with --layer");
    }
    read_ = surfaces_;
    in_definition_ = true;
    if (state_ == "abandoned" || state_ == "destroyed") {
      warn("surface_state", "the surface is said to be " + state_ +
                                "; name another one with --layer where it does not count");
    }
  }

  void end_point() {
    if (words_.empty() && !reference_.empty()) {
      refuse_here("this P has no coordinates but the name of a point, '" +
                  reference_.substr(0, 60) +
                  "' (pntRef), which is not followed; write its "
                  "coordinates");
    }
    if (words_.size() != 3) {
      refuse_here("this P has " + std::to_string(words_.size()) +
                  " numbers, where northing, easting and height belong");
    }
    const std::string where = place();
    // Surveyors write northing before easting.
    tin_.add_vertex(id_of_point(),
                    {coordinate_of(words_[1], where), coordinate_of(words_[0], where),
                     coordinate_of(words_[2], where)});
  }

  /// Faces name points by their ids, or by their numbers where no point has an id.
  std::int64_t id_of_point() {
    const bool is_first = tin_.vertices() == 0;
    are_numbered_ = is_first ? id_.empty() : are_numbered_;
    if (id_.empty() != are_numbered_) {
      refuse_here(are_numbered_
                      ? "this P has an id, and those before it have none; give all an id, or none"
                      : "this P has no id, and those before it have; give all an id, or none");
    }
    return are_numbered_ ? static_cast<std::int64_t>(tin_.vertices()) + 1 : whole_of(id_, place());
  }

  void end_face() {
    if (words_.size() != 3 && words_.size() != 4) {
      TinReceiver::refuse_corners(words_.size(), place());
    }
    if (is_hidden_) {
      tin_.add_hidden();
      return;
    }
    const std::string where = place();
    std::array<std::int64_t, 4> ids{};
    for (std::size_t i = 0; i < words_.size(); ++i) {
      ids[i] = whole_of(words_[i], where);
    }
    tin_.add_face(std::span(ids).first(words_.size()), where);
  }

  TinFileFacts finish() {
    if (!has_surface_) {
      throw Error(ErrorCode::invalid_argument,
                  reading_.surface.empty() || names_.empty()
                      ? "there is no surface in this file"
                      : "there is no surface '" + reading_.surface + "'; there is " + names_,
                  in_.path());
    }
    tin_.set_crs(crs_, vertical_crs_);
    tin_.set_units(units_);
    TinFileFacts facts = tin_.finish();
    if (boundaries_ > 0 && facts.hidden_triangles == 0) {
      warn("boundaries_of_source",
           "the surface names boundaries beside its faces, which are taken as they are, and hides "
           "none of them; --repair with --boundary cuts a terrain by them");
    }
    facts.warnings.join(warnings_);
    return facts;
  }

  const TinReading& reading_;
  TinReceiver tin_;
  bool has_surface_ = false, in_surface_ = false, in_definition_ = false, in_points_ = false,
       in_faces_ = false;
  bool is_hidden_ = false, are_numbered_ = false;
  std::uint64_t read_ = 0;        ///< The number of the surface that is read; 0: none yet.
  std::uint64_t boundaries_ = 0;  ///< Boundaries of that surface, in its source data.
  std::string id_, reference_, state_;
};

}  // namespace

TinFileFacts read_land_xml(ByteReader& in, const TinReading& reading, TinFileSink& sink) {
  return LandXml(in, reading, sink).read();
}

}  // namespace ptin
