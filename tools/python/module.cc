// SPDX-License-Identifier: GPL-3.0-or-later
//
// The module ptin._ptin: the engine's questions as ptin/ asks them.
#include "tools/python/binding.h"

PYBIND11_MODULE(_ptin, module) {
  using namespace ptin::python;
  module.attr("__version__") = PTIN_VERSION;
  module.doc() = "The engine, as the package ptin asks it; not for use by itself.";
  py::class_<Asked>(module, "Asked")
      .def(py::init([](std::optional<double> error, std::optional<std::uint64_t> vertices,
                       std::optional<std::uint64_t> memory) {
        return Asked{error, vertices, memory};
      }));
  add_errors(module);
  add_questions(module);
  add_terrain(module);
  add_places(module);
  add_heights(module);
  add_meshes(module);
  add_rasters(module);
  add_lines(module);
  add_sight(module);
  add_volumes(module);
  add_build(module);
}
