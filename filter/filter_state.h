#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/body_motion.h"
#include "core/calibration.h"
#include "core/error_convention.h"
#include "core/imu_propagation.h"
#include "core/yaw_shift.h"
#include "filter/filter_observer.h"
#include "filter/imu_strain.h"
#include "filter/landmark_error.h"
#include "filter/square_root_covariance.h"

namespace alidade {

/// A past body pose kept in the state. `serial` counts frames and never repeats.
struct Clone {
  int serial = 0;
  int slot = 0;  ///< in [0, max_clones), its own as long as it lives
  TimeNs stamp_ns = 0;
  Pose T_WB;
  Pose T_WB_first;    ///< when it was cloned
  BodyMotion motion;  ///< of the body then, for the rows of a rolling shutter
  // Derived from the poses and the extrinsics; refreshed after every correction.
  Pose T_WC;
  Pose T_WC_jacobian;                                 ///< where Jacobians are evaluated: T_WC, or its first
  Matrix6d camera_from_error = Matrix6d::Identity();  ///< d zeta_C / d xi of this clone, at T_WC_jacobian
};

/// The camera of a clone when it exposed one observation: that of the clone, moved on by the time between the
/// stamp and the observation's row.
struct ExposedCamera {
  Pose T_WC;
  Pose T_WC_jacobian;               ///< as in Clone
  Matrix6d camera_from_error;       ///< d zeta_C / d xi of the clone, at T_WC_jacobian
  Eigen::Matrix3d R_WB;             ///< of the body then, likewise
  Vector6d camera_from_line_delay;  ///< d zeta_C / d line delay
};

/// A long-lived landmark kept in the state; its error is a LandmarkError.
struct Landmark {
  std::int64_t id = 0;    ///< of its track
  int anchor_serial = 0;  ///< of a clone in the window
  int refusals = 0;       ///< by the gate, in a row
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_W_first = Eigen::Vector3d::Zero();  ///< when it entered the state
};

/// The rows of a track that remain of its landmark after elimination (core/landmark_reduction.h): t = T x~ +
/// R_f f~ + n, n ~ N(0, I_3) independent of the eliminated rows; x~ the core and all clones, f~ a
/// LandmarkError.
struct LandmarkRows {
  Landmark landmark;
  Eigen::Matrix3d R_f = Eigen::Matrix3d::Zero();  ///< upper triangular
  Eigen::Matrix<double, 3, Eigen::Dynamic> T;     ///< 3 x (dimension without landmarks)
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
};

/// State and covariance of the filter: landmarks, current navigation state, biases and a window of clones.
/// The error is [landmarks newest first | theta p v bg ba | clones newest first | calibration], each pose in
/// the configured convention, calibration as far as it is estimated (core/calibration.h). Once aligned with
/// GNSS, six clock terms (core/clock_state.h) stand directly before the core; their mean is
/// filter/gnss_update.h's.
///
/// With `first_estimates`, Jacobians are evaluated at the first estimate of each clone and landmark, and the
/// transition runs from the first estimate at its start (the prediction, before any update there) to the
/// prediction at its end, so that transitions chain (Li & Mourikis 2013, Huang et al. 2010). Residuals use
/// the current estimates throughout. In the right-invariant convention the transition is the same either way.
class FilterState {
 public:
  static constexpr int kClockSize = 6;
  struct Limits {
    int clones = 0;
    int landmarks = 0;
    bool clock = false;
    bool imu_strain = false;  ///< whether strain() is followed
    UpdatePrecision precision = UpdatePrecision::kDouble;
  };

  FilterState(ErrorConvention convention, bool first_estimates, const Pose& T_BC, Limits limits);
  /// The camera is `calibration`, estimated in the parameters of its layout.
  FilterState(ErrorConvention convention, bool first_estimates, CalibrationEstimate calibration,
              Limits limits);

  /// Null, the default, observes nothing. It must outlive the state.
  void SetObserver(FilterObserver* observer) { observer_ = observer; }

  /// `initial.covariance` is in the canonical chart. The calibration is the given one again.
  Status Reset(const NavEstimate& initial);
  /// Propagates state and covariance over consecutive samples (at least two). kDiverged, with nothing
  /// changed: see PropagateState.
  Status Propagate(std::span<const ImuSample> samples, const ImuNoise& noise,
                   const Eigen::Vector3d& gravity_W);
  /// Clones the pose at the current time t^. With an estimated time offset the clone's error is that of the
  /// pose when the frame was really exposed, at t^ + dt: theta and p of the clone have (omega, v) dt besides
  /// the current ones. turn: measured at t^.
  void AddClone(int serial, const MeasuredTurn& turn = {});
  /// Landmarks anchored in the clone move their anchor to the newest one.
  void RemoveClone(size_t index);
  /// Enters a landmark whose rows were linearised at the present state: p_W moves by R_f^-1 t. R_f must be
  /// regular.
  void AddLandmark(const LandmarkRows& rows);
  void RemoveLandmark(size_t index);
  /// Transforms all states, adds the covariance of the transform's parameters (yaw, p_NW) to theirs, and
  /// enters the clock's rows if its covariance is given. Precondition: no landmarks.
  void Align(const YawShift& transform, const Eigen::Matrix4d& covariance,
             const std::optional<Matrix6d>& clock_covariance);
  /// Maps the error x to x + column (row . x).
  void Shear(const Eigen::Ref<const Eigen::VectorXd>& column, const Eigen::Ref<const Eigen::VectorXd>& row);
  /// Retracts every state by its part of the correction (error order of the class).
  void Correct(const Eigen::Ref<const Eigen::VectorXd>& correction);

  /// First error row of the core; landmarks lie before it.
  [[nodiscard]] int CoreOffset() const { return covariance_.leading(); }
  /// First error row of the clock; only once aligned.
  [[nodiscard]] int ClockOffset() const { return CoreOffset() - kClockSize; }
  /// First error row of the calibration.
  [[nodiscard]] int CalibrationOffset() const {
    return CoreOffset() + SquareRootCovariance::kCore + 6 * static_cast<int>(clones_.size());
  }
  /// First error row of clone `index` (0 = oldest).
  [[nodiscard]] int CloneOffset(size_t index) const {
    return CoreOffset() + SquareRootCovariance::kCore + 6 * static_cast<int>(clones_.size() - 1 - index);
  }
  /// First error row of landmark `index` (0 = oldest).
  [[nodiscard]] int LandmarkOffset(size_t index) const {
    return 3 * static_cast<int>(landmarks_.size() - 1 - index);
  }
  /// Index of the clone with this serial, or -1.
  [[nodiscard]] int FindClone(int serial) const;
  /// Index of the landmark of this track, or -1.
  [[nodiscard]] int FindLandmark(std::int64_t id) const;
  [[nodiscard]] NavEstimate Estimate() const;
  [[nodiscard]] const CalibrationLayout& layout() const { return given_.layout; }
  [[nodiscard]] const CameraCalibration& calibration() const { return calibration_; }
  [[nodiscard]] CalibrationEstimate EstimatedCalibration() const;
  /// Whether the rows of an image are exposed one after the other.
  [[nodiscard]] bool has_rolling_shutter() const { return calibration_.line_delay_s.has_value(); }
  /// Precondition: has_rolling_shutter().
  [[nodiscard]] ExposedCamera CameraAt(const Clone& clone, const NormalizedObservation& observation) const;
  /// CameraAt().T_WC, that of the clone without a rolling shutter.
  [[nodiscard]] Pose CameraPoseAt(const Clone& clone, const NormalizedObservation& observation) const;
  /// A view's rows over the calibration, 2 x layout().size(); `camera_rows`: over (phi, dp) of the clone's
  /// camera, or with a rolling shutter of `exposed`. The time offset acts through the clone's own error.
  void FillCalibrationRows(const Clone& clone, const ExposedCamera* exposed,
                           const Eigen::Matrix<double, 2, 6>& camera_rows,
                           const NormalizedObservation& observation, Eigen::Ref<Eigen::MatrixXd> rows) const;

  [[nodiscard]] const std::vector<Clone>& clones() const { return clones_; }           ///< oldest first
  [[nodiscard]] const std::vector<Landmark>& landmarks() const { return landmarks_; }  ///< oldest first
  [[nodiscard]] std::vector<Landmark>& landmarks() { return landmarks_; }
  /// Where Jacobians of a landmark are evaluated.
  [[nodiscard]] const Eigen::Vector3d& JacobianPoint(const Landmark& landmark) const {
    return first_estimates_ ? landmark.p_W_first : landmark.p_W;
  }
  [[nodiscard]] bool first_estimates() const { return first_estimates_; }
  [[nodiscard]] LandmarkError landmark_error() const { return LandmarkError(convention_); }
  [[nodiscard]] const NavState& nav() const { return nav_; }
  /// About which corrections turn the states in the right-invariant convention.
  [[nodiscard]] const Eigen::Vector3d& centre() const { return nav_first_.p_WB; }
  /// The current state as it was predicted, before any update.
  [[nodiscard]] const NavState& nav_first() const { return nav_first_; }
  [[nodiscard]] const ImuBias& bias() const { return bias_; }
  [[nodiscard]] TimeNs stamp_ns() const { return stamp_ns_; }
  [[nodiscard]] SquareRootCovariance& covariance() { return covariance_; }
  [[nodiscard]] const SquareRootCovariance& covariance() const { return covariance_; }
  [[nodiscard]] ErrorConvention convention() const { return convention_; }
  /// Of the clones against the IMU between them.
  [[nodiscard]] ImuStrain& strain() { return strain_; }
  [[nodiscard]] bool AllFinite() const;

 private:
  void RefreshClone(Clone* clone) const;
  void CorrectStrain(const Eigen::Ref<const Eigen::VectorXd>& correction);
  void Reanchor(int leaving_serial);
  // Covariance and observer alike.
  void RemoveRows(int first, int size);
  void AddToLandmark(int landmark, const Eigen::Matrix3d& m, int source);

  ErrorConvention convention_;
  bool first_estimates_;
  CalibrationEstimate given_;
  CameraCalibration calibration_;
  Eigen::VectorXd calibration_error_;  ///< of a watched one, which stays as given
  bool calibration_is_sound_ = true;
  TimeNs stamp_ns_ = 0;
  NavState nav_;
  NavState nav_first_;
  ImuBias bias_;
  std::vector<Clone> clones_;
  std::vector<int> free_slots_;
  std::vector<Landmark> landmarks_;
  SquareRootCovariance covariance_;
  ImuStrain strain_;
  FilterObserver* observer_ = nullptr;
  Eigen::Matrix<double, 3, Eigen::Dynamic> gain_;  // scratch of AddLandmark
};

}  // namespace alidade
