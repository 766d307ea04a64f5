// SPDX-License-Identifier: GPL-3.0-or-later
//
// A store that is replaced, cut short or written to while it is open: every kind of question says
// so (Error corruption, page_store.h) and gives no answer, whether it reads pages or has them all.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/query/heights/highest.h"
#include "engine/query/heights/locate.h"
#include "engine/query/heights/profile.h"
#include "engine/query/isoline/isoline.h"
#include "engine/query/living/tin_parts.h"
#include "engine/query/questions.h"
#include "engine/query/refine/moving_window.h"
#include "engine/query/sight/sight.h"
#include "engine/query/sight/viewshed.h"
#include "engine/query/stream/stream_writer.h"
#include "engine/query/volume/volume.h"
#include "storage/file/sigbus_guard.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

namespace fs = std::filesystem;
using reference::Hierarchy;
using reference::TemporaryStore;

/// Two terrains of the same shape and unlike heights.
const Hierarchy& terrain_of(std::uint64_t seed) {
  static std::map<std::uint64_t, Hierarchy> all;
  const auto [found, is_new] = all.try_emplace(seed);
  if (is_new) {
    std::mt19937_64 random(seed);
    found->second = reference::simplify(reference::random_grid(random, 40, 40, 4, 0.0), random);
  }
  return found->second;
}

void write_over(const std::string& from, const std::string& to) {
  std::ifstream in(from, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::ofstream out(to,
                    std::ios::binary | std::ios::in);  // as it is: neither emptied nor made anew
  out << bytes;
}

struct FileChange {
  const char* name;
  /// @param other  A good store of another terrain, to be used up.
  std::function<void(const std::string& path, const std::string& other)> make;
};

std::vector<FileChange> changes() {
  return {
      {"Replaced",
       [](const std::string& path, const std::string& other) { fs::rename(other, path); }},
      {"ReplacedByACopy",
       [](const std::string& path, const std::string& other) {
         fs::copy_file(path, other, fs::copy_options::overwrite_existing);
         fs::rename(other, path);
       }},
      {"WrittenOver",
       [](const std::string& path, const std::string& other) { write_over(other, path); }},
      {"CutByAByte", [](const std::string& path,
                        const std::string&) { fs::resize_file(path, fs::file_size(path) - 1); }},
      {"CutInHalf", [](const std::string& path,
                       const std::string&) { fs::resize_file(path, fs::file_size(path) / 2); }},
      {"Emptied", [](const std::string& path, const std::string&) { fs::resize_file(path, 0); }},
      {"Removed", [](const std::string& path, const std::string&) { fs::remove(path); }}};
}

/// Something to ask again and again; `terrain` outlives it.
using Asking = std::function<void()>;
struct KindOfQuestion {
  const char* name;
  std::function<Asking(const Terrain& terrain, std::shared_ptr<const StoreFile> store)> prepare;
};
void PrintTo(const KindOfQuestion& question, std::ostream* out) { *out << question.name; }

MapPoint spot_at(const StoreFacts& facts, double share_x, double share_y) {
  return facts.map.to_map(facts.bounds.max_x * share_x, facts.bounds.max_y * share_y);
}

Asking moves_of(std::shared_ptr<const StoreFile> store) {
  const auto window = std::make_shared<MovingWindow>(OpenedTerrain(store));
  return [window, store, n = 0]() mutable {
    const double share = 0.1 * (n++ % 8);
    const MapPoint lower = spot_at(store->facts(), share, share);
    const MapPoint upper = spot_at(store->facts(), share + 0.2, share + 0.2);
    const auto before = reference::canonical(window->tin());
    try {
      window->move_to(meets_region(Window{lower.x, lower.y, upper.x, upper.y}, store->facts().map));
    } catch (const Error&) {
      EXPECT_EQ(reference::canonical(window->tin()), before);
      throw;
    }
  };
}

std::vector<KindOfQuestion> questions() {
  using Store = std::shared_ptr<const StoreFile>;
  return {
      {"Refine",
       [](const Terrain& t, const Store&) -> Asking { return [&] { (void)t.refine({}); }; }},
      {"RefineToACount",
       [](const Terrain& t, const Store&) -> Asking {
         return [&] {
           RefineRequest request;
           request.detail.vertices = t.t0().vertices.size() + 40;
           (void)t.refine(request);
         };
       }},
      {"TinParts",
       [](const Terrain& t, const Store&) -> Asking {
         const auto parts = std::make_shared<TinParts>(t, PartRequest{});
         return [parts] { (void)parts->part({0, 0, 40, 40}); };
       }},
      {"Locate",
       [](const Terrain& t, const Store& s) -> Asking {
         return [&t, p = spot_at(s->facts(), 0.4, 0.6)] { (void)locate(t, std::span(&p, 1)); };
       }},
      {"LocateAtACount",
       [](const Terrain& t, const Store& s) -> Asking {
         return [&t, p = spot_at(s->facts(), 0.4, 0.6)] {
           LocateRequest request;
           request.detail.vertices = t.t0().vertices.size() + 40;
           (void)locate(t, std::span(&p, 1), request);
         };
       }},
      {"Profile",
       [](const Terrain& t, const Store& s) -> Asking {
         return [&t, line = std::vector{spot_at(s->facts(), 0.1, 0.1),
                                        spot_at(s->facts(), 0.9, 0.8)}] { (void)profile(t, line); };
       }},
      {"Sight",
       [](const Terrain& t, const Store& s) -> Asking {
         const SightPair pair{spot_at(s->facts(), 0.1, 0.1), 2, spot_at(s->facts(), 0.9, 0.8), 2};
         return [&t, pair] { (void)t.sight(pair, {}); };
       }},
      {"SightSolver",
       [](const Terrain& t, const Store& s) -> Asking {
         const SightPair pair{spot_at(s->facts(), 0.1, 0.1), 2, spot_at(s->facts(), 0.9, 0.8), 2};
         const auto solver = std::make_shared<SightSolver>(t, SightRequest{});
         return [solver, pair] { (void)solver->solve(pair); };
       }},
      {"UprightSight",  // decided without a record
       [](const Terrain& t, const Store& s) -> Asking {
         const SightPair pair{spot_at(s->facts(), 0.1, 0.1), 1, spot_at(s->facts(), 0.1, 0.1), 2};
         return [&t, pair] { (void)t.sight(pair, {}); };
       }},
      {"Highest",
       [](const Terrain& t, const Store&) -> Asking { return [&] { (void)highest(t, {}); }; }},
      {"HighestOutside",  // decided by the bounds alone
       [](const Terrain& t, const Store& s) -> Asking {
         const MapPoint low = spot_at(s->facts(), 7, 7), high = spot_at(s->facts(), 8, 8);
         HighestRequest request;
         request.region = Window{low.x, low.y, high.x, high.y};
         return [&t, request] { (void)highest(t, request); };
       }},
      {"Volume",
       [](const Terrain& t, const Store&) -> Asking { return [&] { (void)volume(t, {}); }; }},
      {"IsolinesAboveAll",
       [](const Terrain& t, const Store& s) -> Asking {
         IsolineRequest request;
         request.levels = {s->facts().max_height + 1};
         return [&t, request] { (void)isolines(t, request); };
       }},
      {"ViewshedAtAnError",
       [](const Terrain& t, const Store& s) -> Asking {
         ViewshedRequest request;
         request.eye = spot_at(s->facts(), 0.5, 0.5);
         request.eye_height = 5;
         request.radius = s->facts().map.to_map(30, 0).x - s->facts().map.to_map(0, 0).x;
         request.detail.tolerance = (s->facts().max_height - s->facts().min_height) / 10;
         return [&t, request] { (void)viewshed(t, request); };
       }},
      {"Isolines",
       [](const Terrain& t, const Store& s) -> Asking {
         IsolineRequest request;
         request.levels = {(s->facts().min_height + s->facts().max_height) / 2};
         return [&t, request] { (void)isolines(t, request); };
       }},
      {"Viewshed",
       [](const Terrain& t, const Store& s) -> Asking {
         ViewshedRequest request;
         request.eye = spot_at(s->facts(), 0.5, 0.5);
         request.eye_height = 5;
         request.radius = s->facts().map.to_map(30, 0).x - s->facts().map.to_map(0, 0).x;
         return [&t, request] { (void)viewshed(t, request); };
       }},
      {"Stream",
       [](const Terrain&, const Store& s) -> Asking {
         return [s] {
           std::size_t sent = 0;
           try {
             write_stream(OpenedTerrain(s), {},
                          [&](std::span<const std::byte> bytes) { sent += bytes.size(); });
           } catch (const Error&) {
             EXPECT_EQ(sent, 0U) << "a receiver would have begun";
             throw;
           }
         };
       }},
      {"MovingWindow", [](const Terrain&, const Store& s) -> Asking { return moves_of(s); }},
  };
}

class ReplacedStore : public ::testing::TestWithParam<KindOfQuestion> {
 protected:
  static std::optional<Error> error_of(const Asking& ask) {
    try {
      ask();
    } catch (const Error& e) {
      return e;
    }
    return std::nullopt;
  }

  /// @param is_warm  Asked before the change too: a mapped store has then verified its pages.
  static void expect_noticed(const FileChange& change, PageAccess access, bool is_warm) {
    SCOPED_TRACE(std::string(change.name) + (is_warm ? ", asked before" : ", not asked before"));
    const TemporaryStore file(terrain_of(1));
    const TemporaryStore other(terrain_of(2));
    const auto store = file.open(access);
    const Terrain terrain(store);
    const Asking ask = GetParam().prepare(terrain, store);
    if (is_warm) {
      ASSERT_NO_THROW(ask());
    }
    change.make(file.path, other.path);
    for (int again = 0; again < 2; ++again) {
      const std::optional<Error> error = error_of(ask);
      ASSERT_TRUE(error) << "an answer";
      EXPECT_EQ(error->code(), ErrorCode::corruption) << error->what();
      EXPECT_NE(std::string(error->what()).find(file.path), std::string::npos) << error->what();
    }
  }
};

TEST_P(ReplacedStore, IsNoticedThroughAMapping) {
  install_sigbus_guard();
  for (const FileChange& change : test::some_of(changes())) {
    expect_noticed(change, PageAccess::kMapped, false);
    expect_noticed(change, PageAccess::kMapped, true);
  }
}

TEST_P(ReplacedStore, IsNoticedByReads) {
  for (const FileChange& change : test::some_of(changes(), 2, 1)) {
    expect_noticed(change, PageAccess::kPread, false);
    expect_noticed(change, PageAccess::kPread, true);
  }
}

/// A file that lost its name, and one that was written to.
TEST_P(ReplacedStore, IsAnsweredFromWhereThatIsWanted) {
  install_sigbus_guard();
  for (const FileChange& change : test::some_of(changes())) {
    SCOPED_TRACE(change.name);
    const std::string name = change.name;
    const bool keeps_bytes = name == "Replaced" || name == "ReplacedByACopy" || name == "Removed";
    for (const PageAccess access : {PageAccess::kMapped, PageAccess::kPread}) {
      const TemporaryStore file(terrain_of(1));
      const TemporaryStore other(terrain_of(2));
      const auto store = StoreFile::open(file.path, access, nullptr, ReplacedFile::kAnswers);
      const Terrain terrain(store);
      const Asking ask = GetParam().prepare(terrain, store);
      change.make(file.path, other.path);
      const std::optional<Error> error = error_of(ask);
      EXPECT_EQ(!error, keeps_bytes) << (error ? error->what() : "an answer");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Question, ReplacedStore, ::testing::ValuesIn(questions()),
                         [](const auto& question) { return std::string(question.param.name); });

}  // namespace
}  // namespace ptin
