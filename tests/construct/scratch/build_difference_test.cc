// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/scratch/build_difference.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ptin {
namespace {

using nlohmann::json;

json begun() {
  return json::parse(R"({
    "options": {"max_error": 0.0, "a_srs": "EPSG:2154", "tile": null},
    "page_bytes": 4096,
    "inputs": [["/d/a.tif", [["/d/a.tif", 100, 7], ["/d/a.tif.aux.xml", 5, 7]]],
               ["/d/b.tif", [["/d/b.tif", 50, 3]]]],
    "program": ["0.1", 3]})");
}

TEST(WhatDiffers, NamesTheOptionWithBothValues) {
  json now = begun();
  now["options"]["max_error"] = 5.0;
  now["options"].erase("a_srs");
  now["options"]["classes"] = {2, 9};
  now["options"]["repair"] = true;
  now["options"]["tile"] = 256;
  EXPECT_EQ(what_differs(begun(), now),
            "--a-srs was EPSG:2154 and is not given; --class was not given and is 2 9; --max-error "
            "was 0 and is 5; --repair was not given and is given; --tile was not given and is "
            "256");
}

TEST(WhatDiffers, NamesTheInputAndWhatChanged) {
  json now = begun();
  now["inputs"][0][1][0][1] = 120;
  now["inputs"][1][1][0][2] = 4;
  EXPECT_EQ(what_differs(begun(), now),
            "/d/a.tif had 100 bytes and has 120; /d/b.tif was written to since");
  now = begun();
  now["inputs"][0][1].erase(1);
  EXPECT_EQ(what_differs(begun(), now), "/d/a.tif.aux.xml is gone");
  EXPECT_EQ(what_differs(now, begun()), "/d/a.tif.aux.xml was not there");
  now = begun();
  now["inputs"][1][0] = "/d/c.tif";
  EXPECT_EQ(what_differs(begun(), now),
            "the input /d/b.tif is named no longer; the input /d/c.tif is new");
  now = begun();
  std::swap(now["inputs"][0], now["inputs"][1]);
  EXPECT_EQ(what_differs(begun(), now), "the inputs come in another order");
}

TEST(WhatDiffers, NamesTheVersion) {
  json now = begun();
  now["program"] = {"0.2", 4};
  EXPECT_EQ(what_differs(begun(), now), "it was begun by ptin 0.1, and this is 0.2");
  for (const json& other : {json(), json(3), json{{"of", 1}}, json{{"options", 1}, {"inputs", 2}}})
    EXPECT_EQ(what_differs(other, begun()), "it was begun by another version of ptin");
}

TEST(WhatDiffers, TellsSixAndCountsTheRest) {
  json now = begun();
  for (const char* key : {"a", "b", "c", "d", "e", "f", "g", "h"}) now["options"][key] = 1;
  const std::string told = what_differs(begun(), now);
  EXPECT_TRUE(told.ends_with("--f was not given and is 1; and 2 more")) << told;
}

}  // namespace
}  // namespace ptin
