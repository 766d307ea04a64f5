// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a reader must reject when a file is opened (FORMAT.md, "A reader must reject"), and that no
// damage of a small file goes unseen.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "engine/error.h"
#include "storage/store_file.h"
#include "storage/verify.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {
namespace {

using layout::FileHeader;
using layout::SectionEntry;
using layout::SectionKind;
using namespace std::string_literals;

class StoreOpen : public testing::Test {
 protected:
  StoreOpen() {
    write_store(path_, random_content({.seed = 7, .segments = 2, .records = 70}));
    bytes_ = read_file(path_);
  }

  // The code that opening fails with; none when it succeeds.
  std::optional<ErrorCode> code_of(const Bytes& bytes) {
    write_file(path_, bytes);
    return code_of_file();
  }
  std::optional<ErrorCode> code_of_file() {
    try {
      StoreFile::open(path_);
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(path_), std::string::npos)
          << "should name the file: " << e.what();
      return e.code();
    }
    return std::nullopt;
  }

  void expect_corruption(const char* name, const Bytes& bytes) {
    EXPECT_EQ(code_of(bytes), ErrorCode::corruption) << name;
    // Damage that opening finds, verify reports as a fault.
    EXPECT_FALSE(verify_store(path_).is_sound()) << name;
  }

  void expect_header_rejected(const char* name, const std::function<void(FileHeader&)>& change) {
    Bytes bytes = bytes_;
    FileHeader header = header_of(bytes);
    change(header);
    set_header(bytes, header);
    seal(bytes);
    expect_corruption(name, bytes);
  }

  void expect_sections_rejected(const char* name,
                                const std::function<void(std::vector<SectionEntry>&)>& change) {
    Bytes bytes = bytes_;
    std::vector<SectionEntry> sections = sections_of(bytes);
    change(sections);
    set_sections(bytes, sections);
    seal(bytes);
    expect_corruption(name, bytes);
  }

  template <class T>
  void expect_entry_rejected(const char* name, SectionKind kind, std::size_t index,
                             const std::function<void(T&)>& change) {
    Bytes bytes = bytes_;
    const std::uint64_t at = section_of(bytes, kind).offset + index * sizeof(T);
    T entry = object_at<T>(bytes, at);
    change(entry);
    set_object(bytes, at, entry);
    seal(bytes);
    expect_corruption(name, bytes);
  }

  TestFolder folder_{TestFolder::Size::kSmall};
  std::string path_ = folder_.file("a.ptin");
  Bytes bytes_;
};

TEST_F(StoreOpen, AcceptsWhatIsSealedAgain) {
  Bytes bytes = bytes_;
  seal(bytes);
  EXPECT_EQ(bytes, bytes_);
  EXPECT_EQ(code_of(bytes), std::nullopt);
}

TEST_F(StoreOpen, SaysThatAFileIsNotThere) {
  try {
    StoreFile::open(folder_.file("none.ptin"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::not_found);
  }
}

TEST_F(StoreOpen, RefusesAFolderAndAPipe) {
  const std::string pipe = folder_.file("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {folder_.path().string(), pipe}) {
    try {
      StoreFile::open(path);
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    }
  }
}

TEST_F(StoreOpen, RefusesWhatIsNoStoreAndSaysWhatItBeginsLike) {
  const auto expect_other = [&](const Bytes& bytes, const std::string& words) {
    try {
      write_file(path_, bytes);
      StoreFile::open(path_);
      FAIL() << words;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
      EXPECT_NE(e.message().find("not a .ptin file: " + words), std::string::npos) << e.what();
    }
  };
  const auto beginning = [](const std::string& text, std::size_t bytes) {
    Bytes whole(bytes, std::byte{0x81});
    std::memcpy(whole.data(), text.data(), std::min(text.size(), bytes));
    return whole;
  };
  expect_other({}, "it is empty");
  expect_other(Bytes(5000, std::byte{'a'}), "it begins like a text");
  expect_other(beginning("II*\0"s, 5000), "it begins like a TIFF");
  expect_other(beginning("II*\0"s, 4), "it begins like a TIFF");
  expect_other(beginning("LASF\0\0"s, 300), "it begins like a LAS");
  expect_other(beginning("\x89PNG\r\n\x1a\n"s, 300), "it begins like a PNG image");
  expect_other(beginning("<!DOCTYPE html>", 300), "it begins like a web page");
  expect_other(Bytes(3, std::byte{0x81}), "it begins like no file");
}

TEST_F(StoreOpen, OfAStoreWhoseFirstBytesAreDamagedSaysSo) {
  for (std::size_t i = 0; i < layout::kMagic.size(); ++i) {
    Bytes one = bytes_;
    one[i] = std::byte{0};
    expect_corruption("one byte of the magic", one);
  }
  Bytes all = bytes_;
  std::fill_n(all.begin(), layout::kMagic.size(), std::byte{'x'});
  expect_corruption("the magic, the header is sound", all);
  expect_corruption("zeros", Bytes(5000));
  for (const std::size_t bytes : {5U, 8U, 100U}) {
    expect_corruption("cut short",
                      Bytes(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(bytes)));
  }
}

TEST_F(StoreOpen, RefusesANewerMajorVersionWhateverTheRestIs) {
  Bytes bytes = bytes_;
  FileHeader header = header_of(bytes);
  header.major_version = layout::kMajorVersion + 1;
  header.header_bytes = 512;
  header.header_checksum = 99;
  set_header(bytes, header);
  EXPECT_EQ(code_of(bytes), ErrorCode::unsupported_version);
  EXPECT_THROW(static_cast<void>(verify_store(path_)), Error);
}

TEST_F(StoreOpen, RefusesAFileOfFormat1) {
  const auto old = std::filesystem::path(__FILE__).parent_path() / "golden/two_records_v1.0.ptin";
  for (const auto& use :
       std::vector<std::function<void()>>{[&] { StoreFile::open(old.string()); },
                                          [&] { static_cast<void>(verify_store(old.string())); }}) {
    try {
      use();
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::unsupported_version);
      EXPECT_NE(std::string(e.what()).find("format version 1, which was provisional"),
                std::string::npos)
          << e.what();
    }
  }
}

TEST_F(StoreOpen, IgnoresSectionsOfANewerMinorVersion) {
  Bytes changed = with_room_for_a_section(bytes_, 16);
  changed.resize(changed.size() + 16, std::byte{7});
  FileHeader header = header_of(changed);
  header.reserved[0] = 1;
  set_header(changed, header);
  seal(changed);
  EXPECT_EQ(code_of(changed), std::nullopt);
  EXPECT_TRUE(verify_store(path_).is_sound());
  EXPECT_EQ(read_all(*StoreFile::open(path_)).size(), 140U);
  changed.back() = std::byte{8};
  write_file(path_, changed);
  EXPECT_FALSE(verify_store(path_).is_sound()) << "but its checksum is looked at";
}

TEST_F(StoreOpen, RejectsEveryTruncation) {
  // Every length of the front, and of the pages one in 37.
  const std::size_t front = section_of(bytes_, SectionKind::kPages).offset;
  for (std::size_t length = bytes_.size(); length > 1;) {  // an empty file is no store
    length -= length > front ? std::min<std::size_t>(length - front, 37) : 1;
    std::filesystem::resize_file(path_, length);
    ASSERT_EQ(code_of_file(), ErrorCode::corruption) << length;
  }
  Bytes longer = bytes_;
  longer.push_back(std::byte{0});
  EXPECT_EQ(code_of(longer), ErrorCode::corruption);
}

TEST_F(StoreOpen, NoFlippedByteGoesUnseen) {
  write_store(path_, random_content({.seed = 3, .segments = 1, .records = 3}), {.overwrite = true});
  const Bytes sound = read_file(path_);
  ASSERT_TRUE(verify_store(path_).is_sound());
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  const auto put = [&](std::size_t at, std::byte value) {
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(value));
    file.flush();
  };
  for (std::size_t i = 0; i < sound.size(); ++i) {
    put(i, sound[i] ^ std::byte{0x20});
    bool is_found = false;
    try {
      is_found = !verify_store(path_).is_sound();
    } catch (const Error& e) {
      is_found = e.code() == ErrorCode::unsupported_version;
    }
    ASSERT_TRUE(is_found) << "byte " << i;
    put(i, sound[i]);
  }
  EXPECT_TRUE(verify_store(path_).is_sound());
}

// A byte of the front, the index or a page, with all checksums made right: an error that names the
// file, or an answer.
TEST_F(StoreOpen, EachChangedByteIsAnErrorOrAnAnswer) {
  write_store(path_, random_content({.seed = 3, .segments = 1, .records = 4}), {.overwrite = true});
  const Bytes sound = read_file(path_);
  const FunctionPredicate all([](const Attributes&) { return true; });
  std::size_t answers = 0, errors = 0;
  const auto use = [&](PageAccess access) {
    const auto store = StoreFile::open(path_, access);
    std::vector<PageId> pages;
    IoCounters counters;
    store->index().search(all, pages, counters);
    const StarredRecords starred = read_all_starred(*store);
    EXPECT_EQ(starred.splits, read_all(*store));
    EXPECT_EQ(starred.size(), store->record_count());
    EXPECT_EQ(pages.size(), store->pages().page_count());
  };
  std::size_t zeros = 0;
  for (std::size_t at = 0; at < sound.size(); ++at) {
    zeros = sound[at] == std::byte{0} ? zeros + 1 : 0;
    if (zeros > 64 && at % 97 != 0) {
      continue;  // in the middle of a gap
    }
    for (const std::byte value : {sound[at] ^ std::byte{0x10}, std::byte{0}, std::byte{0xFF}}) {
      Bytes bytes = sound;
      bytes[at] = value;
      seal(bytes);
      write_file(path_, bytes);
      const PageAccess access = at % 2 == 0 ? PageAccess::kMapped : PageAccess::kPread;
      try {
        use(access);
        ++answers;
      } catch (const Error& e) {
        ASSERT_TRUE(e.code() == ErrorCode::corruption || e.code() == ErrorCode::unsupported_version)
            << at << ": " << e.what();
        ASSERT_NE(std::string(e.what()).find(path_), std::string::npos) << e.what();
        ++errors;
      }
      try {
        static_cast<void>(verify_store(path_));
      } catch (const Error& e) {
        ASSERT_EQ(e.code(), ErrorCode::unsupported_version) << at << ": " << e.what();
      }
    }
  }
  EXPECT_GT(errors, 500U);
  EXPECT_GT(answers, 500U);
}

TEST_F(StoreOpen, RejectsHeadersThatNoProgramWrote) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  expect_header_rejected("major version 0", [](FileHeader& h) { h.major_version = 0; });
  expect_header_rejected("header length", [](FileHeader& h) { h.header_bytes = 255; });
  expect_header_rejected("file too short", [](FileHeader& h) { h.file_bytes += 1; });
  expect_header_rejected("file too long", [](FileHeader& h) { h.file_bytes -= 1; });
  for (const std::uint32_t bytes : {0U, 1U, 512U, 4095U, 4097U, 12288U, 131072U, 0x80000000U}) {
    expect_header_rejected("page size", [=](FileHeader& h) { h.page_bytes = bytes; });
  }
  for (const std::uint32_t count : {0U, 5U, 65U, UINT32_MAX}) {
    expect_header_rejected("sections", [=](FileHeader& h) { h.section_count = count; });
  }
  for (const std::uint64_t pages :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{9}, std::uint64_t{1} << 52, UINT64_MAX}) {
    expect_header_rejected("pages", [=](FileHeader& h) { h.page_count = pages; });
  }
  expect_header_rejected("first page", [](FileHeader& h) { h.first_page = h.page_count; });
  expect_header_rejected("first page", [](FileHeader& h) { h.first_page = UINT64_MAX; });
  for (const std::uint64_t records :
       {std::uint64_t{0}, std::uint64_t{139}, std::uint64_t{141}, UINT64_MAX}) {
    expect_header_rejected("records", [=](FileHeader& h) { h.record_count = records; });
  }
  expect_header_rejected("rank", [](FileHeader& h) { h.max_rank = 65536; });
  expect_header_rejected("height type", [](FileHeader& h) { h.height_type = 2; });
  for (const double v : {0.0, -1.0, nan, infinity}) {
    expect_header_rejected("height step",
                           [=](FileHeader& h) { h.height_step = layout::to_bits(v); });
    expect_header_rejected("step x", [=](FileHeader& h) { h.step_x = layout::to_bits(v); });
    expect_header_rejected("step y", [=](FileHeader& h) { h.step_y = layout::to_bits(v); });
  }
  for (const double v : {nan, infinity}) {
    expect_header_rejected("height offset",
                           [=](FileHeader& h) { h.height_offset = layout::to_bits(v); });
    expect_header_rejected("origin x", [=](FileHeader& h) { h.origin_x = layout::to_bits(v); });
    expect_header_rejected("origin y", [=](FileHeader& h) { h.origin_y = layout::to_bits(v); });
  }
  for (const double v : {1.0, -0.5}) {
    expect_header_rejected("float offset",
                           [=](FileHeader& h) { h.height_offset = layout::to_bits(v); });
  }
  expect_header_rejected("float step", [](FileHeader& h) { h.height_step = layout::to_bits(2.0); });
  expect_header_rejected("bounds off the grid", [](FileHeader& h) { h.bounds[0] = -1; });
  expect_header_rejected("bounds off the grid", [](FileHeader& h) { h.bounds[2] = kGridMax + 1; });
  expect_header_rejected("empty bounds", [](FileHeader& h) { h.bounds[1] = h.bounds[3] + 1; });
  for (const double v : {nan, -infinity, -1e300}) {
    expect_header_rejected("min height", [=](FileHeader& h) { h.min_height = layout::to_bits(v); });
  }
  for (const double v : {nan, infinity, 1e300}) {
    expect_header_rejected("max height", [=](FileHeader& h) { h.max_height = layout::to_bits(v); });
  }
  for (const double v : {-1.0, nan}) {
    expect_header_rejected("base error", [=](FileHeader& h) { h.base_error = layout::to_bits(v); });
    expect_header_rejected("base deviation",
                           [=](FileHeader& h) { h.base_deviation = layout::to_bits(v); });
  }
  expect_header_rejected("reserved", [](FileHeader& h) { h.reserved[67] = 1; });
  expect_header_rejected("reserved", [](FileHeader& h) { h.flags = 2; });
}

// Else the damage shows as a region or a pixel size of the caller's that cannot be.
TEST_F(StoreOpen, RejectsMapsThatLeadToNoPlaceOfTheTerrain) {
  for (const double v : {1e300, -1e300, 1e18, -1e18, std::numeric_limits<double>::max()}) {
    expect_header_rejected("origin x", [=](FileHeader& h) { h.origin_x = layout::to_bits(v); });
    expect_header_rejected("origin y", [=](FileHeader& h) { h.origin_y = layout::to_bits(v); });
  }
  for (const double v : {1e-300, 1e-12, 1e150, 1e305, std::numeric_limits<double>::denorm_min()}) {
    expect_header_rejected("step x", [=](FileHeader& h) { h.step_x = layout::to_bits(v); });
    expect_header_rejected("step y", [=](FileHeader& h) { h.step_y = layout::to_bits(v); });
  }
  const double tiny = 1e-200;  // Each place has coordinates of its own, but no two a distance.
  expect_header_rejected("step x", [=](FileHeader& h) {
    h.step_x = layout::to_bits(tiny);
    h.origin_x = layout::to_bits(0.0);
  });
  // As far from 0 as a build puts a terrain.
  Bytes bytes = bytes_;
  FileHeader header = header_of(bytes);
  const double step = layout::to_double(header.step_x);
  header.origin_x = layout::to_bits(step * 0x1p49);
  set_header(bytes, header);
  seal(bytes);
  EXPECT_EQ(code_of(bytes), std::nullopt);
}

TEST_F(StoreOpen, RejectsSegmentsThatNoProgramWrote) {
  using Segment = layout::SegmentEntry;
  for (const int last : {0, 999, UINT16_MAX}) {
    expect_entry_rejected<Segment>("last", SectionKind::kSegments, 0,
                                   [=](Segment& s) { s.last = static_cast<std::uint16_t>(last); });
  }
}

TEST_F(StoreOpen, RejectsDirectoriesThatNoProgramPlaced) {
  write_store(path_, random_content({.seed = 7, .segments = 2, .records = 70}),
              {.overwrite = true, .directory = {.least_pages = 1}});
  bytes_ = read_file(path_);
  using Table = std::vector<SectionEntry>;
  constexpr std::size_t kRoot = 5, kNodes = 7;
  ASSERT_EQ(sections_of(bytes_)[kRoot].kind, static_cast<std::uint32_t>(SectionKind::kDirectory));
  ASSERT_EQ(sections_of(bytes_)[kNodes].kind,
            static_cast<std::uint32_t>(SectionKind::kDirectoryNodes));
  for (const std::size_t i : {kRoot, kNodes}) {
    expect_sections_rejected("missing", [=](Table& t) { t[i].kind = 77; });
    expect_sections_rejected("twice", [=](Table& t) { t[i].kind = t[(i + 1) % 8].kind; });
    expect_sections_rejected("too far", [=](Table& t) { t[i].offset += 1 << 30; });
  }
  expect_sections_rejected("no cell", [](Table& t) { t[kRoot].bytes = 16; });
  expect_sections_rejected("no whole entry", [](Table& t) { t[kNodes].bytes -= 1; });
  // A reader that knows neither answers by the index.
  Bytes bytes = bytes_;
  std::vector<SectionEntry> sections = sections_of(bytes);
  sections[kRoot].kind = 77;
  sections[kNodes].kind = 78;
  set_sections(bytes, sections);
  seal(bytes);
  EXPECT_EQ(code_of(bytes), std::nullopt);
  EXPECT_TRUE(verify_store(path_).is_sound());
}

TEST_F(StoreOpen, RejectsSectionTablesThatNoProgramWrote) {
  using Table = std::vector<SectionEntry>;
  for (std::size_t i = 0; i < 7; ++i) {
    expect_sections_rejected("reserved", [=](Table& t) { t[i].reserved = 1; });
    expect_sections_rejected("missing", [=](Table& t) { t[i].kind = 77; });
    expect_sections_rejected("twice", [=](Table& t) { t[i].kind = t[(i + 1) % t.size()].kind; });
    for (const std::uint64_t offset :
         {std::uint64_t{0}, std::uint64_t{8}, UINT64_MAX, UINT64_MAX - 7}) {
      expect_sections_rejected("offset", [=](Table& t) { t[i].offset = offset; });
    }
    expect_sections_rejected("unaligned", [=](Table& t) { t[i].offset += 1; });
    expect_sections_rejected("too far", [=](Table& t) { t[i].offset += 1 << 30; });
    expect_sections_rejected("endless", [=](Table& t) { t[i].bytes = UINT64_MAX; });
    if (i != 1) {  // metadata has any
      expect_sections_rejected("odd length", [=](Table& t) { t[i].bytes -= 1; });
    }
  }
  expect_sections_rejected("order", [](Table& t) { std::swap(t[0], t[1]); });
  expect_sections_rejected("index unaligned", [](Table& t) { t[5].offset -= 8; });
  expect_sections_rejected("page checksum", [](Table& t) { t[6].checksum = 1; });
  Bytes ends_early = bytes_;
  ends_early.resize(ends_early.size() + 8);
  FileHeader header = header_of(ends_early);
  header.file_bytes = ends_early.size();
  set_header(ends_early, header);
  seal(ends_early);
  expect_corruption("bytes behind the last section", ends_early);
}

TEST_F(StoreOpen, RejectsChecksumsThatDoNotMatch) {
  const auto flipped = [&](std::uint64_t at) {
    Bytes bytes = bytes_;
    bytes[at] ^= std::byte{1};
    return bytes;
  };
  expect_corruption("header", flipped(56));
  expect_corruption("table", flipped(sizeof(FileHeader) + 9));
  expect_corruption("metadata", flipped(section_of(bytes_, SectionKind::kMetadata).offset));
  expect_corruption("vertices", flipped(section_of(bytes_, SectionKind::kT0Vertices).offset));
  expect_corruption("triangles", flipped(section_of(bytes_, SectionKind::kT0Triangles).offset));
  expect_corruption("errors", flipped(section_of(bytes_, SectionKind::kErrorTable).offset + 8));
}

TEST_F(StoreOpen, RejectsT0ThatCannotBeOne) {
  using V = layout::T0Vertex;
  using T = layout::T0Triangle;
  const auto vertex = [&](const char* name, const std::function<void(V&)>& change) {
    expect_entry_rejected<V>(name, SectionKind::kT0Vertices, 2, change);
  };
  const auto triangle = [&](const char* name, const std::function<void(T&)>& change) {
    expect_entry_rejected<T>(name, SectionKind::kT0Triangles, 1, change);
  };
  vertex("outside of the bounds", [](V& v) { v.x = -1; });
  vertex("outside of the bounds", [](V& v) { v.y = INT32_MAX; });
  vertex("has_height", [](V& v) { v.has_height = 2; });
  vertex("height", [](V& v) { v.height = 0x7FC00000; });
  vertex("surface without height", [](V& v) { v.has_height = 0; });
  triangle("corner", [](T& t) { t.v[0] = 4; });
  triangle("corner", [](T& t) { t.v[2] = UINT32_MAX; });
  triangle("corner twice", [](T& t) { t.v[1] = t.v[0]; });
  triangle("class", [](T& t) { t.is_void = 2; });
  for (const unsigned death : {0x7F82U, 0x8001U, 0x8002U, 0xC081U, 0xFFFFU}) {
    triangle("death", [=](T& t) { t.death = static_cast<std::uint16_t>(death); });
  }
}

TEST_F(StoreOpen, RejectsErrorTablesThatCannotBeOne) {
  using B = layout::ErrorBinEntry;
  const auto bin = [&](const char* name, std::size_t index, const std::function<void(B&)>& change) {
    expect_entry_rejected<B>(name, SectionKind::kErrorTable, index, change);
  };
  bin("first bin", 0, [](B& b) { b.upper = 1U << 20; });
  bin("no bound of a bin", 1, [](B& b) { b.upper += 1; });
  bin("not ascending", 1, [](B& b) { b.upper = 0; });
  bin("no number", 1, [](B& b) { b.upper = 0x7FC00000; });
  bin("deviation", 1, [](B& b) { b.max_deviation = 0x80000001; });
  bin("fewer records", 1, [](B& b) {
    b.records = 0;
    b.void_vertices = 0;
  });
  bin("more records", 1, [](B& b) { b.records = UINT64_MAX; });
  bin("more voids than records", 1, [](B& b) { b.void_vertices = b.records + 1; });
}

}  // namespace
}  // namespace ptin::test
