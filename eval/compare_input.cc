#include "eval/compare_input.h"

#include "eval/config_yaml.h"
#include "eval/sha256.h"

namespace alidade {

const Result<CompareInput::Data>& CompareInput::Acquire(const PipelineOptions& options) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!data_) {
    data_.emplace(Load(options));
  }
  return *data_;
}

void CompareInput::Release() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (--users_ == 0) {
    data_.reset();
  }
}

Result<CompareInput::Data> CompareInput::Load(const PipelineOptions& options) const {
  return simulation_ ? RunSimulation() : LoadDataset(options);
}

Result<CompareInput::Data> CompareInput::LoadDataset(const PipelineOptions& options) const {
  Result<Dataset> dataset = ReadDataset(sequence_.dataset);
  if (!dataset.ok()) {
    return dataset.status();
  }
  Result<std::string> dataset_digest = DigestOfFolder(sequence_.dataset);
  if (!dataset_digest.ok()) {
    return dataset_digest.status();
  }
  if (!sequence_.truth.empty()) {
    Result<Trajectory> truth = ReadTrajectory(sequence_.truth);
    if (!truth.ok()) {
      return truth.status();
    }
    dataset->truth = std::move(*truth);
  }
  Result<MeasurementLog> log = MakeLog(*dataset, frontend_, options);
  if (!log.ok()) {
    return log.status();
  }
  std::string input_digest = DigestOf(*log);
  return Data{std::move(*log), std::move(dataset->truth), std::move(*dataset_digest),
              std::move(input_digest)};
}

Result<CompareInput::Data> CompareInput::RunSimulation() const {
  Result<Dataset> dataset = Simulate(*simulation_, seed_);
  if (!dataset.ok()) {
    return dataset.status();
  }
  Data data;
  data.log = {dataset->rig, std::move(dataset->imu), std::move(dataset->tracks),
              std::move(dataset->extra_cameras), dataset->gnss};
  data.truth = std::move(dataset->truth);
  SimulatorConfig config = *simulation_;
  data.dataset_digest =
      Sha256Hex(ConfigToYaml([&config](ConfigVisitor& visitor) { config.Describe(visitor); }, false) +
                "seed: " + std::to_string(seed_) + "\n");
  data.input_digest = DigestOf(data.log);
  return data;
}

}  // namespace alidade
