// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/output_file.h"

#include <cerrno>
#include <cstddef>

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include "engine/error.h"
#include "tests/tools/program.h"
#include "tools/output/pending_file.h"

namespace ptin::tools {
namespace {

using testing::read_file;
using testing::TestFolder;
using testing::write_file;

template <typename Act>
ErrorCode code_thrown_by(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.code();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorCode::internal;
}

TEST(OutputFile, AppearsWholeOrNotAtAll) {
  const TestFolder folder;
  const std::string large(3'000'000, 'x');
  {
    OutputFile out(folder.file("kept"), false);
    out.write("begin ");
    out.write(large);
    EXPECT_FALSE(std::filesystem::exists(folder.file("kept")));
    out.publish();
  }
  {
    OutputFile out(folder.file("dropped"), false);
    out.write(large);
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"kept"});
  EXPECT_EQ(read_file(folder.file("kept")), "begin " + large);
}

TEST(OutputFile, ReplacesOnlyWhenTold) {
  const TestFolder folder;
  const std::string path = folder.file("file");
  write_file(path, "old");
  EXPECT_EQ(code_thrown_by([&] { OutputFile(path, false); }), ErrorCode::invalid_argument);
  OutputFile out(path, true);
  out.write("new");
  EXPECT_EQ(read_file(path), "old");
  out.publish();
  EXPECT_EQ(read_file(path), "new");
}

TEST(OutputFile, DoesNotReplaceWhatAppearedMeanwhile) {
  const TestFolder folder;
  OutputFile out(folder.file("file"), false);
  write_file(folder.file("file"), "another's");
  EXPECT_EQ(code_thrown_by([&] { out.publish(); }), ErrorCode::invalid_argument);
  EXPECT_EQ(read_file(folder.file("file")), "another's");
}

TEST(PendingFile, TakesItsSideFilesAlongHoweverItEnds) {
  const TestFolder folder;
  for (const bool is_published : {false, true}) {
    PendingFile file(folder.file("a.gpkg"), true);
    write_file(file.temporary(), "content");
    write_file(file.temporary() + "-journal", "");
    write_file(file.temporary() + ".aux.xml", "<PAMDataset/>");
    if (is_published) file.publish();
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.gpkg"});
}

// A new GeoPackage beside the journal of the one that it replaced is a broken one.
TEST(OutputFile, RemovesTheCompanionsOfWhatItReplaces) {
  const TestFolder folder;
  const auto put = [&](std::initializer_list<const char*> names) {
    for (const char* name : names) write_file(folder.file(name), "of the old one");
  };
  put({"a.gpkg", "a.gpkg-wal", "a.gpkg-shm", "a.gpkg.aux.xml", "a.gpkg.qml", "b.gpkg-wal"});
  {
    PendingFile file(folder.file("a.gpkg"), true);
    write_file(file.temporary(), "new");
    EXPECT_TRUE(std::filesystem::exists(folder.file("a.gpkg-wal")));
    file.publish();
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.gpkg", "a.gpkg.qml", "b.gpkg-wal"}));
  put({"c.PNG", "c.PNG.aux.xml"});
  OutputFile out(folder.file("c.PNG"), true);
  out.publish();
  EXPECT_FALSE(std::filesystem::exists(folder.file("c.PNG.aux.xml")));
}

/// From now on this process's kernel knows no renameat2 and says `failure` to it, as file systems
/// (EINVAL) and old kernels (ENOSYS) do.
bool forget_renameat2(int failure) {
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_renameat2, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<unsigned>(failure)),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  const sock_fprog filter = {sizeof program / sizeof *program, program};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

/// Publishes onto a name that another took meanwhile; exit status 0 when it was refused.
[[noreturn]] void publish_onto_anothers(const TestFolder& folder, int failure) {
  constexpr int kNoFilter = 99;
  if (!forget_renameat2(failure)) _exit(kNoFilter);
  OutputFile out(folder.file("file"), false);
  write_file(folder.file("file"), "another's");
  const ErrorCode code = code_thrown_by([&] { out.publish(); });
  const bool kept = read_file(folder.file("file")) == "another's";
  OutputFile other(folder.file("other"), false);
  other.publish();
  const bool made = std::filesystem::exists(folder.file("other"));
  _exit(code == ErrorCode::invalid_argument && kept && made ? 0 : 1);
}

TEST(OutputFileDeathTest, DoesNotReplaceWhereTheSystemCannotRefuseToDoSo) {
  for (const int failure : {EINVAL, ENOSYS}) {
    const TestFolder folder;
    const auto refused_or_untestable = [](int status) {
      return WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 99);
    };
    EXPECT_EXIT(publish_onto_anothers(folder, failure), refused_or_untestable, "") << failure;
  }
}

/// The folder's names cannot be made durable.
class NoFolderIsSynced final : public FileLayer {
 public:
  int sync_folder(const std::string&) noexcept override { return EIO; }
};

TEST(OutputFile, SaysWhenTheNameMayNotLast) {
  const TestFolder folder;
  NoFolderIsSynced files;
  OutputFile out(folder.file("file"), false, files);
  out.write("text");
  EXPECT_EQ(code_thrown_by([&] { out.publish(); }), ErrorCode::io_error);
  EXPECT_EQ(read_file(folder.file("file")), "text");
  write_file(folder.file("from"), "other");
  EXPECT_EQ(code_thrown_by(
                [&] { move_into_place(folder.file("from"), folder.file("to"), false, files); }),
            ErrorCode::io_error);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"file", "to"}));
}

TEST(OutputFile, HasNoPlaceUnderDevOrProc) {
  for (const char* path : {"/dev/none.ply", "/dev/fd/none.ply", "/proc/self/fd/none.ply"}) {
    EXPECT_EQ(code_thrown_by([&] { check_output(path, true); }), ErrorCode::invalid_argument)
        << path;
  }
  EXPECT_EQ(output_target("/dev/shm/a.ply"), "/dev/shm/a.ply");
  const TestFolder folder;
  std::filesystem::create_symlink("b", folder.file("a"));
  std::filesystem::create_symlink("a", folder.file("b"));
  EXPECT_EQ(code_thrown_by([&] { check_output(folder.file("a"), true); }), ErrorCode::io_error);
}

TEST(OutputFile, NamesAMissingFolderAndRefusesAFolder) {
  const TestFolder folder;
  EXPECT_EQ(code_thrown_by([&] { check_output(folder.file("none/file"), false); }),
            ErrorCode::not_found);
  EXPECT_EQ(code_thrown_by([&] { check_output(folder.path().string(), true); }),
            ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace ptin::tools
