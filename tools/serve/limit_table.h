// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every limit of a service by its name: as an option, in a configuration file, and in the refusal
// of a request that goes beyond it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "tools/serve/serve_options.h"

namespace ptin::serve {

struct LimitFact {
  std::string_view name;
  std::string_view about;
  std::string_view unit;  ///< "bytes", "ms" or "".
  std::uint64_t least, most;
  std::uint64_t (*get)(const ServeOptions& options);
  void (*set)(ServeOptions& options, std::uint64_t value);
};

[[nodiscard]] std::span<const LimitFact> limit_table() noexcept;

/// Sets a limit. Bytes may be told as 64M, milliseconds as a plain number.
/// @throws Error invalid_argument  no limit of this name (lists those that are); no such number
void set_limit(ServeOptions& options, const std::string& name, const std::string& value);

}  // namespace ptin::serve
