#include "eval/compare/worker_pool.h"

#include <poll.h>

#include <algorithm>

#include "core/format.h"
#include "eval/compare/cell_runner.h"

namespace alidade {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMs = 200;   // how late a stop or the end of a cell's time may be noticed
constexpr int kMemoryMs = 50;  // while a cell's memory is watched

/// Contiguous cells of one input.
std::vector<CellQueue::Input> InputsOf(const CellList& cells, const std::vector<size_t>& wanted) {
  std::vector<CellQueue::Input> inputs;
  for (const size_t cell : wanted) {
    if (inputs.empty() || inputs.back().end != cell || cells.at(cell).input != cells.at(cell - 1).input) {
      inputs.push_back({cell, cell, cells.at(cell).input->may_track()});
    }
    inputs.back().end = cell + 1;
  }
  return inputs;
}

}  // namespace

WorkerPool::WorkerPool(const CompareOptions& options, const CellList& cells,
                       const std::vector<size_t>& wanted, std::function<void(size_t cell)> ended)
    : options_(options), cells_(cells), queue_(InputsOf(cells, wanted)), ended_(std::move(ended)) {}

Status WorkerPool::Run() {
  while (!options_.Stopped()) {
    ALIDADE_RETURN_IF_ERROR(Fill());
    Feed();
    if (workers_.empty()) {
      break;
    }
    ALIDADE_RETURN_IF_ERROR(Listen());
    ALIDADE_RETURN_IF_ERROR(Watch());
  }
  for (Worker& worker : workers_) {
    worker.process.Interrupt();  // all before the first is waited for
  }
  workers_.clear();
  return Status::Ok();
}

Status WorkerPool::Fill() {
  size_t idle = static_cast<size_t>(
      std::count_if(workers_.begin(), workers_.end(), [](const Worker& worker) { return !worker.cell; }));
  while (workers_.size() < static_cast<size_t>(options_.jobs) && idle++ < queue_.size()) {
    Result<WorkerProcess> process = WorkerProcess::Start(options_.worker);
    ALIDADE_RETURN_IF_ERROR(process.status());
    workers_.push_back({std::move(*process), false, {}, {}, {}});
  }
  return Status::Ok();
}

void WorkerPool::Feed() {
  for (auto worker = workers_.begin(); worker != workers_.end();) {
    if (worker->ready && !worker->cell) {
      worker->cell = queue_.Next(worker->last);
      if (worker->cell) {
        worker->begin = Clock::now();
        worker->process.Send(std::to_string(*worker->cell));
      }
    }
    worker =
        worker->ready && !worker->cell && queue_.size() == 0 ? workers_.erase(worker) : std::next(worker);
  }
}

Status WorkerPool::Listen() {
  std::vector<pollfd> descriptors;
  for (const Worker& worker : workers_) {
    descriptors.push_back({worker.process.descriptor(), POLLIN, 0});
  }
  const int wait_ms = options_.limits.memory_mib > 0 ? kMemoryMs : kPollMs;
  if (::poll(descriptors.data(), descriptors.size(), wait_ms) <= 0) {
    return Status::Ok();
  }
  auto worker = workers_.begin();
  for (const pollfd& descriptor : descriptors) {
    const auto next = std::next(worker);
    if (descriptor.revents != 0) {
      ALIDADE_RETURN_IF_ERROR(worker->process.Read() ? TakeLines(&*worker) : Remove(worker, {}));
    }
    worker = next;
  }
  return Status::Ok();
}

Status WorkerPool::TakeLines(Worker* worker) {
  while (const std::optional<std::string> line = worker->process.Line()) {
    if (*line == "ready") {
      worker->ready = true;
    } else if (worker->cell && *line == "done " + std::to_string(*worker->cell)) {
      queue_.Ended(*worker->cell);
      ended_(*worker->cell);
      worker->last = worker->cell;
      worker->cell.reset();
    } else {
      return Status::Output("a worker answered \"" + *line + "\", expected the end of its cell");
    }
  }
  return Status::Ok();
}

std::string WorkerPool::BeyondLimit(const Worker& worker) const {
  const CellLimits& limits = options_.limits;
  if (limits.time_s > 0 &&
      std::chrono::duration<double>(Clock::now() - worker.begin).count() > limits.time_s) {
    return Format("took longer than %g s (--cell_time_limit_s)", limits.time_s);
  }
  constexpr double kMib = 1 << 20;
  if (limits.memory_mib > 0 && static_cast<double>(worker.process.Memory()) > limits.memory_mib * kMib) {
    return Format("took more than %g MiB of memory (--cell_memory_limit_mib)", limits.memory_mib);
  }
  return {};
}

Status WorkerPool::Watch() {
  for (auto worker = workers_.begin(); worker != workers_.end();) {
    const auto next = std::next(worker);
    if (const std::string fault = worker->cell ? BeyondLimit(*worker) : std::string(); !fault.empty()) {
      worker->process.Kill();
      ALIDADE_RETURN_IF_ERROR(Remove(worker, fault));
    }
    worker = next;
  }
  return Status::Ok();
}

Status WorkerPool::Remove(std::list<Worker>::iterator worker, const std::string& fault) {
  const std::string how = worker->process.Join();
  const std::optional<size_t> cell = worker->cell;
  const bool ready = worker->ready;
  workers_.erase(worker);
  if (!ready && !options_.Stopped()) {
    return Status::Output("a worker ended with " + how + " before it took a cell");
  }
  if (cell && !options_.Stopped()) {
    queue_.Ended(*cell);
    ALIDADE_RETURN_IF_ERROR(
        ReportFault(cells_.at(*cell), fault.empty() ? "its process ended with " + how : fault));
    ended_(*cell);
  }
  return Status::Ok();
}

}  // namespace alidade
