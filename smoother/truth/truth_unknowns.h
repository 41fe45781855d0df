#pragma once

#include <optional>
#include <span>
#include <vector>

#include "smoother/truth/truth_poses.h"
#include "smoother/truth/truth_terms.h"

namespace alidade {

/// What RefineTruth estimates of the motion, at the samples of the IMU that the poses reach, and the rows of
/// its linearised problem.
class TruthUnknowns {
 public:
  /// imu_scale: the factors are estimated.
  TruthUnknowns(const TruthImu& model, bool imu_scale) : model_(model), imu_scale_(imu_scale) {}

  /// From a start over `imu`, which must outlive the object; of the first and the last pose, the stamps by
  /// the clock of the truth. Before all others.
  void Begin(std::span<const ImuSample> imu, const TruthStart& start, TimeNs first_pose_ns,
             TimeNs last_pose_ns);

  /// The samples that the poses reach.
  [[nodiscard]] std::span<const ImuSample> imu() const { return imu_; }
  [[nodiscard]] const std::vector<TruthState>& states() const { return states_; }
  [[nodiscard]] const TruthConstants& constants() const { return constants_; }
  [[nodiscard]] const TruthImuScale& scale() const { return scale_; }
  /// Steps of more than ten times the median.
  [[nodiscard]] int CountImuGaps() const;

  /// Between sample k and the next one.
  [[nodiscard]] std::optional<TruthLink> Link(size_t k) const;
  /// Of a pose that has a state.
  [[nodiscard]] TruthPoseTerm Term(const GatedPose& pose) const;
  /// Weak priors of the first biases and of the constants.
  void AddPriors(ArrowSystem* system) const;

  /// Move by the solution of the linearised problem.
  void MoveState(const ArrowSystem::Solution& solution);
  void MoveConstants(const ArrowSystem::Border& step);

 private:
  /// To those that the poses reach.
  void CutSamples(const std::vector<TruthState>& states, TimeNs first_pose_ns, TimeNs last_pose_ns);
  void ApplyScale();

  std::span<const ImuSample> imu_;
  TruthImu model_;
  bool imu_scale_;
  TruthImuScale scale_;
  std::vector<ImuSample> scaled_;   ///< imu_ times the factors
  std::vector<TruthState> states_;  ///< at the samples
  TruthConstants constants_, first_constants_;
};

}  // namespace alidade
