// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of temporary files, of builds that need them.
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;

/// Counts what is made in a folder.
class Watch {
 public:
  explicit Watch(const std::string& folder) : descriptor_(::inotify_init1(IN_NONBLOCK)) {
    EXPECT_GE(::inotify_add_watch(descriptor_, folder.c_str(), IN_CREATE | IN_MOVED_TO), 0);
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  ~Watch() { ::close(descriptor_); }
  /// True when something was, since the last call.
  [[nodiscard]] bool saw_something() const {
    alignas(inotify_event) std::array<char, 4096> events{};
    bool any = false;
    while (::read(descriptor_, events.data(), events.size()) > 0) any = true;
    return any;
  }

 private:
  int descriptor_;
};

TEST(BuildTmp, IsWhereTemporaryFilesGo) {
  const TestFolder tmp, folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  const Watch watch(tmp.path().string());
  for (const char* name : {"mountains_257.tif", "ground_points.csv"}) {
    SCOPED_TRACE(name);
    expect_done({"build", test_data(name), "-o", file("beside.ptin"), "-q", "--overwrite"});
    EXPECT_FALSE(watch.saw_something());
    expect_done({"build", test_data(name), "-o", file("apart.ptin"), "-q", "--overwrite", "--tmp",
                 tmp.path().string()});
    EXPECT_TRUE(watch.saw_something());
    EXPECT_EQ(read_file(file("apart.ptin")), read_file(file("beside.ptin")));
    EXPECT_EQ(tmp.names(), std::vector<std::string>{});
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"apart.ptin", "beside.ptin"}));
  }
  const Outcome missing = run_ptin(
      {"build", test_data("mountains_257.tif"), "-o", file("x.ptin"), "--tmp", file("missing")});
  EXPECT_NE(missing.status, 0);
  EXPECT_NE(missing.err.find(file("missing")), std::string::npos) << missing.err;
}

}  // namespace
}  // namespace ptin::tools
