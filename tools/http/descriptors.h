// SPDX-License-Identifier: GPL-3.0-or-later
//
// The files and sockets that the process may have open.
#pragma once

#include <cstddef>

namespace ptin::http {

/// Raises the soft limit of descriptors to the hard one.
/// @return How many there may be; where the system refuses, as many as before.
std::size_t raise_descriptor_limit() noexcept;

/// The number of descriptors that are open now.
[[nodiscard]] std::size_t open_descriptors();

/// The connections that descriptors are left for, beside those that the program needs itself.
/// @param each  Descriptors of a connection: two where it may be sent a file.
[[nodiscard]] std::size_t connections_for(std::size_t descriptors, std::size_t open,
                                          std::size_t each) noexcept;

}  // namespace ptin::http
