// SPDX-License-Identifier: GPL-3.0-or-later
//
// A service's configuration, as TOML.
#pragma once

#include <map>
#include <string>

#include "tools/serve/serve_options.h"

namespace ptin::serve {

/// Reads a configuration into `options`: `listen`, `threads`, `public_url`, `cors`, `base_map`,
/// `base_map_attribution` (neither is checked: fault_of(BaseMap)), `token_file`, `files` (true or false),
/// `metrics`, `trusted_proxies` (addresses between commas), a table [collections] of NAME = "FILE", where a name
/// that is no path from the root counts from the folder of the configuration, and a table [limits].
/// @throws Error not_found, io_error
///               invalid_argument  no TOML; a name that means nothing here (named, with those that
///                                 do)
void read_config(const std::string& path, ServeOptions& options);

/// Values of a configuration beside its collections, by names as "limits.points".  @throws Error as read_config()
[[nodiscard]] std::map<std::string, std::string> settings_in(const std::string& path);

/// Names the base map of all terrains by its tiles; "none" forbids those that files name. Whom to name for it stays.
void set_base_map_tiles(const std::string& tiles, ServeOptions& options);

/// The origin of web pages that may ask, as it goes into a header.
/// @param where  Gave it, for the error.
/// @throws Error invalid_argument  it holds a blank or a control character
[[nodiscard]] std::string checked_origin(const std::string& origin, const std::string& where);

/// Who may read the metrics: "open", "token" or "closed".
/// @throws Error invalid_argument
[[nodiscard]] MetricsFor metrics_for(const std::string& word, const std::string& where);

/// Adds proxies, as ADDRESS or ADDRESS/BITS between commas.  @throws Error invalid_argument
void add_trusted_proxies(const std::string& list, ServeOptions& options);

/// The token that a file holds: its first line, without blanks behind it.
/// @throws Error not_found, io_error; invalid_argument  it is empty, or others may read the file
[[nodiscard]] std::string read_token(const std::string& path);

}  // namespace ptin::serve
