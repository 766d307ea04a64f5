// SPDX-License-Identifier: GPL-3.0-or-later
//
// Title and attribution of a file: from `ptin build` to all who show it.
#include "engine/crs/credits.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/utf8.h"
#include "tests/tools/program.h"
#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

const std::string kTitle = "Höhen & <Täler>";
const std::string kAttribution = "© Landesamt \"Nord\"";

class CreditsOfAFile : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TestFolder>();
    make_raster(folder_->file("hills.tif"), {.value = hills});
    build({"-o", file("plain.ptin")});
    build({"-o", file("named.ptin"), "--title", kTitle, "--attribution", kAttribution});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string file(const std::string& name) { return folder_->file(name); }
  static void build(std::vector<std::string> more) {
    more.insert(more.begin(), {"build", file("hills.tif"), "-q"});
    expect_done(more);
  }
  static std::unique_ptr<TestFolder> folder_;
};

std::unique_ptr<TestFolder> CreditsOfAFile::folder_;

TEST_F(CreditsOfAFile, ChangeNothingButItsMetadata) {
  const json named = answer_of({"info", file("named.ptin"), "--json"});
  const json plain = answer_of({"info", file("plain.ptin"), "--json"});
  EXPECT_EQ(named.at("title"), kTitle);
  EXPECT_EQ(named.at("attribution"), kAttribution);
  EXPECT_FALSE(plain.contains("title") || plain.contains("attribution"));
  const std::string text = run_ptin({"info", file("named.ptin")}).out;
  EXPECT_NE(text.find("title      " + kTitle + "\n"), std::string::npos) << text;
  EXPECT_NE(text.find("credit     " + kAttribution + "\n"), std::string::npos) << text;
  json options = named.at("metadata");
  EXPECT_EQ(options.at("options").erase("title") + options.at("options").erase("attribution"), 2U);
  EXPECT_EQ(options, plain.at("metadata"));
  const std::string with = read_file(file("named.ptin")), without = read_file(file("plain.ptin"));
  ASSERT_EQ(named.at("sections").size(), plain.at("sections").size());
  for (std::size_t i = 0; i < named.at("sections").size(); ++i) {
    const auto bytes_of = [&](const json& info, const std::string& all) {
      const json& section = info.at("sections")[i];
      return all.substr(section.at("offset"), section.at("bytes"));
    };
    // Beside the metadata those that say where the others are, and what their checksums.
    const std::string name = named.at("sections")[i].at("name");
    if (name == "header" || name == "section table" || name == "metadata") continue;
    EXPECT_EQ(bytes_of(named, with), bytes_of(plain, without)) << named.at("sections")[i];
  }
}

TEST_F(CreditsOfAFile, ThatNoFileHoldsAreRefused) {
  const auto refused = [](const std::string& option, const std::string& text) {
    const Outcome outcome =
        run_ptin({"build", file("hills.tif"), "-o", file("no.ptin"), "-q", option, text});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("at most 1,000 bytes of UTF-8 without control characters"),
              std::string::npos)
        << outcome.err;
  };
  refused("--title", std::string(1001, 'a'));
  refused("--title", "two\nlines");
  refused("--attribution", "\x1b[31mred");
  refused("--attribution",
          "\xC2\x9B"
          "31mred");
  refused("--attribution", "latin \xE4");
  refused("--title", "half \xE2\x82");
  EXPECT_TRUE(is_credit(std::string(1000, 'a')));
  EXPECT_FALSE(is_plain_text("\xC0\xAF"));      // longer than need be
  EXPECT_FALSE(is_plain_text("\xED\xA0\x80"));  // a surrogate
  EXPECT_TRUE(is_plain_text("\xF0\x9F\x8F\x94"));
}

TEST_F(CreditsOfAFile, AreWhatItsMetadataSayUnlessNoBuildWritesIt) {
  EXPECT_EQ(credits_of(json{{"options", {{"title", "a"}}}}).title, "a");
  EXPECT_EQ(credits_of(json{{"options", {{"title", "a\nb"}}}}).title, "");
  EXPECT_EQ(credits_of(json{{"options", {{"title", {1, 2}}}}}).title, "");
  EXPECT_EQ(credits_of(json{{"options", "title"}}).title, "");
  EXPECT_EQ(credits_of(json{{"title", "a"}}).title, "");
}

TEST_F(CreditsOfAFile, GoWithItsStreams) {
  const auto start_of = [](const std::string& name) {
    expect_done({"stream", file(name + ".ptin"), "-o", file(name + ".pts"), "--splits", "0"});
    return read_file(file(name + ".pts"));
  };
  const std::string named = start_of("named");
  EXPECT_NE(named.find("\"title\":" + json(kTitle).dump()), std::string::npos);
  EXPECT_NE(named.find("\"attribution\":" + json(kAttribution).dump()), std::string::npos);
  EXPECT_EQ(start_of("plain").find("\"title\""), std::string::npos);
}

TEST_F(CreditsOfAFile, AreServed) {
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.files = {{"named", file("named.ptin")}, {"plain", file("plain.ptin")}};
  options.http.threads = 1;
  ServedTerrains served(options);
  const json named = served.get("/collections/named").json();
  EXPECT_EQ(named.at("title"), kTitle);
  EXPECT_EQ(named.at("attribution"), kAttribution);
  const json plain = served.get("/collections/plain").json();
  EXPECT_FALSE(plain.contains("title") || plain.contains("attribution"));
  const json layer = served.get("/collections/named/tiles/layer.json").json();
  EXPECT_EQ(layer.at("name"), kTitle);
  EXPECT_EQ(layer.at("attribution"), "© Landesamt &quot;Nord&quot;");
  for (const char* what : {"dem", "contours"}) {
    const json tiles =
        served.get(std::string("/collections/named/") + what + "/tilejson.json").json();
    EXPECT_EQ(tiles.at("attribution"), "© Landesamt &quot;Nord&quot;") << what;
  }
  EXPECT_EQ(served.get("/collections/plain/tiles/layer.json").json().at("name"), "plain");
  const json extras = served.get("/collections/named/tileset.json").json().at("asset").at("extras");
  EXPECT_EQ(extras.at("title"), kTitle);
  EXPECT_EQ(extras.at("attribution"), kAttribution);
  EXPECT_EQ(extras.at("cesium").at("credits")[0].at("html"), layer.at("attribution"));
  EXPECT_FALSE(served.get("/collections/plain/tileset.json").json().at("asset").contains("extras"));
  const std::string page = served.get("/", "Accept: text/html\r\n").body;
  EXPECT_NE(page.find("<h2>Höhen &amp; &lt;Täler></h2>"), std::string::npos) << page;
  EXPECT_NE(page.find("© Landesamt &quot;Nord&quot;"), std::string::npos) << page;
}

}  // namespace
}  // namespace ptin::tools::testing
