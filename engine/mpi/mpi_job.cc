// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mpi/mpi_job.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "engine/construct/build_worker.h"
#include "engine/construct/source_reader.h"
#include "engine/construct/tasks/task_driver.h"
#include "engine/mpi/mpi_session.h"
#include "engine/stop.h"

namespace ptin {

namespace {

// The first letter of a text from rank 0 says what it is.
constexpr char kReading = 'r', kStage = 's', kBuild = 'b', kTask = 't', kHome = 'h';

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

  void begin_reading(const BuildNote& note) override { tell_all(kReading + message_of(note)); }
  [[nodiscard]] std::size_t processes_that_read() const noexcept override {
    return static_cast<std::size_t>(session_.ranks() - 1);
  }
  [[nodiscard]] std::vector<std::string> run_stage(const SourceStage& stage, StageWorker& worker,
                                                   const StageLimits& limits) override;
  [[nodiscard]] bool begin(const BuildNote& note) override {
    tell_all(kBuild + message_of(note));
    return true;
  }
  std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const PieceLimits& limits,
                    const std::stop_token& stop) override;

 private:
  void tell_all(const std::string& text) {
    for (int rank = 1; rank < session_.ranks(); ++rank) {
      session_.send(rank, text);
      idle_.insert(rank);
    }
  }
  [[nodiscard]] MpiSession::Received wait_for_answer(const std::stop_token& stop) const;
  void hand_out(TaskSchedule& schedule);

  const MpiSession& session_;
  std::set<int> idle_;               ///< Ranks that wait for a task.
  std::map<int, TaskName> running_;  ///< What the others do.
  std::uint64_t most_bytes_ = 0;
};

MpiSession::Received MpiDriver::wait_for_answer(const std::stop_token& stop) const {
  for (Patience patience;; patience.wait()) {
    stop_if_asked(stop, "the build");
    if (auto received = session_.receive()) {
      return *std::move(received);
    }
  }
}

/// The first error in the order of tasks is thrown when those that others do have ended.
std::vector<std::string> MpiDriver::run_stage(const SourceStage& stage, StageWorker& /*worker*/,
                                              const StageLimits& limits) {
  std::vector<std::string> told(stage.sizes.size());
  StageCount count(stage, limits);
  std::map<int, std::size_t> running;
  std::map<std::size_t, Error> errors;
  for (std::size_t next = 0;;) {
    for (; errors.empty() && next < told.size() && !idle_.empty(); ++next) {
      const int rank = *idle_.begin();
      session_.send(rank, kStage + message_of(stage, next));
      idle_.erase(rank);
      running[rank] = next;
    }
    if (running.empty()) {
      break;
    }
    const MpiSession::Received received = wait_for_answer(limits.stop);
    const std::size_t number = running.at(received.from);
    running.erase(received.from);
    idle_.insert(received.from);
    try {
      told[number] = told_in(received.text);
      count.tell_all_of(number);
    } catch (const Error& e) {
      errors.emplace(number, e);
    }
  }
  if (!errors.empty()) {
    throw Error(errors.begin()->second);
  }
  return told;
}

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
  for (hand_out(schedule); !running_.empty(); hand_out(schedule)) {
    const MpiSession::Received received = wait_for_answer(stop);
    const TaskName name = running_.at(received.from);
    running_.erase(received.from);
    idle_.insert(received.from);
    if (take_answer(name, received.text, schedule)) {
      worker.tell_done(name);
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

  void begin_reading(const std::string& note) {
    open([&] { reader_ = std::make_unique<SourceReader>(inputs_, options_, resources_, note); });
  }
  void begin(const std::string& note) {
    reader_.reset();
    open([&] { worker_ = std::make_unique<BuildWorker>(inputs_, options_, resources_, note); });
  }
  [[nodiscard]] std::string answer_in_stage(const std::string& task) {
    return reader_ ? reader_->answer(task) : refusal_;
  }
  [[nodiscard]] std::string answer(const std::string& task) {
    return worker_ ? worker_->answer(task) : refusal_;
  }

 private:
  template <class Open>
  void open(const Open& open_one) {
    worker_.reset();
    try {
      open_one();
    } catch (const Error& e) {
      refusal_ = answer_of(e);
    }
  }

  const std::vector<std::string>& inputs_;
  const BuildOptions& options_;
  const BuildResources& resources_;
  std::unique_ptr<SourceReader> reader_;
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
    switch (received->text.front()) {
      case kHome:
        return;
      case kReading:
        worker.begin_reading(text);
        break;
      case kStage:
        impl_->session.send(0, worker.answer_in_stage(text));
        break;
      case kBuild:
        worker.begin(text);
        break;
      default:
        impl_->session.send(0, worker.answer(text));
    }
  }
}

}  // namespace ptin
