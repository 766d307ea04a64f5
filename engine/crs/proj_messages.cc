// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/proj_messages.h"

#include <mutex>

#include <proj.h>

namespace ptin {

void silence_proj() noexcept {
  // A new context is a copy of the default one.
  static std::once_flag done;
  std::call_once(done, [] { proj_log_level(PJ_DEFAULT_CTX, PJ_LOG_NONE); });
}

}  // namespace ptin
