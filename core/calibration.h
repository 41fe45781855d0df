#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/calibration_config.h"
#include "core/rig_calibration.h"
#include "core/sensor.h"
#include "core/vision_config.h"
#include "core/visual_observation.h"

namespace alidade {

/// What online calibration estimates of a camera.
struct CameraCalibration {
  CameraModel camera;
  Pose T_BC;                 ///< camera to body
  double time_offset_s = 0;  ///< t_imu = t_camera + offset
  /// Of a rolling shutter (core/rig_calibration.h); empty: all rows are exposed at once.
  std::optional<double> line_delay_s = {};
};
/// Whether all numbers are the same; of the camera its intrinsics and coefficients.
[[nodiscard]] bool operator==(const CameraCalibration& a, const CameraCalibration& b);

/// That of a rig; the line delay only with vision.rolling_shutter.
[[nodiscard]] CameraCalibration GivenCamera(const RigCalibration& rig, const VisionConfig& vision);

/// How far before and after its stamp a frame's rows need the gyroscope [s]: half the read-out, 5 ms at
/// least, since over less the noise of two samples of an IMU at 1 kHz would turn a row by a tenth of a pixel;
/// 0 where all rows are exposed at once.
[[nodiscard]] double ReadOutSpan(const CameraCalibration& camera);

/// Which coordinates the error of a CameraCalibration has, and where. In this order, each group only when its
/// key is on:
///
///   extrinsics   (phi, dp): R_BC = R^_BC Exp(phi), p_BC = p^_BC + dp     6, rad and m
///   time offset  additive                                                1, s
///   line delay   additive                                                1, s
///   intrinsics   fu fv cu cv, then the lens coefficients, additive       4 + CoefficientCount, px and 1
///   lever arm    additive to p_BA of an antenna; of a watched one        3, m
///
/// These coordinates are the same in every error convention of the state.
class CalibrationLayout {
 public:
  static constexpr int kMaxSize = 16;

  CalibrationLayout() = default;
  /// `antenna`: of a watched calibration, the sensor whose lever arm is tested along with the camera.
  CalibrationLayout(const CalibrationConfig& config, const CameraModel& camera,
                    std::optional<Sensor> antenna = std::nullopt);

  [[nodiscard]] int size() const { return size_; }
  /// First coordinate of a group, -1 when it is not estimated.
  [[nodiscard]] int extrinsics() const { return extrinsics_; }
  [[nodiscard]] int time_offset() const { return time_offset_; }
  [[nodiscard]] int line_delay() const { return line_delay_; }
  [[nodiscard]] int intrinsics() const { return intrinsics_; }
  [[nodiscard]] int intrinsics_size() const { return intrinsics_size_; }
  /// The last three coordinates, or -1.
  [[nodiscard]] int lever_arm() const { return lever_arm_; }
  /// Whose lever arm it is.
  [[nodiscard]] std::optional<Sensor> antenna() const { return antenna_; }

 private:
  int size_ = 0;
  int extrinsics_ = -1;
  int time_offset_ = -1;
  int line_delay_ = -1;
  int intrinsics_ = -1;
  int intrinsics_size_ = 0;
  int lever_arm_ = -1;
  std::optional<Sensor> antenna_;
};

/// A calibration and what is known about its error.
struct CalibrationEstimate {
  CalibrationLayout layout;
  CameraCalibration mean;
  Eigen::VectorXd deviations;  ///< standard deviations of the layout's coordinates
  /// `mean` is held as it was given, and its error is taken for all but zero (core/calibration_watch.h).
  bool watched = false;
  Eigen::VectorXd error = {};  ///< of a watched one: its expected error given the data
  /// Of a watched one, 15 x layout.size(): covariance of the state's error (canonical chart, as in
  /// NavEstimate) with its error.
  Eigen::MatrixXd state_covariance = {};
};

/// Prior deviations of a watched calibration: far below what any data determine, so that nothing moves, and
/// large enough that the difference of inverse squares before and after the data keeps its digits.
[[nodiscard]] Eigen::VectorXd WatchedDeviations(const CalibrationLayout& layout);

/// The given calibration with the configured trust in it.
[[nodiscard]] CalibrationEstimate InitialCalibration(const CalibrationConfig& config,
                                                     const CameraCalibration& given,
                                                     std::optional<Sensor> antenna = std::nullopt);

/// Moves a calibration by `error`. False, with `calibration` untouched, when that is no camera any more or
/// not finite.
bool Retract(const CalibrationLayout& layout, const Eigen::Ref<const Eigen::VectorXd>& error,
             CameraCalibration* calibration);
/// The error with Retract(layout, error, estimate) == truth in the layout's coordinates.
[[nodiscard]] Eigen::VectorXd Local(const CalibrationLayout& layout, const CameraCalibration& estimate,
                                    const CameraCalibration& truth);

/// d zeta_B / d t of a moving body in the canonical chart: (omega_B, v_W). A camera with a time-offset error
/// dt observes from the pose that the body has dt later (Li & Mourikis, IJRR 2014).
[[nodiscard]] Vector6d BodyRates(const Eigen::Vector3d& omega_B, const Eigen::Vector3d& v_WB);
/// The body `later_s` seconds later, moving on at constant BodyRates: R_WB Exp(omega s), p_WB + v s. `turn`,
/// unless null: Exp(omega s), so that d zeta_later / d zeta = blockdiag(turn^T, I).
///
/// Of the time offsets of camera and GNSS. BodyMotion (core/body_motion.h), of the rows of an image, has the
/// angular acceleration besides, and the velocity in the body's axes: over 2 ms at 10 rad/s^2, 2e-5 rad.
[[nodiscard]] Pose BodyAfter(const Pose& T_WB, const Vector6d& rates, double later_s,
                             Eigen::Matrix3d* turn = nullptr);

/// d pixel / d (fu, fv, cu, cv, coefficients) at an ideal point, 2 x 8; columns of coefficients that the lens
/// model has not are zero. False outside the camera's domain.
bool IntrinsicsJacobian(const CameraModel& camera, const Eigen::Vector2d& ideal,
                        Eigen::Matrix<double, 2, 8>* jacobian);
/// The same at a ray of any length, behind the camera too.
bool IntrinsicsJacobian(const CameraModel& camera, const Eigen::Vector3d& ray,
                        Eigen::Matrix<double, 2, 8>* jacobian);

/// d zeta_C / d (phi, dp) of the extrinsics at a fixed body pose: T_WC = T_WB T_BC turns with phi as it is,
/// and moves by R_WB dp.
[[nodiscard]] Matrix6d ExtrinsicsToCameraJacobian(const Eigen::Matrix3d& R_WB);

/// Rows of one view over a calibration, and their transpose: their size has a bound, so that products of them
/// need neither the heap nor a packed copy.
using CalibrationRowPair =
    Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, CalibrationLayout::kMaxSize>;
using CalibrationColumnPair =
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, CalibrationLayout::kMaxSize, 2>;
/// Square over a calibration.
using CalibrationInformation = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                             CalibrationLayout::kMaxSize, CalibrationLayout::kMaxSize>;

/// What the times of a camera's exposure move, each d zeta_C / d one of them; null where the pose itself
/// carries it, or where nothing moves.
struct CameraFromTimes {
  const Vector6d* offset = nullptr;
  const Vector6d* line_delay = nullptr;
};

/// Rows of one view over the calibration, 2 x layout.size(): `camera_rows`, over (phi, dp) of the view's
/// camera, chained through the extrinsics at R_WB and through the times; and W d(predicted - z) / d
/// intrinsics with W of the observation, whose z is a function of the intrinsics: z = Unproject(pixel), so dz
/// = -(d pixel / d z)^-1 (d pixel / d intrinsics). Outside the camera's domain the latter are zero.
void CalibrationRows(const CalibrationLayout& layout, const CameraModel& camera, const Eigen::Matrix3d& R_WB,
                     const CameraFromTimes& camera_from, const Eigen::Matrix<double, 2, 6>& camera_rows,
                     const NormalizedObservation& observation, Eigen::Ref<Eigen::MatrixXd> rows);

}  // namespace alidade
