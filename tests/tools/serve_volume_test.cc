// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volumes over HTTP: what `ptin volume` answers.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

class ServeVolume : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TestFolder>();
    serve::ServeOptions options;
    options.http = unhurried_limits();
    options.http.threads = 1;
    const auto add = [&](const std::string& name, const RasterRecipe& recipe) {
      make_raster(folder_->file(name + ".tif"), recipe);
      build_terrain(folder_->file(name + ".tif"), file(name));
      options.files.push_back({name, file(name)});
    };
    add("hills", {.value = hills});
    add("higher", {.value = [](int x, int y) { return hills(x, y) + 2; }});
    add("elsewhere", {.value = hills, .epsg = 25832});
    served_ = std::make_unique<ServedTerrains>(options);
  }
  static void TearDownTestSuite() {
    served_.reset();
    folder_.reset();
  }
  static std::string file(const std::string& name) { return folder_->file(name + ".ptin"); }
  /// What the command line tells of the same, without what the service tells in headers.
  static json told(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"volume", file("hills"), "--json"});
    json answer = answer_of(arguments);
    answer.erase("cost");
    answer.erase("output");
    answer.erase("transformed");
    return answer;
  }
  static void expect_same(const std::string& query, const json& program) {
    const json served = served_->get("/collections/hills/volume?crs=native&" + query).json();
    for (const auto& [name, value] : program.items()) {
      if (name == "units") {
        EXPECT_EQ(served.at("units").at("ground"), value.at("ground"));
      } else if (name == "against" && value.is_object()) {
        EXPECT_EQ(served.at("against").at("certified_error"), value.at("certified_error"));
      } else {
        EXPECT_EQ(served.at(name), value) << name;
      }
    }
  }
  static std::unique_ptr<TestFolder> folder_;
  static std::unique_ptr<ServedTerrains> served_;
};

std::unique_ptr<TestFolder> ServeVolume::folder_;
std::unique_ptr<ServedTerrains> ServeVolume::served_;

TEST_F(ServeVolume, IsWhatTheProgramAnswers) {
  expect_same("against=90", told({"--level", "90"}));
  expect_same("against=90&error=2&bbox=500100,3999400,500600,3999900",
              told({"--level", "90", "--error", "2", "--window", "500100", "3999400", "500600",
                    "3999900"}));
  const std::string polygon =
      "POLYGON((500100 3999400,500600 3999400,500300 3999900,500100 3999400))";
  expect_same("against=90&coords=" + encoded(polygon),
              told({"--level", "90", "--polygon", polygon}));
  expect_same("against=higher", told({"--against", file("higher")}));
  const json posted =
      served_->post("/collections/hills/volume", {{"against", 90}, {"crs", "native"}}).json();
  EXPECT_EQ(posted.at("cut"), told({"--level", "90"}).at("cut"));
}

TEST_F(ServeVolume, SaysWhatIsWrong) {
  const auto refused = [](const std::string& query, int status, const std::string& parameter) {
    const HttpAnswer answer = served_->get("/collections/hills/volume?" + query);
    EXPECT_EQ(answer.status, status) << query << answer.body;
    EXPECT_EQ(answer.json().value("parameter", ""), parameter) << answer.body;
  };
  refused("", 400, "against");
  refused("against=nobody", 404, "against");
  refused("against=nan", 404, "against");
  refused("against=elsewhere", 400, "against");
  refused("against=1&bbox=1,2,3,4", 400, "bbox");
  refused("against=1&coords=POINT(1%202)", 400, "coords");
  refused("against=1&error=-1", 400, "error");
}

}  // namespace
}  // namespace ptin::tools::testing
