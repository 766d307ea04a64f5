// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a file goes on answering whose name another one took.
#pragma once

#include <cstdint>

namespace ptin {

/// What an open file answers that lost its name to another one, as by a rename over it.
enum class ReplacedFile : std::uint8_t {
  kRefused,  ///< Nothing: whoever asks by its name means the other one.
  /// What it held: its bytes are there until it is closed. What is written over it or cut is
  /// refused all the same, as far as size and modification time show.
  kAnswers
};

}  // namespace ptin
