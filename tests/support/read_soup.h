// SPDX-License-Identifier: GPL-3.0-or-later
//
// A whole TIN file in memory, for tests and fuzz targets of the readers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "engine/construct/read/tin_file.h"
#include "engine/error.h"

namespace ptin::test {

/// A whole TIN in memory. Indices are in range; nothing else is known of them.
struct TinSoup {
  std::vector<SourcePoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 4>> quads;
  TinFileFacts facts;
};

[[noreturn]] inline void throw_refusal(const std::string& what, const std::string& path) {
  throw Error(ErrorCode::invalid_argument, what, path);
}

/// Keeps everything in memory. Triangles keep the ids of their corners until finish() turns them
/// into indices.
class SoupCollector final : public TinFileSink {
 public:
  explicit SoupCollector(std::string path) : path_(std::move(path)) {}

  void add_vertex(std::int64_t id, const SourcePoint& p) override {
    const auto index = static_cast<std::uint32_t>(soup_.vertices.size());
    if (index >= UINT32_MAX / 2) {
      throw Error(ErrorCode::resource_exhausted, "more vertices than one mesh in memory counts",
                  path_);
    }
    if (!index_of_.try_emplace(id, index).second) {
      throw_refusal("two vertices have the id " + std::to_string(id), path_);
    }
    soup_.vertices.push_back(p);
  }
  /// Adds a face. Quads stay whole: they are cut when the heights are known.
  void add_face(std::span<const std::int64_t> ids) override {
    if (ids.size() == 4) {
      quads_.push_back({ids[0], ids[1], ids[2], ids[3]});
    } else {
      triangles_.push_back({ids[0], ids[1], ids[2]});
    }
  }

  TinSoup finish(TinFileFacts facts) {
    soup_.facts = std::move(facts);
    take(triangles_, soup_.triangles);
    take(quads_, soup_.quads);
    return std::move(soup_);
  }

 private:
  template <std::size_t kCorners>
  void take(const std::vector<std::array<std::int64_t, kCorners>>& from,
            std::vector<std::array<std::uint32_t, kCorners>>& to) const {
    to.reserve(from.size());
    for (const auto& ids : from) {
      std::array<std::uint32_t, kCorners> corners{};
      for (std::size_t i = 0; i < kCorners; ++i) {
        const auto found = index_of_.find(ids[i]);
        if (found == index_of_.end()) {
          throw_refusal("triangle " + std::to_string(to.size()) + " names vertex " +
                            std::to_string(ids[i]) + ", which is not there",
                        path_);
        }
        corners[i] = found->second;
      }
      to.push_back(corners);
    }
  }

  std::string path_;
  TinSoup soup_;
  std::vector<std::array<std::int64_t, 3>> triangles_;
  std::vector<std::array<std::int64_t, 4>> quads_;
  std::unordered_map<std::int64_t, std::uint32_t> index_of_;
};

/// Everything that a reader reads, in memory.
/// @throws Error  as read_tin_file(); invalid_argument  an id that no vertex has, or that two have
/// Memory: 48 bytes a vertex and 12 a triangle; while it reads, besides, 24 bytes a triangle and a
/// hash table of the ids. It grows with what is read, never with what a header claims.
[[nodiscard]] inline TinSoup read_soup(TinReader& reader, ByteReader& in,
                                       const TinReading& reading) {
  SoupCollector soup(in.path());
  TinFileFacts facts = reader(in, reading, soup);
  return soup.finish(std::move(facts));
}

}  // namespace ptin::test
