// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/storage/failing_files.h"

#include <cerrno>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "storage/store_writer.h"

namespace ptin::test {

int PowerCutFiles::create(const std::string& path, int& fd) noexcept {
  const int failure = FileLayer::create(path, fd);
  names_[fd] = path;
  return failure;
}

int PowerCutFiles::open(const std::string& path, int& fd) noexcept {
  const int failure = FileLayer::open(path, fd);
  names_[fd] = path;
  return failure;
}

int PowerCutFiles::truncate(int fd, std::uint64_t bytes) noexcept {
  const Bytes whole = read_file(names_[fd]);
  if (bytes < whole.size()) {
    cuts_[names_[fd]] = {bytes,
                         Bytes(whole.begin() + static_cast<std::ptrdiff_t>(bytes), whole.end())};
  }
  return FileLayer::truncate(fd, bytes);
}

int PowerCutFiles::sync(int fd) noexcept {
  cuts_.erase(names_[fd]);
  return FileLayer::sync(fd);
}

void PowerCutFiles::lose_cuts(const std::string& path) {
  if (const auto cut = cuts_.find(path); cut != cuts_.end()) {
    Bytes whole = read_file(path);
    ASSERT_EQ(whole.size(), cut->second.at) << "written to since it was cut";
    whole.insert(whole.end(), cut->second.tail.begin(), cut->second.tail.end());
    write_file(path, whole);
  }
}

void expect_old_or_new(const StoreContent& new_content, int step) {
  const TestFolder folder(TestFolder::Size::kSmall);
  const std::string path = folder.file("a.ptin");
  const StoreContent old_content = random_content({.seed = 1, .segments = 1, .records = 5});
  write_store(path, new_content);
  const Bytes new_bytes = read_file(path);
  write_store(path, old_content, {.overwrite = true});
  const Bytes old_bytes = read_file(path);
  FailingFiles counting(0, 0, false);
  write_store(folder.file("b"), new_content, {.overwrite = true, .files = &counting});
  std::filesystem::remove(folder.file("b"));
  ASSERT_GT(counting.calls(), 8);

  int kept = 0, replaced = 0;
  for (const bool for_good : {false, true}) {
    for (int nth = counting.calls(); nth > 0; nth -= step) {
      for (const int failure : {ENOSPC, EIO}) {
        FailingFiles files(nth, failure, for_good);
        const auto code =
            code_of([&] { write_store(path, new_content, {.overwrite = true, .files = &files}); });
        const Bytes found = read_file(path);
        ASSERT_EQ(folder.names(), std::vector<std::string>{"a.ptin"}) << "call " << nth;
        if (found == old_bytes) {
          ASSERT_TRUE(code.has_value()) << "call " << nth << " failed and nothing was said";
          ASSERT_EQ(*code, failure == ENOSPC ? ErrorCode::resource_exhausted : ErrorCode::io_error);
          ++kept;
        } else {
          ASSERT_TRUE(code.has_value() || files.was_harmless())
              << "call " << nth << " failed and nothing was said";
          ASSERT_TRUE(found == new_bytes) << "call " << nth;
          write_store(path, old_content, {.overwrite = true});
          ++replaced;
        }
      }
    }
  }
  EXPECT_GT(kept, replaced);
  EXPECT_GT(replaced, 0) << "the folder's sync comes after the rename";
}

}  // namespace ptin::test
