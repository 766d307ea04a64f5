// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_observer.h"

namespace ptin {

void BuildObserver::plan(const BuildPlan& /*plan*/) {}
void BuildObserver::progress(const StageProgress& /*progress*/) {}
void BuildObserver::give_back_memory() {}

}  // namespace ptin
