// SPDX-License-Identifier: GPL-3.0-or-later
//
// --vertices, end to end, of the questions that take levels of detail: so many vertices as an error
// needs are the terrain at that error, all of them are the terrain, and the certificate is never
// wrong between.
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::run_ptin;
using testing::TestFolder;

using Arguments = std::vector<std::string>;

class FirstVertices : public ::testing::Test {
 protected:
  FirstVertices() {
    const json info = answer_of({"info", file_, "--json"});
    const json& b = info.at("bounds");
    const auto place = [&](const char* low, const char* high, double part) {
      return std::to_string(b.at(low).get<double>() * (1 - part) + b.at(high).get<double>() * part);
    };
    x_ = place("min_x", "max_x", 0.31);
    y_ = place("min_y", "max_y", 0.27);
    far_x_ = place("min_x", "max_x", 0.78);
    far_y_ = place("min_y", "max_y", 0.71);
    all_ = info.at("vertices").get<std::uint64_t>();
    at_error_ = answer_of({"refine", file_, "--error", "20", "-o", folder_.file("r.ply"), "--json"})
                    .at("vertices")
                    .get<std::uint64_t>();
  }

  /// The command with more arguments.
  static json asked(Arguments command, const Arguments& more) {
    command.insert(command.end(), more.begin(), more.end());
    command.emplace_back("--json");
    return answer_of(command);
  }
  /// What `of` takes from the answers of a command must be the same at an error and at as many
  /// vertices, and exactly and at all of them.
  template <class Of>
  void expect_levels_of_one_terrain(const Arguments& command, const Of& of) const {
    const json at_error = asked(command, {"--error", "20"});
    const json as_many = asked(command, {"--vertices", std::to_string(at_error_)});
    EXPECT_EQ(of(at_error), of(as_many));
    EXPECT_EQ(as_many.at("exact"), false);
    const json exact = asked(command, {});
    const json all = asked(command, {"--vertices", std::to_string(all_)});
    EXPECT_EQ(of(exact), of(all));
    EXPECT_EQ(exact.at("exact"), true);
    EXPECT_EQ(all.at("exact"), true);
    EXPECT_NE(of(exact), of(as_many)) << "a question that shows no difference shows nothing";
    Arguments too_few = command;
    too_few.insert(too_few.end(), {"--vertices", "1"});
    EXPECT_EQ(run_ptin(too_few).status, 2);
  }

  TestFolder folder_;
  std::string file_ = testing::built(folder_, "mountains_257.tif");
  std::string x_, y_, far_x_, far_y_;
  std::uint64_t all_ = 0, at_error_ = 0;
};

TEST_F(FirstVertices, Isolines) {
  expect_levels_of_one_terrain(
      {"isoline", file_, "--interval", "100", "-o", folder_.file("i.gpkg"), "--overwrite"},
      [](const json& answer) {
        return json{answer.at("lines"), answer.at("points")};
      });
}

TEST_F(FirstVertices, LinesOfSight) {
  // The Fresnel zone is that of the surface of the level; the clearance may be settled.
  expect_levels_of_one_terrain(
      {"sight", file_, x_, far_y_, "300", far_x_, far_y_, "300", "--frequency", "1GHz"},
      [](const json& answer) {
        const json& clearance = answer.at("clearance");
        return json{clearance.at("min"), clearance.at("max"), answer.at("fresnel").at("ratio")};
      });
}

TEST_F(FirstVertices, Viewsheds) {
  expect_levels_of_one_terrain({"viewshed", file_, x_, y_, "30", "--radius", "5000", "-o",
                                folder_.file("v.tif"), "--overwrite"},
                               [](const json& answer) { return answer.at("pixels"); });
}

TEST_F(FirstVertices, HighestPoints) {
  expect_levels_of_one_terrain(
      {"highest", file_, "--window", x_, y_, far_x_, far_y_, "-k", "50"}, [](const json& answer) {
        return json{answer.at("point").at("height"), answer.at("vertices")};
      });
}

TEST_F(FirstVertices, SayHowFarTheyMayBeOff) {
  const Arguments some = {"--vertices", "300"};
  const Arguments isoline = {"isoline", file_, "--interval", "100", "-o", folder_.file("i.gpkg")};
  const Arguments viewshed = {"viewshed",           file_, x_, y_, "30", "--radius", "2000", "-o",
                              folder_.file("v.tif")};
  for (const Arguments& command : {isoline, viewshed, Arguments{"highest", file_}}) {
    EXPECT_GT(asked(command, some).at("certified_deviation").get<double>(), 0.0) << command[0];
  }
  const json clearance =  // a line of sight says it of what it is asked about
      asked({"sight", file_, x_, y_, "300", far_x_, far_y_, "300"}, some).at("clearance");
  EXPECT_LT(clearance.at("min").get<double>(), clearance.at("max").get<double>());
}

TEST_F(FirstVertices, CertificatesHoldTheExactAnswer) {
  const Arguments highest = {"highest", file_, "--window", x_, y_, far_x_, far_y_};
  const json exact = asked(highest, {});
  for (const char* count : {"10", "100", "1000", "10000"}) {
    const json some = asked(highest, {"--vertices", count});
    const double height = exact.at("point").at("height").get<double>();
    EXPECT_LE(some.at("point").at("height_min").get<double>(), height) << count;
    EXPECT_GE(some.at("point").at("height_max").get<double>(), height) << count;
    const json seen =
        asked({"sight", file_, x_, y_, "300", far_x_, far_y_, "300"}, {"--vertices", count});
    const json truth = asked({"sight", file_, x_, y_, "300", far_x_, far_y_, "300"}, {});
    EXPECT_TRUE(seen.at("verdict") == "undecided" || seen.at("verdict") == truth.at("verdict"))
        << count;
  }
}

}  // namespace
}  // namespace ptin::tools
