#pragma once

#include <optional>
#include <string>

#include "core/frontend_config.h"
#include "eval/compare/plan.h"
#include "eval/frontend_run/frontend_summary.h"
#include "eval/frontend_run/image_pipeline.h"
#include "eval/frontend_run/log_cache.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// Where front-end results are stored, and whether stored results are used.
struct FrontendCache {
  std::string folder = {};  ///< empty: not kept
  bool reuse = false;
};

/// The input of all estimators of one sequence and seed.
class CompareInput {
 public:
  struct Data {
    MeasurementLog log;
    std::optional<Trajectory> truth;
    std::string dataset_digest;
    std::string input_digest;
    std::optional<FrontendSummary>
        frontend;  ///< where the front end ran here, now or in an earlier comparison
    std::optional<RigCalibration> true_rig = {};  ///< Dataset::true_rig
    std::vector<std::string> remarks = {};        ///< remarks of the reader, as text
  };

  /// A dataset folder. `frontend` is used when it has images but no tracks, which it may only be when
  /// `may_track`.
  CompareInput(const PlanSequence& sequence, FrontendConfig frontend, FrontendCache cache = {},
               bool may_track = true)
      : sequence_(sequence), frontend_(frontend), may_track_(may_track), cache_(std::move(cache)) {}
  /// A simulation with this seed. `frontend` is used when it has images.
  CompareInput(const PlanSequence& sequence, SimulatorConfig simulation, unsigned seed,
               FrontendConfig frontend, FrontendCache cache = {})
      : sequence_(sequence),
        frontend_(frontend),
        may_track_(simulation.render.enabled),
        cache_(std::move(cache)),
        simulation_(std::move(simulation)),
        seed_(seed) {}

  /// Whether loading it may take long, because its images are tracked first.
  [[nodiscard]] bool may_track() const { return may_track_; }
  /// The data, or the reason why there is none; valid until Release. The first call loads it.
  const Result<Data>& Acquire(const PipelineOptions& options);
  void Release() { data_.reset(); }

 private:
  Result<Data> Load(const PipelineOptions& options) const;
  Result<Data> LoadDataset(const PipelineOptions& options) const;
  Result<Data> RunSimulation(const PipelineOptions& options) const;
  /// The tracks of `make`, or those kept from an earlier comparison on the same `source`.
  Result<FrontendRun> RunFrontend(
      const std::string& source, const PipelineOptions& options,
      const std::function<Result<std::vector<TrackFrame>>(const PipelineOptions&)>& make) const;

  const PlanSequence& sequence_;
  FrontendConfig frontend_;
  bool may_track_;
  FrontendCache cache_;
  std::optional<SimulatorConfig> simulation_;
  unsigned seed_ = 0;
  std::optional<Result<Data>> data_;
};

}  // namespace alidade
