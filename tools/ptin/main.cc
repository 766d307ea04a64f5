// SPDX-License-Identifier: GPL-3.0-or-later
//
// The program `ptin`: signals in, exit status out; everything else is in the subcommands.
#include "tools/ptin/build_cluster.h"
#include "tools/ptin/cli.h"
#include "tools/ptin/stop_on_signals.h"
#include "tools/refused_memory.h"

#ifdef PTIN_MPI
#include "engine/mpi/mpi_job.h"

namespace {

class MpiCluster final : public ptin::tools::BuildCluster {
 public:
  [[nodiscard]] bool directs() const override { return job_.rank() == 0; }
  [[nodiscard]] ptin::TaskDriver* driver() override { return job_.driver(); }
  void work(const std::vector<std::string>& inputs, const ptin::BuildOptions& options,
            const ptin::BuildResources& resources) override {
    job_.work(inputs, options, resources);
  }

 private:
  ptin::MpiJob job_;
};

}  // namespace
#endif

int main(int argc, char** argv) {
  ptin::tools::Context context;
  ptin::tools::prepare_for_refused_memory();
#ifdef PTIN_MPI
  context.join_cluster = [] { return std::make_unique<MpiCluster>(); };
#endif
  try {
    context.stop = ptin::tools::stop_on_signals();
  } catch (...) {
    return ptin::tools::report_current_error(context.json);
  }
  return ptin::tools::run_program(argc, argv, context);
}
