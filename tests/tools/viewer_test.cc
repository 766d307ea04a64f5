// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin viewer: a folder that any web host can give out.
#include <filesystem>
#include <map>
#include <span>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tools/http/gzip.h"
#include "tools/viewer/first_mesh.h"
#include "tools/viewer/viewer_page.h"

namespace ptin::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

class ViewerCli : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }
  /// A stream of a small terrain under this name.
  std::string stream(const std::string& name) {
    const std::string store = testing::built(folder, "mountains_257.tif", "m.ptin");
    expect_done({"stream", store, "--error", "20", "-o", file(name), "-q"});
    fs::remove(store);
    return file(name);
  }
  TestFolder folder;
};

TEST_F(ViewerCli, WritesThePageAndTheStreamThatItOpens) {
  const std::string dem = stream("dem.ptins");
  const json answer = answer_of({"viewer", "-o", file("site"), "--stream", dem, "--json"});
  EXPECT_EQ(answer.at("stream"), "dem.ptins");
  EXPECT_EQ(answer.at("files").size(), 11U);
  for (const json& written : answer.at("files")) {
    const std::string name = written.at("name");
    EXPECT_EQ(written.at("bytes"), fs::file_size(file("site/" + name))) << name;
  }
  EXPECT_EQ(read_file(file("site/dem.ptins")), read_file(dem));
  EXPECT_NE(read_file(file("site/index.html")).find(R"(name="ptin-stream" content="./dem.ptins")"),
            std::string::npos);
  for (const ViewerFile& packed : viewer_files()) {
    if (packed.name == "index.html") continue;
    EXPECT_EQ(read_file(file("site/" + std::string(packed.name))), packed.content) << packed.name;
  }
}

TEST_F(ViewerCli, WithoutAStreamThePageOpensNone) {
  expect_done({"viewer", "-o", file("site"), "-q"});
  EXPECT_NE(read_file(file("site/index.html")).find(R"(name="ptin-stream" content="")"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(file("site/dem.ptins")));
}

TEST_F(ViewerCli, ReplacesWhatIsThereOnlyWhenAsked) {
  expect_done({"viewer", "-o", file("site"), "-q"});
  write_file(file("site/worker.js"), "mine");
  const Outcome refused = run_ptin({"viewer", "-o", file("site"), "-q"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("--overwrite"), std::string::npos) << refused.err;
  EXPECT_EQ(read_file(file("site/worker.js")), "mine");
  expect_done({"viewer", "-o", file("site"), "--overwrite", "-q"});
  EXPECT_NE(read_file(file("site/worker.js")), "mine");
}

TEST_F(ViewerCli, AStreamThatLiesInTheFolderStaysWhereItIs) {
  fs::create_directory(file("site"));
  const std::string dem = stream("site/dem.ptins");
  const json answer = answer_of({"viewer", "-o", file("site"), "--stream", dem, "--json"});
  EXPECT_EQ(answer.at("files").size(), 10U);
  EXPECT_EQ(answer.at("stream"), "dem.ptins");
}

TEST_F(ViewerCli, RefusesWhatIsNoStream) {
  const std::string store = testing::built(folder, "mountains_257.tif", "m.ptin");
  write_file(file("other.txt"), "something else");
  write_file(file("empty.ptins"), "");
  fs::copy_file(stream("dem.ptins"), file("worker.js"));
  const auto refusal = [&](const std::string& name) {
    const Outcome outcome = run_ptin({"viewer", "-o", file("site"), "--stream", file(name)});
    EXPECT_EQ(outcome.status, 2) << name;
    EXPECT_FALSE(fs::exists(file("site"))) << "nothing is written for " << name;
    return outcome.err;
  };
  EXPECT_NE(refusal("other.txt").find("does not begin like a stream"), std::string::npos);
  EXPECT_NE(refusal("empty.ptins").find("does not begin like a stream"), std::string::npos);
  EXPECT_NE(refusal("worker.js").find("own files"), std::string::npos);
  EXPECT_NE(refusal(".").find("a folder"), std::string::npos);
  expect_done({"build", testing::test_data("mountains_257.tif"), "-o", file("n.ptin"), "-q"});
  EXPECT_NE(refusal("n.ptin").find("a store, not a stream"), std::string::npos);
  EXPECT_EQ(run_ptin({"viewer", "-o", file("site"), "--stream", file("none.ptins")}).status, 3);
  EXPECT_EQ(run_ptin({"viewer", "-o", file("no/site")}).status, 3) << "the folder above is missing";
}

TEST_F(ViewerCli, TheFirstPictureLiesInThePage) {
  const std::string dem = stream("dem.ptins");
  expect_done({"viewer", "-o", file("site"), "--stream", dem, "-q"});
  const std::string page = read_file(file("site/index.html"));
  constexpr std::string_view kBegin = R"(<script type="application/json" id="first-mesh">)";
  const std::size_t at = page.find(kBegin);
  ASSERT_NE(at, std::string::npos);
  const std::size_t end = page.find("</script>", at);
  const json first = json::parse(page.substr(at + kBegin.size(), end - at - kBegin.size()));
  EXPECT_EQ(first.at("facts").size(), 15U);
  EXPECT_GT(first.at("vertices"), 300);
  EXPECT_GE(first.at("error"), 20.0) << "of a coarser mesh than the stream's last";
  EXPECT_TRUE(json::accept(first.at("metadata").get<std::string>()));
  // A stream that is damaged from its beginning has a page all the same, which will tell it.
  std::string bytes = read_file(dem);
  bytes[300] = static_cast<char>(bytes[300] ^ 1);
  write_file(file("bad.ptins"), bytes);
  expect_done({"viewer", "-o", file("bad"), "--stream", file("bad.ptins"), "-q"});
  EXPECT_EQ(read_file(file("bad/index.html")).find("first-mesh"), std::string::npos);
}

/// The JSON of an element of first_mesh_element().
json written_in(const std::string& element) {
  const std::size_t begin = element.find('>') + 1;
  return json::parse(element.substr(begin, element.rfind('<') - begin));
}

TEST_F(ViewerCli, ABeginningThatCertifiesNothingMakesAPreviewThatSaysSo) {
  // The borders of voids of one sample each come first, and no error is finite before.
  std::string grid =
      "ncols 97\nnrows 49\nxllcorner 400000\nyllcorner 5000000\ncellsize 10\n"
      "NODATA_value -9999\n";
  for (int row = 0; row < 49; ++row) {
    for (int column = 0; column < 97; ++column) {
      const bool is_void = row % 3 == 1 && column % 3 == 1;
      grid += is_void ? "-9999 " : std::to_string(400 + row * row / 8 + column * row / 16) + " ";
    }
    grid += "\n";
  }
  write_file(file("holes.asc"), grid);
  expect_done({"build", file("holes.asc"), "--a-srs", "EPSG:32632", "-o", file("h.ptin"), "-q"});
  expect_done({"stream", file("h.ptin"), "-o", file("holes.ptins"), "-q"});
  const std::string stream = read_file(file("holes.ptins"));
  const std::span<const std::byte> bytes = std::as_bytes(std::span(stream));
  const std::string preview = first_mesh_element(bytes.first(2500));
  EXPECT_TRUE(is_preview(preview));
  const json first = written_in(preview);
  EXPECT_TRUE(first.at("error").is_null());
  EXPECT_TRUE(first.at("deviation").is_null());
  EXPECT_EQ(first.at("vertices"), 33 * 17) << "a lattice of squares over the bounds";
  EXPECT_EQ(first.at("triangles"), 2 * 32 * 16);
  const std::string certified = first_mesh_element(bytes);
  EXPECT_FALSE(is_preview(certified));
  EXPECT_TRUE(written_in(certified).at("error").is_number());
  EXPECT_TRUE(first_mesh_element(bytes.first(10)).empty()) << "of no mesh there is none";
}

TEST(ViewerPage, AnyNameIsAnAddressBesideThePage) {
  const std::string page = viewer_page_for("a \"b\" <c>&#?:100%\xC3\xA4.ptins");
  EXPECT_NE(page.find("content=\"./a%20%22b%22%20%3Cc%3E%26%23%3F%3A100%25%C3%A4.ptins\">"),
            std::string::npos);
}

TEST(ViewerPage, TheFilesAreSmallEnoughToOpenQuickly) {
  std::map<std::string_view, std::size_t> bytes;
  std::size_t at_once = 0, packed = 0;
  for (const ViewerFile& file : viewer_files()) {
    EXPECT_FALSE(file.content.empty()) << file.name;
    bytes[file.name] = file.content.size();
    if (file.name.ends_with(".wasm")) {
      EXPECT_TRUE(file.content.starts_with(std::string_view("\0asm", 4))) << file.name;
    }
    if (file.name == "questions.wasm" || file.name == "base_map.js") continue;
    at_once += file.content.size();
    packed += http::gzip(file.content, http::GzipFor::kManyAnswers).size();
  }
  EXPECT_LT(bytes.at("decoder.wasm"), 90'000U) << "what every visitor waits for";
  EXPECT_LT(bytes.at("questions.wasm"), 135'000U) << "fetched when something is asked";
  EXPECT_LT(bytes.at("base_map.js"), 8'000U) << "fetched when a base map is turned on";
  EXPECT_LT(at_once, 260'000U) << "before packing";
  EXPECT_LT(packed, 100'000U) << "as a browser gets it";
}

}  // namespace
}  // namespace ptin::tools
