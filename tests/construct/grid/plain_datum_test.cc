// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/plain_datum.h"

#include <string>
#include <thread>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "engine/construct/grid/crs.h"

namespace ptin {
namespace {

TEST(PlainDatum, TakesThePlaceOfAnEnsemble) {
  EXPECT_EQ(with_plain_datums(R"(GEOGCRS["g",ENSEMBLE["World ensemble",MEMBER["a",ID["EPSG",1]],)"
                              R"(MEMBER["b"],ELLIPSOID["e",1,2],ENSEMBLEACCURACY[2.0],)"
                              R"(ID["EPSG",6326]],PRIMEM["Greenwich",0]])"),
            R"(GEOGCRS["g",DATUM["World",ELLIPSOID["e",1,2],ID["EPSG",6326]],)"
            R"(PRIMEM["Greenwich",0]])");
}

TEST(PlainDatum, OfHeightsIsAVerticalOne) {
  EXPECT_EQ(with_plain_datums(R"(VERTCRS["v",ENSEMBLE["Isles",MEMBER["a"],ENSEMBLEACCURACY[0.4]],)"
                              R"(CS[vertical,1]])"),
            R"(VERTCRS["v",VDATUM["Isles"],CS[vertical,1]])");
}

TEST(PlainDatum, IsGivenForEachEnsembleOfACompoundCrs) {
  EXPECT_EQ(with_plain_datums(R"(A[ENSEMBLE["x",ELLIPSOID["e",1]],ENSEMBLE["y",MEMBER["m"]]])"),
            R"(A[DATUM["x",ELLIPSOID["e",1]],VDATUM["y"]])");
}

TEST(PlainDatum, LeavesNamesAndOtherTextsAlone) {
  for (const std::string text : {R"(A["an ENSEMBLE[ "" ENSEMBLE[",DATUM["d, ] ensemble"]])", "",
                                 "ENSEMBLE[", R"(ENSEMBLE["a)"}) {
    EXPECT_EQ(with_plain_datums(text), text);
  }
}

/// The CRS of the GeoTIFF `path`, read on a thread of its own where `asked` was understood before.
/// Each thread has a cache of PROJ's of its own.
std::string crs_where_asked_before(const std::string& path, const std::vector<std::string>& asked) {
  std::string text;
  std::thread([&] {
    for (const std::string& code : asked) {
      OGRSpatialReference srs;
      EXPECT_EQ(srs.SetFromUserInput(code.c_str()), OGRERR_NONE);
    }
    const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str()));
    ASSERT_TRUE(data);
    text = wkt2_of(*data->GetSpatialRef());
  }).join();
  return text;
}

TEST(PlainDatum, MakesTheTextOfACrsOneWhateverWasAskedBefore) {
  GDALAllRegister();
  const std::string path = "/vsimem/plain_datum.tif";
  OGRSpatialReference srs;
  ASSERT_EQ(srs.importFromEPSG(32610), OGRERR_NONE);
  {
    const GDALDatasetUniquePtr made(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path.c_str(), 2, 2, 1, GDT_Byte, nullptr));
    ASSERT_EQ(made->SetSpatialRef(&srs), CE_None);
  }
  const std::string fresh = crs_where_asked_before(path, {});
  EXPECT_NE(fresh.find("DATUM[\"World Geodetic System 1984\","), std::string::npos) << fresh;
  for (const std::string code : {"EPSG:4326", "EPSG:32611", "EPSG:32610", "EPSG:4979"}) {
    EXPECT_EQ(crs_where_asked_before(path, {code}), fresh) << code;
  }
  VSIUnlink(path.c_str());
}

}  // namespace
}  // namespace ptin
