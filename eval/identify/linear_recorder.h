#pragma once

#include "core/status.h"
#include "eval/identify/linear_system.h"

namespace alidade {

/// Records a filter at work. Precondition: no landmarks in the state, no online calibration, no first
/// estimates.
class LinearRecorder : public FilterObserver {
 public:
  LinearRecorder(const ImuNoise& noise, const Eigen::Vector3d& gravity_W);

  void OnReset(const FilterState& state) override;
  void OnImu(const FilterState& state, std::span<const ImuSample> samples) override;
  void OnPropagate(const Matrix15d& phi, const Matrix15d& q) override;
  void OnClone(int first, int size) override;
  void OnRemove(int first, int size) override;
  void OnAlign(const Eigen::MatrixXd& turn, bool has_clock) override;
  void OnShear(const Eigen::VectorXd& column, const Eigen::VectorXd& row) override;
  void OnPropagateClock(const Matrix6d& phi, const Matrix6d& q) override;
  void OnUpdate(const FilterState& state, const FilterRows& rows) override;
  void OnFrame(const FilterState& state) override;

  /// What was recorded, with the corrections filled in. kDiverged: an update's numbers are not finite.
  Result<LinearSystem> Take();

 private:
  void AddRestart();

  std::array<ImuNoise, kImuNoiseSources> noises_;  ///< one density each, the others zero
  Eigen::Vector3d gravity_W_;
  const FilterState* state_ = nullptr;
  std::array<Eigen::MatrixXd, kImuNoiseSources> q_;  ///< of the propagation at hand
  LinearSystem system_;
};

}  // namespace alidade
