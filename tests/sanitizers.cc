// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the sanitizers are told about libraries that are not ours; in every test program and fuzz
// target, and in the sanitized ptin, so that a program run by hand behaves as under ctest. Without
// sanitizers nobody calls these.

/// Libraries that keep what they allocate once until the process ends.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libproj.so\nleak:libgdal.so\nleak:libfontconfig.so\n"
         "leak:SpatialIndex::RTree::ExternalSorter\n";  // forgets a record at the end of a run
}

extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() { return "print_stacktrace=1"; }

/// GDAL is not instrumented.
extern "C" const char* __tsan_default_options();
extern "C" const char* __tsan_default_options() { return "ignore_noninstrumented_modules=1"; }
