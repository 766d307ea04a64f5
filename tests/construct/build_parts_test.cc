// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds in parts: whatever the number and order of the jobs, the bytes are those of one process; and
// jobs that die, that are done twice, or that meet damage.
#include "engine/construct/build_parts.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/tasks/task_messages.h"
#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/resume_fixture.h"
#include "tests/construct/tile_tasks/damaging_driver.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using test::Damage;
using test::InterruptibleBuild;
using test::SourceKind;

/// One build in parts.
class InParts {
 public:
  InParts(const InterruptibleBuild& of, int parts)
      : of_(of),
        parts_(parts),
        note_(begin_parts({of.input()}, of.output(), of.options(), resources()).note) {}

  [[nodiscard]] BuildResources resources() {
    BuildResources r = InterruptibleBuild::resources();
    r.files = &files_;
    return r;
  }
  void job(PartsPhase phase, int part) { job(phase, part, resources()); }
  void job(PartsPhase phase, int part, const BuildResources& with) {
    do_part({of_.input()}, of_.options(), with, note_, phase, part, parts_);
  }
  void phase(PartsPhase phase, unsigned seed = 1) {
    std::vector<int> order;
    for (int part = 0; part < (phase == PartsPhase::kJoin ? 1 : parts_); ++part) {
      order.push_back(part);
    }
    std::mt19937 random(seed);
    std::shuffle(order.begin(), order.end(), random);
    for (const int part : order) {
      job(phase, part);
    }
  }
  void plan_again() {
    BuildResources r = resources();
    r.unfinished = Unfinished::kResume;
    note_ = begin_parts({of_.input()}, of_.output(), of_.options(), r).note;
  }
  void publish() { publish_parts({of_.input()}, of_.output(), of_.options(), resources(), parts_); }
  void rest_gives_the_same_bytes() {
    for (const PartsPhase p : {PartsPhase::kCollapse, PartsPhase::kJoin, PartsPhase::kTighten}) {
      phase(p);
    }
    publish();
    of_.expect_resumed_to_the_same_bytes();
  }
  [[nodiscard]] std::string file(const std::string& name) const {
    return note_in(note_).temporary + "/" + name;
  }

 private:
  const InterruptibleBuild& of_;
  int parts_;
  test::UnsyncedFiles files_;
  std::string note_;
};

/// The message of what is thrown; "" when nothing is.
template <class Call>
std::string thrown_by(ErrorCode code, Call&& call) {
  try {
    call();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.message();
  }
  return "";
}

bool says(const std::string& message, const std::string& words) {
  return message.find(words) != std::string::npos;
}

class BuildParts : public testing::TestWithParam<SourceKind> {};

TEST_P(BuildParts, GiveTheSameBytesWhateverTheirNumberAndOrder) {
  for (const int parts : test::some_of({1, 3, 16})) {  // there are four batches of the raster
    const InterruptibleBuild of(GetParam());
    InParts in(of, parts);
    in.phase(PartsPhase::kCollapse, 7);
    in.phase(PartsPhase::kJoin);
    in.phase(PartsPhase::kTighten, 11);
    in.phase(PartsPhase::kCollapse, 13);  // again: nothing is left to do
    in.publish();
    of.expect_resumed_to_the_same_bytes();
  }
}

std::string kind_name(const testing::TestParamInfo<SourceKind>& kind) {
  static constexpr const char* kNames[] = {"Raster", "Points", "Lines", "Tin"};
  return kNames[static_cast<int>(kind.param)];
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, BuildParts,
                         testing::Values(SourceKind::kRaster, SourceKind::kPoints,
                                         SourceKind::kLines, SourceKind::kTin),
                         kind_name);

TEST(BuildPart, ThatWasDoneWritesNothingAgain) {
  const InterruptibleBuild of;
  InParts in(of, 2);
  in.job(PartsPhase::kCollapse, 0);
  const TileId first{1, 0, 0};
  std::filesystem::remove(in.file(file_name(first, TileFile::kPages)));
  in.job(PartsPhase::kCollapse, 0);
  EXPECT_FALSE(std::filesystem::exists(in.file(file_name(first, TileFile::kPages))));
}

TEST(BuildPart, ThatMeetsADamagedSourceSaysThatItIsToBePlannedAgain) {
  for (const SourceKind kind : {SourceKind::kPoints, SourceKind::kTin}) {
    const InterruptibleBuild of(kind);
    InParts in(of, 2);
    in.job(PartsPhase::kCollapse, 0);
    const std::string name = kind == SourceKind::kPoints ? "points-0" : "tin.surface";
    test::damage(in.file(name), test::Damage::kFlipped);
    const std::string told = thrown_by(ErrorCode::corruption, [&] {
      in.job(PartsPhase::kCollapse, 1);
      in.job(PartsPhase::kJoin, 0);
      in.job(PartsPhase::kTighten, 0);
      in.job(PartsPhase::kTighten, 1);
    });
    EXPECT_TRUE(says(told, "make the plan again with --resume")) << told;
    in.plan_again();
    in.rest_gives_the_same_bytes();
  }
}

/// Whatever it had written, what it did not tell does not count.
TEST(BuildPart, ThatDiedIsDoneAnew) {
  for (const int calls : test::some_of({1, 2, 5, 9, 20, 33})) {
    const InterruptibleBuild of;
    InParts in(of, 3);
    BuildResources resources = in.resources();
    test::FailingFiles files(calls);
    resources.files = &files;
    EXPECT_THROW(in.job(PartsPhase::kCollapse, 1, resources), Error) << calls;
    EXPECT_FALSE(std::filesystem::exists(in.file("part-collapse-1")));
    in.rest_gives_the_same_bytes();
  }
}

TEST(BuildPart, RefusesToBeginBeforeThePhaseBeforeIsDone) {
  const InterruptibleBuild of;
  InParts in(of, 2);
  const auto refused = [&](auto&& call) { return thrown_by(ErrorCode::invalid_argument, call); };
  in.job(PartsPhase::kCollapse, 0);
  for (const PartsPhase phase : {PartsPhase::kJoin, PartsPhase::kTighten}) {
    EXPECT_TRUE(says(refused([&] { in.job(phase, 0); }),
                     "part 1 of the phase collapse is not done; do it first"));
  }
  in.job(PartsPhase::kCollapse, 1);
  EXPECT_TRUE(says(refused([&] { in.job(PartsPhase::kTighten, 0); }), "part 0 of the phase join"));
  in.job(PartsPhase::kJoin, 0);
  in.job(PartsPhase::kTighten, 1);
  EXPECT_TRUE(says(refused([&] { in.publish(); }), "part 0 of the phase tighten"));
  EXPECT_TRUE(says(refused([&] { in.job(PartsPhase::kCollapse, 2); }), "0 to 1"));
  EXPECT_TRUE(says(refused([&] { in.job(PartsPhase::kJoin, 1); }), "0 to 0"));
  EXPECT_TRUE(says(refused([&] { in.job(PartsPhase::kTighten, -1); }), "no part -1"));
  in.rest_gives_the_same_bytes();
}

/// A job of the reader names the job that wrote, which then is done again and mends it.
TEST(BuildPart, ThatMeetsDamageNamesTheOneToDoAgain) {
  struct Case {
    std::string file;
    PartsPhase reader;
    std::string named;
  };
  const std::vector<Case> cases{
      {file_name({1, 1, 1}, TileFile::kPushed), PartsPhase::kJoin, "part 3 of the phase collapse"},
      {file_name({2, 0, 0}, TileFile::kSegment), PartsPhase::kTighten, "part 0 of the phase join"},
      {file_name({2, 0, 0}, TileFile::kPushed), PartsPhase::kTighten, "part 0 of the phase join"},
      {"part-collapse-2", PartsPhase::kJoin, "part 2 of the phase collapse"},
      {"part-join-0", PartsPhase::kTighten, "part 0 of the phase join"},
  };
  std::size_t number = 0;  // One is damaged in another way than the next.
  for (const Case& c : cases) {
    for (const Damage how : test::some_of({Damage::kFlipped, Damage::kCut}, 2, number++)) {
      SCOPED_TRACE(c.file);
      const InterruptibleBuild of;
      InParts in(of, 4);
      in.phase(PartsPhase::kCollapse);
      if (c.reader == PartsPhase::kTighten) {
        in.phase(PartsPhase::kJoin);
      }
      test::damage(in.file(c.file), how);
      const std::string message = thrown_by(ErrorCode::corruption, [&] { in.job(c.reader, 0); });
      EXPECT_TRUE(says(message, "do " + c.named + " again")) << message;
      in.rest_gives_the_same_bytes();
    }
  }
}

TEST(BuildParts, MendDamageWhenTheyArePublished) {
  for (const TileFile file : {TileFile::kBounds, TileFile::kPages, TileFile::kDescriptions}) {
    const InterruptibleBuild of;
    InParts in(of, 3);
    for (const PartsPhase p : {PartsPhase::kCollapse, PartsPhase::kJoin, PartsPhase::kTighten}) {
      in.phase(p);
    }
    test::damage(in.file(file_name({1, 1, 0}, file)), Damage::kFlipped);
    in.publish();
    of.expect_resumed_to_the_same_bytes();
  }
}

TEST(BuildPart, RefusesAnInputThatChanged) {
  const InterruptibleBuild of(SourceKind::kPoints);
  InParts in(of, 2);
  in.job(PartsPhase::kCollapse, 0);
  oracle::write_text(of.input(), oracle::bytes_of(of.input()) + "5 5 5\n");
  EXPECT_TRUE(
      says(thrown_by(ErrorCode::invalid_argument, [&] { in.job(PartsPhase::kCollapse, 1); }),
           "an input is not the one that the build began with"));
  EXPECT_NE(thrown_by(ErrorCode::invalid_argument, [&] { in.publish(); }), "");
}

}  // namespace
}  // namespace ptin
