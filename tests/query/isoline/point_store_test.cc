// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/point_store.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/error.h"

namespace ptin {
namespace {

constexpr std::uint64_t kBudget = 64 * sizeof(MapPoint);  // four blocks of 16 points

/// An empty folder, which goes with the object.
struct Folder {
  std::string path =
      (std::filesystem::temp_directory_path() / ("ptin-point-store-" + std::to_string(::getpid())))
          .string();
  Folder() { std::filesystem::create_directory(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }
  [[nodiscard]] bool is_empty() const { return std::filesystem::is_empty(path); }
};

class EverythingHasAName final : public FileLayer {
 public:
  int create_nameless(const std::string&, int&) noexcept override { return EOPNOTSUPP; }
};

class NothingIsWritten final : public FileLayer {
 public:
  int write_at(int, std::span<const std::byte>, std::uint64_t, std::size_t& n) noexcept override {
    n = 0;
    return 0;
  }
};

class NoFileMore final : public FileLayer {
 public:
  int create(const std::string& path, int& fd) noexcept override {
    ++created;
    return FileLayer::create(path, fd);
  }
  int create_nameless(const std::string&, int&) noexcept override { return ENOSPC; }
  int created = 0;
};

MapPoint point(std::size_t i) { return {static_cast<double>(i), -static_cast<double>(i)}; }

void fill(PointStore& store, std::size_t count) {
  std::vector<MapPoint> points;
  while (store.size() < count) {
    points.clear();
    for (std::size_t i = store.size(); i < std::min<std::size_t>(count, store.size() + 7); ++i) {
      points.push_back(point(i));
    }
    store.add(points);
  }
}

void expect_read_back(const PointStore& store) {
  for (std::size_t first = 0; first < store.size(); first += 13) {
    std::vector<MapPoint> out{point(1), point(2)};  // stay where they are
    const std::size_t count = std::min<std::size_t>(100, store.size() - first);
    store.read(first, count, out);
    ASSERT_EQ(out.size(), count + 2);
    EXPECT_EQ(out[1], point(2));
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(out[i + 2], point(first + i)) << "point " << first + i;
    }
  }
}

ErrorCode refusal(PointStore store) {
  try {
    fill(store, 65);
  } catch (const Error& e) {
    return e.code();
  }
  ADD_FAILURE() << "took all points";
  return ErrorCode::invalid_argument;
}

TEST(PointStore, GivesBackWhatWasAddedFromMemoryAndFromAFileWithoutAName) {
  const Folder folder;
  EverythingHasAName named;
  for (FileLayer* files : {&FileLayer::system(), static_cast<FileLayer*>(&named)}) {
    for (const std::size_t count : {0, 1, 16, 64, 65, 128, 129, 1000}) {
      SCOPED_TRACE(count);
      PointStore store(kBudget, folder.path, *files);
      fill(store, count);
      EXPECT_TRUE(folder.is_empty());
      expect_read_back(store);
      PointStore moved(std::move(store));
      fill(moved, count + 100);
      expect_read_back(moved);
    }
  }
  EXPECT_TRUE(folder.is_empty());
}

/// Without a folder a store is asked for as many points as its budget holds, and not for one less.
TEST(PointStore, UsesAllOfItsBudget) {
  const Folder folder;
  for (std::size_t most = 1; most <= 41; ++most) {
    SCOPED_TRACE(most);
    PointStore kept(most * sizeof(MapPoint), {});
    fill(kept, most);
    expect_read_back(kept);
    const MapPoint more = point(most);
    EXPECT_THROW(kept.add({&more, 1}), Error);
    PointStore spilled(most * sizeof(MapPoint), folder.path);
    fill(spilled, 3 * most + 1);
    expect_read_back(spilled);
  }
}

TEST(PointStore, RefusesMoreThanItsBudgetWithoutAFolderThatTakesIt) {
  const Folder folder;
  EXPECT_EQ(refusal({kBudget, {}}), ErrorCode::resource_exhausted);
  EXPECT_EQ(refusal({kBudget, folder.path + "/absent"}), ErrorCode::not_found);
}

TEST(PointStore, EndsWhenTheDiskTakesNothing) {
  const Folder folder;
  NothingIsWritten silent;
  EXPECT_EQ(refusal({kBudget, folder.path, silent}), ErrorCode::io_error);
  NoFileMore full;
  EXPECT_EQ(refusal({kBudget, folder.path, full}), ErrorCode::resource_exhausted);
  EXPECT_EQ(full.created, 0) << "took a full disk for one without nameless files";
  EXPECT_TRUE(folder.is_empty());
}

}  // namespace
}  // namespace ptin
