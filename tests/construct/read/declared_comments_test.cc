// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/declared_comments.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace ptin {
namespace {

DeclaredComments of(const std::vector<std::string>& comments) {
  DeclaredComments declared;
  for (const std::string& comment : comments) declared.note(comment);
  return declared;
}

/// The comments that are quoted as not followed; "" for none.
std::string told(const DeclaredComments& declared) {
  SourceWarnings warnings;
  declared.tell("a.xyz", warnings);
  return warnings.is_empty() ? "" : warnings.all().front().message;
}

TEST(DeclaredComments, NameACrsInEverySpellingOfOneCode) {
  for (const std::string comment :
       {"crs: EPSG:2154", "SRS = epsg:2154", "epsg: 2154", "EPSG:2154", "EPSG 2154", "srid=2154",
        "Coordinate system: RGF93 / Lambert-93 (EPSG:2154)", "crs EPSG:2154",
        "Projection: EPSG 2154", "Horizontal CRS: urn:ogc:def:crs:EPSG::2154",
        "coordinate_reference_system = 'EPSG:2154'",
        "CRS: http://www.opengis.net/def/crs/EPSG/0/2154", "@Je2154", "@VGMT1.0 @GPOINT @Je2154",
        "crs: EPSG:2154, nodata: -9999"}) {
    const DeclaredComments declared = of({comment});
    EXPECT_EQ(declared.crs(), "EPSG:2154") << comment;
    EXPECT_EQ(told(declared), "") << comment;
  }
  EXPECT_EQ(of({"@Jp\"+proj=utm +zone=11 +datum=WGS84\""}).crs(),
            "+proj=utm +zone=11 +datum=WGS84");
  EXPECT_EQ(of({"projection: +proj=utm +zone=11"}).crs(), "+proj=utm +zone=11");
  const std::string wkt = R"(LOCAL_CS["site, of 1998",UNIT["metre",1]])";
  EXPECT_EQ(of({"wkt: " + wkt}).crs(), wkt);
  EXPECT_EQ(of({wkt}).crs(), wkt);
}

TEST(DeclaredComments, NameAVerticalCrs) {
  EXPECT_EQ(of({"vertical_crs: EPSG:5773"}).vertical_crs(), "EPSG:5773");
  EXPECT_EQ(of({"Vertical datum = EPSG:5773"}).vertical_crs(), "EPSG:5773");
  EXPECT_EQ(of({"crs: EPSG:5773"}).vertical_crs(), "EPSG:5773");
}

TEST(DeclaredComments, NameUnits) {
  for (const std::string comment : {"units: ft", "Units = feet", "File units = feet", "unit ft",
                                    "linear unit: foot", "Units are feet", "XYZ units: FT"}) {
    EXPECT_EQ(of({comment}).units(), (DeclaredUnits{"foot", "foot"})) << comment;
    EXPECT_EQ(told(of({comment})), "") << comment;
  }
  EXPECT_EQ(of({"z units: ft"}).units(), (DeclaredUnits{"", "foot"}));
  EXPECT_EQ(of({"Vertical_Units = feet"}).units(), (DeclaredUnits{"", "foot"}));
  EXPECT_EQ(of({"units: m", "height_units: ft"}).units(), (DeclaredUnits{"metre", "foot"}));
  EXPECT_EQ(of({"height_units: ft", "units: m"}).units(), (DeclaredUnits{"metre", "foot"}));
  EXPECT_EQ(of({"horizontal units: m"}).units(), (DeclaredUnits{"metre", ""}));
  EXPECT_EQ(of({"crs: EPSG:4326", "units: ft"}).units(), (DeclaredUnits{"", "foot"}));
  EXPECT_EQ(of({"crs: EPSG:2154", "units: m"}).units(), (DeclaredUnits{"", "metre"}));
  EXPECT_EQ(of({"crs: EPSG:2154", "z units: ft"}).units(), (DeclaredUnits{"", "foot"}));
}

TEST(DeclaredComments, NameTheValueThatMeansNoHeight) {
  for (const std::string comment :
       {"nodata -9999", "NODATA_value = -9999", "no data: -9999.0", "missing value: -9999"}) {
    EXPECT_EQ(of({comment}).nodata(), -9999.0) << comment;
    EXPECT_EQ(told(of({comment})), "") << comment;
  }
}

TEST(DeclaredComments, QuoteWhatCannotBeFollowed) {
  for (const std::string comment :
       {"coordinate system: UTM 33N", "datum: NAVD88", "Global shift: -500000 -4000000 0",
        "translate 500000 4000000 0", "shift 1 2 3", "up axis: Y", "scale: 0.01",
        "origin = 500000, 4000000", "units: cubits", "converted from EPSG:4326",
        "crs: EPSG:4326 to EPSG:2154", "Zone: 33", "all elevations in feet",
        "nodata: -9999 or 0"}) {
    const DeclaredComments declared = of({comment});
    EXPECT_NE(told(declared).find("'" + comment + "'"), std::string::npos) << comment;
    EXPECT_EQ(declared.crs(), "") << comment;
    EXPECT_EQ(declared.units(), DeclaredUnits{}) << comment;
  }
}

TEST(DeclaredComments, TakeAUnitBehindAVerticalDatumForThatOfHeights) {
  const DeclaredComments declared = of({"crs: EPSG:2154", "Vertical datum: EGM2008, unit: ft"});
  EXPECT_EQ(declared.units(), (DeclaredUnits{"", "foot"}));
  EXPECT_NE(told(declared).find("a comment tells"), std::string::npos) << told(declared);
}

TEST(DeclaredComments, QuoteWhatContradictsItself) {
  const DeclaredComments crs = of({"crs: EPSG:2154", "epsg: 32631"});
  EXPECT_EQ(crs.crs(), "");
  EXPECT_NE(told(crs).find("'crs: EPSG:2154', 'epsg: 32631'"), std::string::npos) << told(crs);
  const DeclaredComments unit = of({"crs: EPSG:2154", "units: feet"});
  EXPECT_EQ(unit.units(), DeclaredUnits{});
  EXPECT_NE(told(unit).find("'units: feet'"), std::string::npos) << told(unit);
  EXPECT_EQ(of({"crs: EPSG:2154", "EPSG:2154"}).crs(), "EPSG:2154");
}

TEST(DeclaredComments, PassOverRemarks) {
  for (const std::string comment :
       {"made by hand in 1998", "x y z", "lat lon ele", "Global shift: 0 0 0", "scale: 1",
        "up axis: Z", "crs: unknown", "projection: none", "original file: survey2.txt",
        "unit tests of 2020", "@VGMT1.0 @GPOINT", "FEATURE_DATA", "https://example.org/a?b=1",
        "Easting, Northing, Elevation", "1 2 3", "", "Points: 200", "offsets 0.0, 0.0, 0.0"}) {
    const DeclaredComments declared = of({comment});
    EXPECT_EQ(told(declared), "") << comment;
    EXPECT_EQ(declared.crs(), "") << comment;
  }
}

}  // namespace
}  // namespace ptin
