// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/land_xml_contours.h"

#include "tools/formats/land_xml.h"
#include "tools/formats/number_text.h"

namespace ptin::tools {

LandXmlContours::LandXmlContours(const std::string& path, bool overwrite, const CrsFacts& crs)
    : out_(path, overwrite) {
  out_.write(land_xml_head(crs, path));
  out_.write("      <SourceData>\n        <Contours>\n");
}

void LandXmlContours::add(std::span<const MapPoint> points, double elevation) {
  text_ = "<Contour elev=\"";
  append_number(text_, elevation);
  text_ += "\"><PntList2D>";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) text_ += ' ';
    append_land_xml_position(text_, points[i].x, points[i].y);
  }
  out_.write(text_ += "</PntList2D></Contour>\n");
}

void LandXmlContours::publish() {
  out_.write("        </Contours>\n      </SourceData>\n");
  out_.write(land_xml_tail());
  out_.publish();
}

}  // namespace ptin::tools
