// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/land_xml.h"

#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "tools/formats/markup_text.h"
#include "tools/formats/mesh_stream.h"
#include "tools/formats/number_text.h"
#include "tools/output/output_file.h"
#include "tools/output/spill_file.h"

namespace ptin::tools {

namespace {

/// ` name="value"`, or nothing where there is no value.
std::string attribute(const char* name, const std::string& value) {
  if (value.empty()) return {};
  return std::string(" ") + name + "=\"" + markup_text(value) + "\"";
}

/// LandXML's word for a unit of heights that is not that of the plane; it knows one foot.
std::string elevation_unit(const std::string& unit) {
  if (unit == "metre") return "meter";
  return unit == "foot" || unit == "US survey foot" ? "feet" : "";
}

/// The element Units; empty where LandXML has no word for the unit of the plane.
std::string units_element(const CrsFacts& crs) {
  const std::string plane = height_unit_named(crs.horizontal_unit);
  const std::string heights = height_unit_named(crs.vertical_unit);
  const std::string elevation =
      heights == plane ? "" : attribute("elevationUnit", elevation_unit(heights));
  if (plane == "metre") {
    return "  <Units><Metric areaUnit=\"squareMeter\" linearUnit=\"meter\" "
           "volumeUnit=\"cubicMeter\" temperatureUnit=\"celsius\" pressureUnit=\"HPA\"" +
           elevation + "/></Units>\n";
  }
  if (plane != "foot" && plane != "US survey foot") return {};
  const std::string foot = plane == "foot" ? "foot" : "USSurveyFoot";
  return "  <Units><Imperial areaUnit=\"squareFoot\" linearUnit=\"" + foot +
         "\" volumeUnit=\"cubicFeet\" temperatureUnit=\"fahrenheit\" pressureUnit=\"inHG\"" +
         elevation + "/></Units>\n";
}

std::string crs_element(const CrsFacts& crs) {
  constexpr std::string_view kEpsg = "EPSG:";
  const bool has_code = crs.code.starts_with(kEpsg);
  const std::string text = attribute("name", crs.name) +
                           attribute("epsgCode", has_code ? crs.code.substr(kEpsg.size()) : "") +
                           attribute("ogcWktCode", has_code ? "" : crs.wkt) +
                           attribute("verticalCoordinateSystemName", crs.vertical_text());
  return text.empty() ? text : "  <CoordinateSystem" + text + "/>\n";
}

class LandXml final : public MeshStream {
 public:
  explicit LandXml(const MeshStreamTarget& target)
      : out_(target.path, target.overwrite), faces_(target.path) {
    out_.write(land_xml_head(target.crs, target.path));
    out_.write("      <Definition surfType=\"TIN\">\n        <Pnts>\n");
  }

  void add_vertex(const Point& point) override {
    text_ = "<P id=\"";
    append_number(text_, ++vertices_);
    text_ += "\">";
    append_land_xml_position(text_, point[0], point[1]);
    text_ += ' ';
    append_number(text_, point[2]);
    out_.write(text_ += "</P>\n");
  }

  void add_triangle(const std::array<Corner, 3>& corners) override {
    text_ = "<F>";
    for (std::size_t i = 0; i < 3; ++i) {
      if (i > 0) text_ += ' ';
      append_number(text_, corners[i].number + 1);
    }
    text_ += "</F>\n";
    faces_.write(text_.data(), text_.size());
  }

  void publish() override {
    out_.write("        </Pnts>\n        <Faces>\n");
    for (auto bytes = faces_.read(); !bytes.empty(); bytes = faces_.read()) {
      out_.write(bytes.data(), bytes.size());
    }
    out_.write("        </Faces>\n      </Definition>\n");
    out_.write(land_xml_tail());
    out_.publish();
  }

 private:
  OutputFile out_;
  SpillFile faces_;
  std::uint64_t vertices_ = 0;
  std::string text_;
};

}  // namespace

std::string land_xml_head(const CrsFacts& crs, const std::string& path) {
  if (crs.geographic) {
    refuse(
        "LandXML has northing and easting in a plane, and this terrain's CRS is in degrees; write "
        "another format, or build from a source in a projected CRS",
        path);
  }
  // The schema wants a date and a time. They are always these, since equal input makes equal bytes.
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\" "
         "date=\"1970-01-01\" time=\"00:00:00\">\n" +
         units_element(crs) + crs_element(crs) +
         "  <Application name=\"ptin\"/>\n"
         "  <Surfaces>\n    <Surface name=\"terrain\">\n";
}

std::string land_xml_tail() { return "    </Surface>\n  </Surfaces>\n</LandXML>\n"; }

void append_land_xml_position(std::string& text, double x, double y) {
  append_number(text, y);
  text += ' ';
  append_number(text, x);
}

std::unique_ptr<MeshStream> make_land_xml(const MeshStreamTarget& target) {
  return std::make_unique<LandXml>(target);
}

}  // namespace ptin::tools
