#pragma once

#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/status.h"
#include "smoother/factors/gnss_factors.h"
#include "smoother/factors/imu_factor.h"
#include "smoother/factors/inverse_depth_factor.h"
#include "smoother/factors/pose_only_factor.h"
#include "smoother/factors/prior_factor.h"
#include "smoother/factors/rest_factor.h"
#include "smoother/factors/slam_prior_factor.h"

namespace alidade {

/// Everything one solve hands to Ceres by pointer; it must outlive the problem it fills. All parameter blocks
/// lie in one array in a fixed order: Ceres sorts the blocks of an elimination group by ADDRESS, so blocks
/// scattered over the heap would make the rounding depend on its history.
class SolveStore {
 public:
  using Frames = std::vector<std::unique_ptr<WindowFrame>>;

  /// Copies states and landmarks; `frames`, `tracks` and `calibration` must outlive the store. calibration:
  /// of a camera that is calibrated online, else null.
  SolveStore(ErrorConvention error, const ObservationKernel& kernel, const Frames& frames,
             const std::vector<WindowTrack*>& tracks, const WindowCalibration* calibration = nullptr);

  [[nodiscard]] double* Nav(int frame) { return &parameters_[kFrameStride * static_cast<size_t>(frame)]; }
  [[nodiscard]] double* Bias(int frame) { return Nav(frame) + kNavAmbientSize; }
  /// Of an aligned window.
  [[nodiscard]] double* Clock(int frame) {
    return Landmark(tracks_.size()) + kClockStride * static_cast<size_t>(frame);
  }
  /// With a calibration.
  [[nodiscard]] double* Calibration() { return Clock(static_cast<int>(has_clocks_ ? frames_.size() : 0)); }
  [[nodiscard]] bool has_calibration() const { return calibration_ != nullptr; }
  [[nodiscard]] bool has_clocks() const { return has_clocks_; }
  [[nodiscard]] double* Landmark(size_t track) {
    return &parameters_[kFrameStride * frames_.size() + kLandmarkStride * track];
  }

  /// A problem that owns nothing, with the blocks of all frames.
  [[nodiscard]] std::unique_ptr<ceres::Problem> MakeProblem();
  void AddPrior(const LinearPrior& prior, ceres::Problem* problem);
  /// A prior with landmarks; must outlive the store.
  void AddSlamPrior(const SlamPrior& prior, ceres::Problem* problem);
  /// kDiverged: the covariance of an interval is not positive definite.
  Status AddImu(const Eigen::Vector3d& gravity_W, ceres::Problem* problem);
  void AddRest(ceres::Problem* problem);
  /// Epochs and clocks of an aligned window. `context` must outlive the store.
  void AddGnss(const GnssFactorContext& context, ceres::Problem* problem);
  /// T_BC must outlive the store.
  void AddInverseDepth(const Pose& T_BC, ceres::Problem* problem);
  /// `window` must outlive the store. T_BC: of a camera that is not calibrated online.
  void AddPoseOnly(const Window& window, const Pose& T_BC, ceres::Problem* problem);

  /// True when every parameter is a finite number.
  [[nodiscard]] bool IsFinite() const;
  /// Puts the parameters back into the frames and tracks they came from.
  void WriteBack() const;

 private:
  static constexpr size_t kFrameStride = 16;    // nav (10) and bias (6)
  static constexpr size_t kLandmarkStride = 4;  // one spare, so that every block stays 16-byte aligned
  static constexpr size_t kClockStride = 6;
  static constexpr size_t kCalibrationStride = 16;

  const Frames& frames_;
  const std::vector<WindowTrack*>& tracks_;
  const WindowCalibration* calibration_;
  std::unique_ptr<ceres::SubsetManifold> calibration_manifold_;
  bool has_clocks_;
  std::vector<double> parameters_;
  NavStateManifold manifold_;
  ObservationKernel kernel_;
  std::unique_ptr<ceres::LossFunction> loss_;
  std::deque<LiftedCost<ImuFactor>> imu_;
  std::deque<LiftedCost<RestFactor>> rest_;
  std::deque<LiftedCost<GnssEpochFactor>> gnss_;
  std::deque<LiftedCost<ClockFactor>> clock_;
  std::deque<LiftedCost<InverseDepthFactor>> inverse_depth_;
  std::deque<LiftedCost<BaseBearingFactor>> base_bearing_;
  std::deque<LiftedCost<DepthPriorFactor>> depth_prior_;
  std::optional<LiftedCost<PoseOnlyFactor>> pose_only_;
  std::optional<LiftedCost<PriorFactor>> prior_;
  std::optional<LiftedCost<SlamPriorFactor>> slam_prior_;
};

}  // namespace alidade
