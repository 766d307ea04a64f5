// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that lie elsewhere: their names, and how they are opened.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "storage/file/range_source.h"
#include "storage/store_file.h"

namespace ptin {

/// How a server is asked. What is not said here is as GDAL is configured (tools/API.md, "Files
/// elsewhere"), which also has the credentials.
struct RemoteOptions {
  RemoteCaches caches;
  /// Times that a range is asked for before the server's failure is an error; at least 1.
  int tries = 5;
  /// Seconds before the second try; each further pause is twice as long.
  double first_pause = 0.25;
  /// Seconds after which a connection is not waited for any more, and those without a byte after
  /// which an answer is not.
  long most_seconds_to_connect = 20, most_silent_seconds = 30;
  std::stop_token stop;  ///< Ends waiting.
};

/// Whether a name is one of a file elsewhere: a URL (http, https, s3, gs, az), or a name in one of
/// GDAL's file systems (/vsi...).
[[nodiscard]] bool is_remote(const std::string& name) noexcept;

/// Opens an object, and reads its first bytes: one request.
/// @throws Error not_found         there is no such object
///               invalid_argument  the server does not send ranges
///               io_error, corruption, cancelled  as RangeSource::read
[[nodiscard]] std::shared_ptr<RangeSource> open_remote(const std::string& name,
                                                       const RemoteOptions& options = {});

/// Opens a store that lies elsewhere, for Terrain(std::shared_ptr<const StoreFile>).
/// @throws Error as open_remote and StoreFile::open
[[nodiscard]] std::shared_ptr<const StoreFile> open_remote_store(const std::string& name,
                                                                 const RemoteOptions& options = {});

}  // namespace ptin
