// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors of the engine as the exceptions of ptin/errors.py.
#include <string>

#include "engine/error.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

void raise(const Error& error) {
  const py::object make = py::module_::import("ptin.errors").attr("_error_of");
  const py::object raised = make(std::string(to_string(error.code())),
                                 without_dashes(error.message()), without_dashes(error.context()));
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(raised.ptr())), raised.ptr());
}

}  // namespace

std::string without_dashes(const std::string& sentence) {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  std::string told;
  for (std::size_t i = 0; i < sentence.size(); ++i) {
    const bool begins_word = i == 0 || sentence[i - 1] == ' ' || sentence[i - 1] == '(';
    if (!begins_word || sentence.compare(i, 2, "--") != 0 || i + 2 >= sentence.size() ||
        !is_letter(sentence[i + 2])) {
      told += sentence[i];
      continue;
    }
    for (i += 2; i < sentence.size() && (is_letter(sentence[i]) || sentence[i] == '-'); ++i) {
      told += sentence[i] == '-' ? '_' : sentence[i];
    }
    --i;
  }
  return told;
}

void add_errors(py::module_& /*module*/) {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(error);
    }
  });
}

}  // namespace ptin::python
