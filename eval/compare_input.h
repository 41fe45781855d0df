#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "core/estimator_config.h"
#include "eval/image_pipeline.h"
#include "eval/plan.h"
#include "eval/simulator.h"

namespace alidade {

/// What all estimators of one sequence and seed read. Loaded when the first cell asks, dropped after the
/// last.
class CompareInput {
 public:
  struct Data {
    MeasurementLog log;
    std::optional<Trajectory> truth;
    std::string dataset_digest;
    std::string input_digest;
  };

  /// A dataset folder. `frontend` is used when it has images but no tracks.
  CompareInput(const PlanSequence& sequence, FrontendConfig frontend)
      : sequence_(sequence), frontend_(frontend) {}
  /// A simulation with this seed.
  CompareInput(const PlanSequence& sequence, SimulatorConfig simulation, unsigned seed)
      : sequence_(sequence), simulation_(std::move(simulation)), seed_(seed) {}

  /// One more cell will ask for the data.
  void AddUser() { ++users_; }
  /// The data, or why there is none; valid until Release. The first caller loads, others wait.
  const Result<Data>& Acquire(const PipelineOptions& options);
  /// Called once by every user.
  void Release();

 private:
  Result<Data> Load(const PipelineOptions& options) const;
  Result<Data> LoadDataset(const PipelineOptions& options) const;
  Result<Data> RunSimulation() const;

  const PlanSequence& sequence_;
  FrontendConfig frontend_;
  std::optional<SimulatorConfig> simulation_;
  unsigned seed_ = 0;
  std::mutex mutex_;
  std::optional<Result<Data>> data_;
  int users_ = 0;
};

}  // namespace alidade
