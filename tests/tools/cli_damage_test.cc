// SPDX-License-Identifier: GPL-3.0-or-later
//
// Damaged stores, and those of a newer version: the documented exit status, one clear sentence, and
// nothing left behind.
#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/storage/seal.h"
#include "tests/tools/program.h"
#include "tests/tools/refusal.h"

namespace ptin::tools {
namespace {

using testing::expect_refusal;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::small_store;
using testing::TestFolder;
using testing::write_file;

TEST(CliBadInput, DamagedStores) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const std::string sound = read_file(store);
  const std::string bad = folder.file("bad.ptin");
  const auto refine = [&] { return run_ptin({"refine", bad, "-o", folder.file("a.ply")}); };
  write_file(bad, sound.substr(0, sound.size() / 2));
  expect_refusal(run_ptin({"info", bad}), 4, "bad.ptin");
  expect_refusal(refine(), 4, "bad.ptin");
  EXPECT_EQ(run_ptin({"verify", bad, "-q"}).status, 1);
  std::string flipped = sound;
  const std::size_t at = flipped.size() / 2;  // heights lie behind the pages of records
  flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
  write_file(bad, flipped);
  EXPECT_EQ(run_ptin({"info", bad}).status, 0) << "info reads no record page";
  expect_refusal(refine(), 4, "page");
  const Outcome verified = run_ptin({"verify", bad, "-q"});
  EXPECT_EQ(verified.status, 1);
  EXPECT_NE(verified.out.find("page"), std::string::npos) << verified.out;
  const std::vector<std::string> left = {"bad.ptin", "hills.ptin", "hills.tif"};
  EXPECT_EQ(folder.names(), left);
}

TEST(CliBadInput, FilesThatAreNoStores) {
  const TestFolder folder;
  const std::string raster = PTIN_TEST_DATA "/mountains_257.tif";
  write_file(folder.file("empty.ptin"), "");
  write_file(folder.file("prose.ptin"), "POINTS ARE NOT A STORE, WHATEVER THEIR NAME SAYS");
  const auto refused = [&](const std::string& path, const std::string& words) {
    for (const std::vector<std::string>& question :
         std::vector<std::vector<std::string>>{{"info", path},
                                               {"verify", path, "-q"},
                                               {"locate", path, "0", "0"},
                                               {"highest", path},
                                               {"serve", path, "--listen", "127.0.0.1:0"},
                                               {"volume", path, "--level", "0"},
                                               {"stream", path, "-o", folder.file("a.ptins")},
                                               {"export", path, "-o", folder.file("a.ply")}}) {
      SCOPED_TRACE(question[0]);
      expect_refusal(run_ptin(question), 2, words);
    }
  };
  refused(folder.file("empty.ptin"), "this is not a .ptin file: it is empty");
  refused(folder.file("prose.ptin"), "it begins like a text");
  refused(raster, "it begins like a TIFF, as GeoTIFFs do; `ptin build` makes a .ptin file of it");
  refused(folder.path().string(), "folder");
  EXPECT_EQ(folder.names().size(), 2U);
}

/// The store with another `source` in its metadata, every checksum right; no longer than before.
std::string with_source(const std::string& store, const nlohmann::json& source) {
  test::Bytes bytes(store.size());
  std::memcpy(bytes.data(), store.data(), store.size());
  const auto section = test::section_of(bytes, layout::SectionKind::kMetadata);
  nlohmann::json metadata = nlohmann::json::parse(store.substr(section.offset, section.bytes));
  metadata["source"] = source;
  std::string text = metadata.dump();
  EXPECT_LE(text.size(), section.bytes);
  text.resize(section.bytes, ' ');
  std::memcpy(bytes.data() + section.offset, text.data(), text.size());
  test::seal(bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(CliBadInput, MetadataOfOtherTypes) {
  const TestFolder folder;
  const std::string sound = read_file(small_store(folder));
  const std::string bad = folder.file("bad.ptin");
  const auto sources = {nlohmann::json(3), nlohmann::json{{"void_samples", "0"}},
                        nlohmann::json{{"lone_samples", -1}}};
  for (const nlohmann::json& source : sources) {
    write_file(bad, with_source(sound, source));
    expect_refusal(run_ptin({"export", bad, "-q", "-o", folder.file("a.tif")}), 4, "metadata");
  }
  write_file(bad, with_source(sound, nlohmann::json::object()));
  testing::expect_done({"export", bad, "-q", "-o", folder.file("a.tif")});
}

TEST(CliBadInput, StoreOfANewerVersion) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  std::string newer = read_file(store);
  newer[8] = 4;  // major version
  write_file(folder.file("newer.ptin"), newer);
  expect_refusal(run_ptin({"info", folder.file("newer.ptin")}), 5, "version");
  expect_refusal(run_ptin({"verify", folder.file("newer.ptin"), "-q"}), 5, "version");
}

// A file of format 1 as it was written, and one of which nothing but the version is known.
TEST(CliBadInput, StoreOfTheProvisionalVersion) {
  const TestFolder folder;
  std::string older = read_file(small_store(folder));
  older[8] = 1;  // major version
  write_file(folder.file("older.ptin"), older);
  write_file(folder.file("golden.ptin"),
             read_file(PTIN_TEST_DATA "/../storage/golden/two_records_v1.0.ptin"));
  for (const char* file : {"older.ptin", "golden.ptin"}) {
    const std::string path = folder.file(file);
    for (const std::vector<std::string>& question :
         std::vector<std::vector<std::string>>{{"info", path, "-q"},
                                               {"verify", path, "-q"},
                                               {"locate", path, "0", "0"},
                                               {"refine", path, "-o", folder.file("m.ply")}}) {
      SCOPED_TRACE(question[0] + " " + file);
      expect_refusal(run_ptin(question), 5, "build it again");
    }
  }
  EXPECT_EQ(folder.names().size(), 4U);  // with hills.tif and hills.ptin
}

}  // namespace
}  // namespace ptin::tools
