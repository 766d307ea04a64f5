// SPDX-License-Identifier: GPL-3.0-or-later
//
// Building a terrain from files or arrays.
#include "engine/construct/build.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <malloc.h>

#include "engine/construct/build_option_table.h"
#include "engine/error.h"
#include "tools/python/array_source.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

/// Calls a function of Python's with what is done. What it raises ends the build, and is raised again
/// where build() was called.
class PythonObserver final : public BuildObserver {
 public:
  PythonObserver(const py::function& progress, std::stop_source& stop)
      : progress_(progress), stop_(stop) {}

  void progress(const StageProgress& p) override {
    constexpr std::chrono::milliseconds kBetweenCalls{100};
    const auto now = std::chrono::steady_clock::now();
    const bool is_new_stage = stage_ != p.stage;
    const bool is_end = p.done == p.total;
    if (failure_ || (!is_new_stage && !is_end && now - last_ < kBetweenCalls)) return;
    last_ = now;
    stage_ = p.stage;
    const py::gil_scoped_acquire acquire;
    try {
      progress_(p.stage, p.done, p.total);
    } catch (py::error_already_set& raised) {
      failure_ = std::make_unique<py::error_already_set>(std::move(raised));
      stop_.request_stop();
    }
  }
  void give_back_memory() override { malloc_trim(0); }

  /// REQUIRES: the GIL.  @throws what the function has raised
  void raise_again() {
    if (!failure_) return;
    failure_->restore();
    failure_.reset();
    raise_what_is_set();
  }

 private:
  const py::function& progress_;
  std::stop_source& stop_;
  std::string stage_;
  std::chrono::steady_clock::time_point last_;
  std::unique_ptr<py::error_already_set> failure_;
};

void set_word(BuildOptions& options, const WordOption& field, const std::string& name,
              const py::handle& value) {
  const auto word = value.cast<std::string>();
  std::string known;
  for (std::size_t i = 0; i < field.words.size(); ++i) {
    if (word == field.words[i]) return field.set(options, i);
    known += (i == 0 ? "" : ", ") + std::string(field.words[i]);
  }
  refuse("\"" + word + "\" is none of " + known, name);
}

/// A text or number, or several, as texts.
std::vector<std::string> words_of(const py::handle& value) {
  const bool is_one = py::isinstance<py::str>(value) || !py::isinstance<py::iterable>(value);
  std::vector<std::string> words;
  for (const py::handle one :
       is_one ? py::make_tuple(value) : py::tuple(py::reinterpret_borrow<py::object>(value))) {
    if (!py::isinstance<py::str>(one)) static_cast<void>(one.cast<int>());
    words.push_back(py::str(one));
  }
  return words;
}

/// Puts a value of Python's where the table of options says.
void set_option(BuildOptions& options, const BuildOption& option, const py::handle& value) {
  const auto put = [&](const auto& field) {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, WordOption>) {
      set_word(options, field, key_of(option), value);
    } else if constexpr (std::is_same_v<Field, std::vector<int> BuildOptions::*>) {
      options.*field = option.numbers_of(words_of(value));
    } else {
      auto& place = options.*field;
      place = value.cast<std::decay_t<decltype(place)>>();
    }
  };
  try {
    std::visit(put, option.field);
  } catch (const py::cast_error&) {
    refuse("this is no value of the option: " + py::repr(value).cast<std::string>(),
           key_of(option));
  }
}

BuildOptions options_of(const py::dict& given) {
  BuildOptions options;
  for (const auto& [key, value] : given) {
    const auto name = key.cast<std::string>();
    const auto table = build_option_table();
    const auto option = std::find_if(table.begin(), table.end(),
                                     [&](const BuildOption& o) { return key_of(o) == name; });
    if (option == table.end()) {
      throw py::type_error("build() has no option \"" + name + "\"; help(ptin.build) lists them");
    }
    if (!value.is_none()) set_option(options, *option, value);
  }
  return options;
}

/// The options as (name, type, help).
py::list list_of_options() {
  py::list all;
  for (const BuildOption& option : build_option_table()) {
    const char* const type = std::visit(
        [](const auto& field) {
          using Field = std::decay_t<decltype(field)>;
          if constexpr (std::is_same_v<Field, bool BuildOptions::*>) return "bool";
          if constexpr (std::is_same_v<Field, double BuildOptions::*> ||
                        std::is_same_v<Field, std::optional<double> BuildOptions::*>)
            return "float";
          if constexpr (std::is_same_v<Field, std::optional<std::int64_t> BuildOptions::*>)
            return "int";
          if constexpr (std::is_same_v<Field, std::vector<int> BuildOptions::*>)
            return "int, str or list of them";
          if constexpr (std::is_same_v<Field, std::vector<std::string> BuildOptions::*>)
            return "list of str";
          if constexpr (std::is_same_v<Field, std::optional<std::array<double, 4>> BuildOptions::*>)
            return "four floats";
          return "str";
        },
        option.field);
    all.append(py::make_tuple(key_of(option), type, without_dashes(option.help)));
  }
  return all;
}

std::unique_ptr<ArraySource> source_of_grid(const py::array& grid, const std::string& type,
                                            const std::array<double, 6>& geotransform) {
  return std::make_unique<ArraySource>(
      GridArray{grid.data(), type, static_cast<std::size_t>(grid.itemsize()),
                static_cast<std::size_t>(grid.shape(1)), static_cast<std::size_t>(grid.shape(0)),
                geotransform});
}

std::unique_ptr<ArraySource> source_of_points(const Numbers& points) {
  return std::make_unique<ArraySource>(points.data(), static_cast<std::size_t>(points.shape(0)));
}

struct Resources {
  std::uint64_t memory = 0;
  int threads = 0;
  bool overwrite = false;
  std::string tmp;
  Unfinished unfinished = Unfinished::kRefuse;
};

py::dict report_of(const BuildReport& r) {
  py::dict d;
  d["samples"] = r.source_samples;
  d["void_samples"] = r.void_samples;
  d["lone_samples"] = r.lone_samples;
  d["left_out_points"] = r.left_out.total();
  d["empty_inputs"] = r.empty_inputs;
  d["left_out_triangles"] = r.left_out_triangles;
  d["void_triangles"] = r.void_triangles;
  d["merged_points"] = r.merged_points;
  d["largest_shift"] = py::make_tuple(r.largest_shift_plan, r.largest_shift_height);
  d["height_rounding"] = r.height_rounding;
  d["vertices"] = r.vertices;
  d["records"] = r.records;
  d["t0_vertices"] = r.t0_vertices;
  d["rank"] = r.max_rank;
  d["bytes"] = r.file_bytes;
  d["source_bytes"] = r.source_bytes;
  d["seconds"] = r.seconds;
  d["resumed"] = r.resumed;
  py::list warnings;
  for (const SourceWarning& warning : r.warnings.all()) {
    const std::string message = without_dashes(warning.message);
    warnings.append(warning.file.empty() ? message : warning.file + ": " + message);
  }
  d["warnings"] = warnings;
  return d;
}

py::dict build_terrain(const std::vector<std::string>& inputs, const std::string& output,
                       const py::dict& options, const Resources& asked,
                       const std::optional<py::function>& progress) {
  std::stop_source stop;
  const BuildOptions build_options = options_of(options);
  BuildResources resources;
  resources.memory_bytes = asked.memory;
  resources.threads = asked.threads;
  resources.overwrite = asked.overwrite;
  resources.tmp = asked.tmp;
  resources.unfinished = asked.unfinished;
  resources.stop = stop.get_token();
  std::optional<PythonObserver> observer;
  if (progress) resources.observer = &observer.emplace(*progress, stop);
  BuildReport report;
  try {
    report =
        run_interruptibly(stop, [&] { return build(inputs, output, build_options, resources); });
  } catch (const Error&) {
    if (observer) observer->raise_again();
    throw;
  }
  if (observer) observer->raise_again();
  return report_of(report);
}

/// Removes what an interrupted build of `output` has left.
void discard(const std::string& output) { Workspace::discard(FileLayer::system(), output); }

}  // namespace

void add_build(py::module_& module) {
  py::class_<ArraySource>(module, "ArraySource").def_property_readonly("name", &ArraySource::name);
  // The memory of an array is borrowed, so the array lives as long.
  module.def("source_of_grid", source_of_grid, py::keep_alive<0, 1>());
  module.def("source_of_points", source_of_points, py::keep_alive<0, 1>());
  py::enum_<Unfinished>(module, "Unfinished")
      .value("REFUSE", Unfinished::kRefuse)
      .value("RESUME", Unfinished::kResume)
      .value("DISCARD", Unfinished::kDiscard);
  py::class_<Resources>(module, "Resources")
      .def(py::init([](std::uint64_t memory, int threads, bool overwrite, std::string tmp,
                       Unfinished unfinished) {
        return Resources{memory, threads, overwrite, std::move(tmp), unfinished};
      }));
  module.def("build", build_terrain);
  module.def("build_options", list_of_options);
  module.def("discard", discard);
  module.def("work_folder", &Workspace::folder_of);
}

}  // namespace ptin::python
