// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small build that can be interrupted, and what must hold of it afterwards.
#pragma once

#include <optional>
#include <string>

#include "engine/construct/build.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"

namespace ptin::test {

enum class SourceKind {
  kRaster,  ///< Hills of 65 x 65 samples with a lake, in tiles of 16.
  kPoints,  ///< 1200 points as text, some of them twice, with voids, in tiles of 10.
  kLines,   ///< The same points with breaklines and a boundary.
  kTin,     ///< 1225 vertices as OBJ, with holes and vertices that are not used, in tiles of 10.
};

class InterruptibleBuild {
 public:
  explicit InterruptibleBuild(SourceKind kind = SourceKind::kRaster);

  [[nodiscard]] BuildOptions options() const;
  /// Every note is a checkpoint.
  [[nodiscard]] static BuildResources resources();
  [[nodiscard]] const std::string& input() const { return input_; }
  [[nodiscard]] std::string output() const { return folder_.file("out.ptin"); }
  [[nodiscard]] const oracle::ScratchFolder& folder() const { return folder_; }

  /// The code of the error that the build throws; none when it ends well. Where no files are named,
  /// they are the system's, never synced.
  [[nodiscard]] std::optional<ErrorCode> run(BuildResources resources) const;
  /// Resumes with the system's files until the build ends well, and expects the bytes of one that
  /// was not interrupted, and nothing else in the folder.
  void expect_resumed_to_the_same_bytes() const;

 private:
  SourceKind kind_;
  oracle::ScratchFolder source_folder_, folder_;
  std::string input_;
  const std::string* expected_ = nullptr;  ///< Bytes of a build that was not interrupted.
};

}  // namespace ptin::test
