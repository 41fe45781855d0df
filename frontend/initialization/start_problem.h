#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "frontend/initialization/dynamic_window.h"
#include "frontend/initialization/refinement_settings.h"

namespace alidade {

/// The nonlinear least-squares problem of RefineStart: cost, normal equations over 15 M columns and trial
/// steps.
class StartProblem {
 public:
  StartProblem(const DynamicWindow& window, const std::vector<bool>& inlier,
               const std::vector<Preintegration>& preintegrations, const std::vector<NavState>& states,
               const ImuBias& bias, const RefinementSettings& settings);

  /// False when the noise of a preintegration is singular; nothing else may be called then.
  [[nodiscard]] bool valid() const { return valid_; }

  /// Builds the normal equations at the current states and landmarks; returns the robust cost.
  double Linearize();
  /// After Linearize: half the derivative of that cost over (phi, dp, dv, dbg, dba) of each state, the
  /// landmarks following their optimum.
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  /// Solves with Marquardt damping into a trial state with its landmarks; returns its robust cost (infinite:
  /// singular).
  double TryStep(double damping);
  void AcceptStep();
  /// Drops observations whose squared whitened residual exceeds the limit, and tracks that lose half of
  /// theirs or lie behind a view; returns how many observations went.
  int DropAbove(double squared_residual);

  /// Marginal of the newest state, gauge prior included; the data's part is scaled by `variance_factor`.
  /// False when singular. After Linearize.
  bool NewestCovariance(double variance_factor, Matrix15d* covariance) const;
  /// After Linearize; false when the information is singular. `relative_scale_std`: deviation of s in
  /// c_i - c_newest -> (1 + s) (c_i - c_newest), c the cameras' positions. `inertial_chi2`: of the
  /// preintegrations' residuals, a degree of freedom that the fit leaves them: their rows less the trace of
  /// their share in the information, most of which the states take up.
  bool Assess(double* relative_scale_std, double* inertial_chi2) const;
  [[nodiscard]] double ReprojectionChi2() const;

  [[nodiscard]] int active_tracks() const;
  [[nodiscard]] const std::vector<NavState>& states() const { return current_.states; }
  [[nodiscard]] const std::vector<ImuBias>& biases() const { return current_.biases; }

 private:
  struct Variables {
    std::vector<NavState> states;
    std::vector<ImuBias> biases;
    std::vector<Eigen::Vector3d> landmarks;
  };
  /// What Linearize found of a track's landmark: R dp + jacobian dx + rhs = 0 of its own three rows.
  struct LandmarkRows {
    Eigen::Matrix3d R = Eigen::Matrix3d::Zero();  ///< upper triangular; zero: the track was left out
    Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian;  ///< 3 x 6N over its views' (phi, dp) of the body
  };
  /// The landmark of a track after `step` of the states, to first order; false when it has no rows.
  bool StepLandmark(size_t track, const Eigen::VectorXd& step, Eigen::Vector3d* landmark) const;
  void InitializeLandmarks();
  [[nodiscard]] std::vector<Pose> Cameras(const Variables& variables, const SharedTrack& track) const;
  /// Squared whitened residual of each observation; false when the landmark is behind a view.
  bool TrackResiduals(const Variables& variables, size_t track, std::vector<double>* squared) const;
  [[nodiscard]] double TrackCost(const Variables& variables, size_t track) const;
  [[nodiscard]] double InertialCost(const Variables& variables) const;
  [[nodiscard]] double PriorCost(const Variables& variables) const;
  void AddTrack(size_t track);
  /// Whitened, over (state k, state k + 1), 15 columns each.
  Eigen::Matrix<double, 15, 30> InertialJacobian(size_t k, Vector15d* residual) const;
  void AddInertial();
  void AddPriors();
  bool RelativeScaleStd(const Eigen::LLT<Eigen::MatrixXd>& factor, double* deviation) const;
  bool InertialChi2(const Eigen::LLT<Eigen::MatrixXd>& factor, double* chi2) const;

  std::vector<SharedTrack> tracks_;
  const std::vector<Preintegration>& preintegrations_;
  RefinementSettings settings_;
  Eigen::Vector3d gravity_W_;
  std::vector<Matrix15d> sqrt_information_;  // of each preintegration
  bool valid_ = true;
  std::vector<bool> active_;
  Variables current_, trial_;
  std::vector<LandmarkRows> landmark_rows_;  // of each track, at current_
  Eigen::MatrixXd information_;              // without the gauge prior; its lower triangle
  Eigen::MatrixXd gauge_;                    // 15 x 15 on the newest state
  Eigen::VectorXd gradient_;
};

}  // namespace alidade
