// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mpi/mpi_job.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "engine/construct/build_worker.h"
#include "engine/construct/tasks/task_driver.h"
#include "engine/mpi/mpi_session.h"
#include "engine/stop.h"

namespace ptin {

namespace {

// The first letter of a text from rank 0 says what it is.
constexpr char kBuild = 'b', kTask = 't', kHome = 'h';

/// Waits for messages without keeping a processor busy, which the ranks that compute need: MPI's own
/// waiting does. Short at first, since answers often come together.
class Patience {
 public:
  void wait() {
    std::this_thread::sleep_for(pause_);
    pause_ = std::min(pause_ * 2, kLongest);
  }
  void reset() { pause_ = kShortest; }

 private:
  static constexpr std::chrono::microseconds kShortest{20}, kLongest{2000};
  std::chrono::microseconds pause_ = kShortest;
};

/// Rank 0: a task for each rank that waits.
class MpiDriver final : public TaskDriver {
 public:
  explicit MpiDriver(const MpiSession& session) : session_(session) {}

  [[nodiscard]] bool begin(const BuildNote& note) override {
    for (int rank = 1; rank < session_.ranks(); ++rank) {
      session_.send(rank, kBuild + message_of(note));
      idle_.insert(rank);
    }
    return true;
  }
  std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const PieceLimits& limits,
                    const std::stop_token& stop) override;

 private:
  void hand_out(TaskSchedule& schedule);

  const MpiSession& session_;
  std::set<int> idle_;               ///< Ranks that wait for a task.
  std::map<int, TaskName> running_;  ///< What the others do.
  std::uint64_t most_bytes_ = 0;
};

void MpiDriver::hand_out(TaskSchedule& schedule) {
  while (!idle_.empty() && schedule.next_bytes()) {
    const Task task = schedule.take();
    const int rank = *idle_.begin();
    session_.send(rank, kTask + message_of(task));
    idle_.erase(rank);
    running_[rank] = task.name;
    most_bytes_ = std::max(most_bytes_, task.bytes);
  }
}

std::uint64_t MpiDriver::run(TaskSchedule& schedule, TaskWorker& worker,
                             const PieceLimits& /*limits*/, const std::stop_token& stop) {
  Patience patience;
  for (hand_out(schedule); !running_.empty(); hand_out(schedule)) {
    stop_if_asked(stop, "the build");
    if (const auto received = session_.receive()) {
      const TaskName name = running_.at(received->from);
      running_.erase(received->from);
      idle_.insert(received->from);
      if (take_answer(name, received->text, schedule)) {
        worker.tell_done(name);
      }
      patience.reset();
    } else {
      patience.wait();
    }
  }
  return most_bytes_;
}

/// A rank's worker, once a build has begun; or the answer of one that could not begin.
class RankWorker {
 public:
  RankWorker(const std::vector<std::string>& inputs, const BuildOptions& options,
             const BuildResources& resources)
      : inputs_(inputs), options_(options), resources_(resources) {}

  void begin(const std::string& note) {
    worker_.reset();
    try {
      worker_ = std::make_unique<BuildWorker>(inputs_, options_, resources_, note);
    } catch (const Error& e) {
      refusal_ = answer_of(e);
    }
  }
  [[nodiscard]] std::string answer(const std::string& task) {
    return worker_ ? worker_->answer(task) : refusal_;
  }

 private:
  const std::vector<std::string>& inputs_;
  const BuildOptions& options_;
  const BuildResources& resources_;
  std::unique_ptr<BuildWorker> worker_;
  std::string refusal_;
};

}  // namespace

struct MpiJob::Impl {
  MpiSession session;
  MpiDriver driver{session};
};

MpiJob::MpiJob() : impl_(std::make_unique<Impl>()) {}

MpiJob::~MpiJob() {
  for (int rank = 1; impl_->session.rank() == 0 && rank < ranks(); ++rank) {
    try {
      impl_->session.send(rank, std::string(1, kHome));
    } catch (const Error&) {  // NOLINT: a rank that is gone is home
    }
  }
}

int MpiJob::rank() const noexcept { return impl_->session.rank(); }
int MpiJob::ranks() const noexcept { return impl_->session.ranks(); }
TaskDriver* MpiJob::driver() noexcept { return ranks() > 1 ? &impl_->driver : nullptr; }

void MpiJob::work(const std::vector<std::string>& inputs, const BuildOptions& options,
                  const BuildResources& resources) {
  RankWorker worker(inputs, options, resources);
  Patience patience;
  while (true) {
    const auto received = impl_->session.receive();
    if (!received) {
      patience.wait();
      continue;
    }
    patience.reset();
    const std::string text = received->text.substr(1);
    if (received->text.front() == kHome) {
      return;
    }
    if (received->text.front() == kBuild) {
      worker.begin(text);
    } else {
      impl_->session.send(0, worker.answer(text));
    }
  }
}

}  // namespace ptin
