// SPDX-License-Identifier: GPL-3.0-or-later
//
// Keeping PROJ from printing.
#pragma once

namespace ptin {

/// Lets PROJ write nothing to the standard error stream. GDAL sends the messages of its own PROJ
/// contexts through its error handlers; but libraries that GDAL uses make contexts of their own,
/// as libgeotiff does for units that a file declares, and these print. To be called before GDAL is
/// used: contexts that are there already are left as they are. Threads: any number of calls at once.
void silence_proj() noexcept;

}  // namespace ptin
