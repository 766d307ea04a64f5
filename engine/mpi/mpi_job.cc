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
/// waiting does. Sleeps for an eighth of what it has waited, so that a message is seen about as late;
/// the next task comes a few milliseconds after an answer.
class Patience {
 public:
  void wait() {
    const std::chrono::microseconds pause = std::clamp(waited_ / 8, kShortest, kLongest);
    std::this_thread::sleep_for(pause);
    waited_ += pause;
  }
  void reset() { waited_ = {}; }

 private:
  static constexpr std::chrono::microseconds kShortest{20}, kLongest{2000};
  std::chrono::microseconds waited_{};
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
  [[nodiscard]] std::size_t processes_that_read() const noexcept override {
    return static_cast<std::size_t>(session_.ranks() - 1);
  }
  std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const TaskLimits& limits,
                    const std::stop_token& stop) override;

 private:
  struct HandedOut {
    std::uint64_t number = 0;  ///< In the order of handing out.
    TaskName name;
  };
  [[nodiscard]] MpiSession::Received wait_for_answer(const std::stop_token& stop) const;
  void hand_out(TaskSchedule& schedule);

  const MpiSession& session_;
  std::set<int> idle_;                ///< Ranks that wait for a task.
  std::map<int, HandedOut> running_;  ///< What the others do.
  std::uint64_t handed_out_ = 0, most_bytes_ = 0;
};

MpiSession::Received MpiDriver::wait_for_answer(const std::stop_token& stop) const {
  for (Patience patience;; patience.wait()) {
    stop_if_asked(stop, "the build");
    if (auto received = session_.receive()) {
      return *std::move(received);
    }
  }
}

void MpiDriver::hand_out(TaskSchedule& schedule) {
  while (!idle_.empty() && schedule.next_bytes()) {
    const Task task = schedule.take();
    const int rank = *idle_.begin();
    session_.send(rank, kTask + message_of(task));
    idle_.erase(rank);
    running_[rank] = {handed_out_++, task.name};
    most_bytes_ = std::max(most_bytes_, task.bytes);
  }
}

/// Nobody is stopped after an error: what the others do ends, and the error of the task that was
/// handed out first is thrown.
std::uint64_t MpiDriver::run(TaskSchedule& schedule, TaskWorker& /*worker*/,
                             const TaskLimits& /*limits*/, const std::stop_token& stop) {
  std::map<std::uint64_t, Error> errors;
  for (hand_out(schedule); !running_.empty();) {
    const MpiSession::Received received = wait_for_answer(stop);
    const HandedOut task = running_.at(received.from);
    running_.erase(received.from);
    idle_.insert(received.from);
    try {
      take_answer(task.name, received.text, schedule);
    } catch (const Error& e) {
      errors.emplace(task.number, e);
    }
    if (errors.empty()) {
      hand_out(schedule);
    }
  }
  if (!errors.empty()) {
    throw Error(errors.begin()->second);
  }
  return most_bytes_;
}

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
  std::unique_ptr<BuildWorker> worker;
  std::string refusal;  // the answer of one that could not begin
  for (Patience patience;;) {
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
    if (received->text.front() == kTask) {
      impl_->session.send(0, worker ? worker->answer(text) : refusal);
      continue;
    }
    worker.reset();  // what read the source goes before its tiles are opened
    try {
      worker = std::make_unique<BuildWorker>(inputs, options, resources, text);
    } catch (const Error& e) {
      refusal = answer_of(e);
    }
  }
}

}  // namespace ptin
