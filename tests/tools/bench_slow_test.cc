// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin bench: what it tells, refuses and leaves behind.
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <memory>
#include <set>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/tools/disk_folder.h"
#include "tests/tools/program.h"
#include "tests/tools/refusal.h"
#include "tools/measure/question.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::built;
using testing::disk_folder;
using testing::expect_refusal;
using testing::kNeedsDisk;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::spawn_ptin;
using testing::TestFolder;
using testing::write_file;

class Bench : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!folder_) GTEST_SKIP() << kNeedsDisk;
    store_ = built(*folder_, "mountains_257.tif", "m.ptin");
  }
  [[nodiscard]] std::vector<std::string> quick(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"bench",     store_, "--count",   "1",
                                          "--seconds", "3",    "--threads", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::unique_ptr<TestFolder> folder_ = disk_folder();
  std::string store_;
};

TEST_F(Bench, TellsEveryQuestionByEveryWay) {
  const std::string before = read_file(store_);
  const json told = answer_of(quick({"--json", "-q", "--seed", "7"}));
  EXPECT_EQ(told["why_not_cold"], nullptr);
  EXPECT_EQ(told["seed"], 7);
  EXPECT_EQ(told["bytes"], before.size());
  std::set<std::string> cold, warm;
  for (const json& row : told["readings"]) {
    if (row["what"] != "question") continue;
    EXPECT_EQ(row["times"].get<int>() + row["not_cold"].get<int>(), 1) << row;
    EXPECT_EQ(row["p95_ms"], nullptr) << "of one answer there is none";
    EXPECT_EQ(row["asked_bytes"],
              4096 * (row["pages"].get<double>() + row["index_nodes"].get<double>()));
    (row["cold"] ? cold : warm)
        .insert(row["question"].get<std::string>() + " by " + row["by"].get<std::string>());
  }
  const std::size_t ways = told["why_no_io_uring"].is_null() ? 4 : 3;
  EXPECT_EQ(cold.size(), 6 * ways);
  EXPECT_EQ(warm.size(), 6U * 3);
  EXPECT_TRUE(told["best"]["cold"]);
  EXPECT_NE(told["best"]["sentence"].get<std::string>().find("on this disk"), std::string::npos);
  EXPECT_EQ(read_file(store_), before);
  EXPECT_EQ(folder_->names(), std::vector<std::string>{"m.ptin"});
}

TEST_F(Bench, PrintsTablesOfOneWidth) {
  const Outcome outcome = run_ptin(quick());
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* words : {"mincore", "not visible from here", "window 1/10000", "faults",
                            "questions a second", "spatialindex", "Best on this disk", "seed 1"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
  }
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 135U) << line;
  EXPECT_NE(outcome.err.find("questions: 0"), std::string::npos) << outcome.err;
}

TEST_F(Bench, AsksAtAnErrorAndAtPlacesOfTheSeed) {
  const json told = answer_of(quick({"--json", "-q", "--error", "20", "--seed", "9"}));
  EXPECT_EQ(told["error"], 20);
  const Terrain terrain = Terrain::open(store_);
  const Questions questions(terrain.store(), 9, 20.0);
  int compared = 0;
  for (const json& row : told["readings"]) {
    if (row["by"] != "announced" || row["what"] != "question") continue;
    for (const QuestionKind kind : kQuestionKinds) {
      if (row["question"] != name_of(kind)) continue;
      const Answer answer = questions.ask(questions.make(kind, 0, terrain), terrain, {});
      EXPECT_EQ(row["pages"], answer.cost.io.pages) << row;
      const std::uint64_t least = questions.least_bytes(questions.make(kind, 0, terrain), answer);
      EXPECT_EQ(least % 4096, 0U);
      EXPECT_EQ(row["asked_over_least"].get<double>() * static_cast<double>(least),
                row["asked_bytes"].get<double>());
      ++compared;
    }
  }
  EXPECT_EQ(compared, 12);
}

/// A point is a page of heights, below the root, and the page holds the answer.
TEST_F(Bench, TellsWhatIsReadOverTheLeastThatHoldsTheAnswer) {
  const json told = answer_of(quick({"--json", "-q"}));
  for (const json& row : told["readings"]) {
    EXPECT_EQ(row["asked_over_least"].is_null(), row["what"] != "question" || row["times"] == 0);
    if (row["what"] == "question" && row["question"] == "point" && row["times"] > 0) {
      EXPECT_EQ(row["asked_over_least"], 1.0);
    }
  }
  const Terrain terrain = Terrain::open(store_);
  const Questions questions(terrain.store(), 9, {});
  double heights = 0, samples = 257.0 * 257.0;
  for (const SectionInfo& s : terrain.store().sections()) {
    if (s.name == "heights") heights = static_cast<double>(s.bytes);
  }
  const Question window = questions.make(QuestionKind::kWindow25th, 0, terrain);
  const Answer answer = questions.ask(window, terrain, {});
  const double bytes = std::pow(0.2 * 256 + 1, 2) * heights / samples;
  EXPECT_EQ(questions.least_bytes(window, answer), std::ceil(bytes / 4096) * 4096);
}

/// How many pixels of a PNG have a colour.
int pixels_of(const std::string& path, const std::array<std::uint8_t, 3>& colour) {
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(path.c_str()));
  if (!data || data->GetRasterCount() != 3) return 0;
  const int width = data->GetRasterXSize(), height = data->GetRasterYSize();
  std::array<std::vector<std::uint8_t>, 3> bands;
  for (int b = 0; b < 3; ++b) {
    bands[b].resize(static_cast<std::size_t>(width) * height);
    EXPECT_EQ(data->GetRasterBand(b + 1)->RasterIO(GF_Read, 0, 0, width, height, bands[b].data(),
                                                   width, height, GDT_Byte, 0, 0, nullptr),
              CE_None);
  }
  int count = 0;
  for (std::size_t i = 0; i < bands[0].size(); ++i) {
    count += bands[0][i] == colour[0] && bands[1][i] == colour[1] && bands[2][i] == colour[2];
  }
  return count;
}

TEST_F(Bench, DrawsAPlotThatIsNotBlank) {
  const std::string plot = folder_->file("disk.png");
  EXPECT_EQ(answer_of(quick({"--json", "-q", "-o", plot}))["output"], plot);
  EXPECT_EQ(folder_->names(), (std::vector<std::string>{"disk.png", "m.ptin"}));
  // Dots of every way, cold and warm, and of the second index.
  EXPECT_GT(pixels_of(plot, {20, 100, 190}), 250);
  EXPECT_GT(pixels_of(plot, {208, 92, 24}), 250);
  EXPECT_GT(pixels_of(plot, {34, 140, 80}), 250);
  EXPECT_GT(pixels_of(plot, {150, 60, 160}), 100);
  EXPECT_EQ(pixels_of(plot, {1, 2, 3}), 0);
}

TEST_F(Bench, OfAFileInMemoryTellsWarmFiguresAlone) {
  if (::access("/dev/shm", W_OK) != 0) GTEST_SKIP() << "needs /dev/shm";
  const TestFolder memory(TestFolder::Size::kSmall);
  store_ = built(memory, "mountains_257.tif", "m.ptin");
  const json told = answer_of(quick({"--json", "-q", "-o", memory.file("a.svg")}));
  EXPECT_NE(told["why_not_cold"].get<std::string>().find("tmpfs"), std::string::npos);
  EXPECT_EQ(told["device"], nullptr);
  EXPECT_GE(told["readings"].size(), 18U);
  for (const json& row : told["readings"]) {
    EXPECT_FALSE(row["cold"]) << row;
    EXPECT_EQ(row["left_out"], nullptr) << row;
    EXPECT_NE(row["by"], "io_uring");
  }
  EXPECT_FALSE(told["best"]["cold"]);
  const Outcome text = run_ptin(quick({"-q"}));
  EXPECT_NE(text.out.find("not measured: it lies in memory (tmpfs)"), std::string::npos);
}

TEST_F(Bench, RefusesWrongUse) {
  expect_refusal(run_ptin({"bench"}), 2, "FILE");
  expect_refusal(run_ptin({"bench", folder_->file("none.ptin")}), 3, "none.ptin");
  write_file(folder_->file("x.ptin"), std::string(5000, 'x'));
  expect_refusal(run_ptin({"bench", folder_->file("x.ptin")}), 2, "not a .ptin file");
  expect_refusal(run_ptin(quick({"--count", "0"})), 2, "--count");
  expect_refusal(run_ptin(quick({"--seconds", "0"})), 2, "--seconds");
  expect_refusal(run_ptin(quick({"--seconds", "nan"})), 2, "--seconds");
  expect_refusal(run_ptin(quick({"--seconds", "inf"})), 2, "--seconds");
  expect_refusal(run_ptin(quick({"--error", "-1"})), 2, "--error");
  expect_refusal(run_ptin(quick({"--seed", "-1"})), 2, "--seed");
  expect_refusal(run_ptin(quick({"--threads", "0"})), 2, "--threads");
  expect_refusal(run_ptin(quick({"--vertices", "10"})), 2, "--vertices");
  expect_refusal(run_ptin(quick({"-o", folder_->file("a.csv")})), 2, ".png, .svg, .pdf");
  expect_refusal(run_ptin(quick({"-o", store_})), 2, "would destroy it");
  write_file(folder_->file("a.png"), "x");
  expect_refusal(run_ptin(quick({"-o", folder_->file("a.png")})), 2, "--overwrite");
  EXPECT_EQ(read_file(folder_->file("a.png")), "x");
}

TEST_F(Bench, NamesAFolderThatIsNoneForTheSecondIndex) {
  const json told = answer_of(quick({"--json", "-q", "--tmp", folder_->file("none")}));
  EXPECT_NE(told["second_index"]["why_not"].get<std::string>().find("--tmp"), std::string::npos);
  EXPECT_EQ(told["second_index"]["bytes"], nullptr);
  for (const json& row : told["readings"]) EXPECT_NE(row["by"], "spatialindex");
}

TEST_F(Bench, LeavesNothingBehindWhenItIsCancelled) {
  for (const int after_ms : {300, 1500}) {
    const Outcome outcome = spawn_ptin({"bench", store_, "--seconds", "600", "--count", "1000000"},
                                       SIGINT, std::chrono::milliseconds(after_ms));
    EXPECT_EQ(outcome.status, 8) << outcome.err;
    EXPECT_NE(outcome.err.find("cancelled"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(folder_->names(), std::vector<std::string>{"m.ptin"});
  }
}

TEST_F(Bench, SaysWhatADamagedPageIs) {
  std::string bytes = read_file(store_);
  for (std::size_t at = bytes.size() / 2; at < bytes.size(); at += 4096) bytes[at] ^= 1;
  write_file(store_, bytes);
  expect_refusal(run_ptin(quick({"-q"})), 4, "checksum");
}

}  // namespace
}  // namespace ptin::tools
