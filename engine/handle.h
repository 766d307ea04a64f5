// SPDX-License-Identifier: GPL-3.0-or-later
//
// What C libraries hand out, and take back by a function.
#pragma once

#include <memory>

namespace ptin {

template <auto kEnd>
struct EndsBy {
  template <class T>
  void operator()(T* handle) const noexcept {
    kEnd(handle);
  }
};

/// Something of a C library that is given back by `kEnd` when this object goes.
template <class T, auto kEnd>
using Handle = std::unique_ptr<T, EndsBy<kEnd>>;

}  // namespace ptin
