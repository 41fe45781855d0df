#include "core/calibration.h"

#include <Eigen/LU>
#include <vector>

#include "core/equidistant_lens.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

/// fu fv cu cv and the lens coefficients that the model has not: as many as `size`.
VectorXd Intrinsics(const CameraModel& camera, int size) {
  VectorXd all(4 + camera.coefficients().size());
  all << camera.intrinsics(), camera.coefficients();
  return all.head(size);
}

Result<CameraModel> WithIntrinsics(const CameraModel& camera, const VectorXd& intrinsics) {
  LensCoefficients coefficients = camera.coefficients();
  coefficients.head(intrinsics.size() - 4) = intrinsics.tail(intrinsics.size() - 4);
  const std::vector<double> used(coefficients.data(), coefficients.data() + CoefficientCount(camera.model()));
  Result<CameraModel> moved =
      CameraModel::Create(camera.model(), intrinsics.head<4>(), used, camera.width_px(), camera.height_px());
  return moved.ok() ? moved->WithPlane(camera.plane()) : moved;
}

Eigen::Matrix<double, 2, 8> WithLens(const CameraModel& camera, const Vector2d& distorted,
                                     const Eigen::Matrix<double, 2, 4>& lens) {
  Eigen::Matrix<double, 2, 8> jacobian;
  jacobian << distorted.x(), 0, 1, 0, camera.intrinsics()[0] * lens.row(0),  //
      0, distorted.y(), 0, 1, camera.intrinsics()[1] * lens.row(1);
  return jacobian;
}

}  // namespace

bool operator==(const CameraCalibration& a, const CameraCalibration& b) {
  return a.T_BC.rotation == b.T_BC.rotation && a.T_BC.translation == b.T_BC.translation &&
         a.time_offset_s == b.time_offset_s && a.line_delay_s == b.line_delay_s &&
         a.camera.intrinsics() == b.camera.intrinsics() && a.camera.coefficients() == b.camera.coefficients();
}

CameraCalibration GivenCamera(const RigCalibration& rig, const VisionConfig& vision) {
  CameraCalibration given{rig.camera, rig.T_BC, rig.camera_time_offset_s};
  if (rig.line_delay_s != 0 && vision.rolling_shutter) {
    given.line_delay_s = rig.line_delay_s;
  }
  return given;
}

double ReadOutSpan(const CameraCalibration& camera) {
  constexpr double kLeastS = 5e-3;
  return camera.line_delay_s
             ? std::max(kLeastS, 0.5 * camera.camera.height_px() * std::abs(*camera.line_delay_s))
             : 0;
}

CalibrationLayout::CalibrationLayout(const CalibrationConfig& config, const CameraModel& camera,
                                     std::optional<Sensor> antenna)
    : antenna_(config.watched() ? antenna : std::nullopt) {
  const auto take = [this](bool wanted, int size, int* first) {
    *first = wanted ? size_ : -1;
    size_ += wanted ? size : 0;
  };
  // Mei's mirror parameter and its focal lengths are all but the same direction: the sheet's lens stays.
  const bool watched = config.watched();
  const bool lens = config.distortion_std > 0 && camera.model() != DistortionModel::kMei && !watched;
  intrinsics_size_ = 4 + (lens ? CoefficientCount(camera.model()) : 0);
  take(config.extrinsics || watched, 6, &extrinsics_);
  take(config.time_offset || watched, 1, &time_offset_);
  take(config.line_delay, 1, &line_delay_);
  take(config.intrinsics || watched, intrinsics_size_, &intrinsics_);
  take(antenna_.has_value(), 3, &lever_arm_);
}

VectorXd WatchedDeviations(const CalibrationLayout& layout) {
  // Their squares are 1e-6 of what a minute of motion leaves, and 1e-3 of what a day does.
  constexpr double kRotationRad = 1e-7;
  constexpr double kTranslationM = 1e-6;
  constexpr double kTimeS = 1e-7;
  constexpr double kPixels = 5e-5;
  constexpr double kLeverArmM = 1e-5;  // GNSS determines it to centimetres, RTK fixes to millimetres
  VectorXd deviations = VectorXd::Constant(layout.size(), kPixels);
  if (layout.extrinsics() >= 0) {
    deviations.segment<3>(layout.extrinsics()).setConstant(kRotationRad);
    deviations.segment<3>(layout.extrinsics() + 3).setConstant(kTranslationM);
  }
  if (layout.time_offset() >= 0) {
    deviations[layout.time_offset()] = kTimeS;
  }
  if (layout.lever_arm() >= 0) {
    deviations.segment<3>(layout.lever_arm()).setConstant(kLeverArmM);
  }
  return deviations;
}

CalibrationEstimate InitialCalibration(const CalibrationConfig& config, const CameraCalibration& given,
                                       std::optional<Sensor> antenna) {
  CalibrationEstimate estimate{CalibrationLayout(config, given.camera, antenna), given, {}};
  const CalibrationLayout& layout = estimate.layout;
  if (layout.line_delay() >= 0) {
    estimate.mean.line_delay_s = given.line_delay_s.value_or(0);
  }
  estimate.deviations.resize(layout.size());
  if (config.watched()) {
    estimate.deviations = WatchedDeviations(layout);
    estimate.watched = true;
    estimate.error.setZero(layout.size());
    estimate.state_covariance.setZero(15, layout.size());
    return estimate;
  }
  if (layout.extrinsics() >= 0) {
    estimate.deviations.segment<3>(layout.extrinsics()).setConstant(config.rotation_std_rad);
    estimate.deviations.segment<3>(layout.extrinsics() + 3).setConstant(config.translation_std_m);
  }
  if (layout.time_offset() >= 0) {
    estimate.deviations[layout.time_offset()] = config.time_offset_std_s;
  }
  if (layout.line_delay() >= 0) {
    estimate.deviations[layout.line_delay()] = config.line_delay_std_s;
  }
  if (layout.intrinsics() >= 0) {
    auto part = estimate.deviations.segment(layout.intrinsics(), layout.intrinsics_size());
    part.setConstant(config.distortion_std);
    part.head<2>().setConstant(config.focal_std_px);
    part.segment<2>(2).setConstant(config.center_std_px);
  }
  return estimate;
}

bool Retract(const CalibrationLayout& layout, const Eigen::Ref<const VectorXd>& error,
             CameraCalibration* calibration) {
  if (!error.allFinite()) {
    return false;
  }
  if (layout.intrinsics() >= 0) {
    const VectorXd moved = Intrinsics(calibration->camera, layout.intrinsics_size()) +
                           error.segment(layout.intrinsics(), layout.intrinsics_size());
    Result<CameraModel> camera = WithIntrinsics(calibration->camera, moved);
    if (!camera.ok()) {
      return false;
    }
    calibration->camera = *camera;
  }
  if (layout.extrinsics() >= 0) {
    Pose& T_BC = calibration->T_BC;
    T_BC.rotation =
        so3::Normalize(T_BC.rotation * so3::Exp(Eigen::Vector3d(error.segment<3>(layout.extrinsics()))));
    T_BC.translation += error.segment<3>(layout.extrinsics() + 3);
  }
  if (layout.time_offset() >= 0) {
    calibration->time_offset_s += error[layout.time_offset()];
  }
  if (layout.line_delay() >= 0) {
    calibration->line_delay_s = calibration->line_delay_s.value_or(0) + error[layout.line_delay()];
  }
  return true;
}

VectorXd Local(const CalibrationLayout& layout, const CameraCalibration& estimate,
               const CameraCalibration& truth) {
  VectorXd error = VectorXd::Zero(layout.size());  // a lever arm is watched alone, and stays as given
  if (layout.extrinsics() >= 0) {
    error.segment<3>(layout.extrinsics()) =
        so3::Log(estimate.T_BC.rotation.transpose() * truth.T_BC.rotation);
    error.segment<3>(layout.extrinsics() + 3) = truth.T_BC.translation - estimate.T_BC.translation;
  }
  if (layout.time_offset() >= 0) {
    error[layout.time_offset()] = truth.time_offset_s - estimate.time_offset_s;
  }
  if (layout.line_delay() >= 0) {
    error[layout.line_delay()] = truth.line_delay_s.value_or(0) - estimate.line_delay_s.value_or(0);
  }
  if (layout.intrinsics() >= 0) {
    const int size = layout.intrinsics_size();
    error.segment(layout.intrinsics(), size) =
        Intrinsics(truth.camera, size) - Intrinsics(estimate.camera, size);
  }
  return error;
}

Vector6d BodyRates(const Eigen::Vector3d& omega_B, const Eigen::Vector3d& v_WB) {
  return (Vector6d() << omega_B, v_WB).finished();
}

Pose BodyAfter(const Pose& T_WB, const Vector6d& rates, double later_s, Eigen::Matrix3d* turn) {
  const Eigen::Matrix3d R_BL = so3::Exp(Eigen::Vector3d(later_s * rates.head<3>()));
  if (turn != nullptr) {
    *turn = R_BL;
  }
  return {T_WB.rotation * R_BL, T_WB.translation + later_s * rates.tail<3>()};
}

bool IntrinsicsJacobian(const CameraModel& camera, const Vector2d& ideal,
                        Eigen::Matrix<double, 2, 8>* jacobian) {
  if (camera.is_spherical()) {
    return IntrinsicsJacobian(camera, Eigen::Vector3d(ideal.homogeneous()), jacobian);
  }
  Vector2d distorted;
  if (!camera.Distort(ideal, &distorted)) {
    return false;
  }
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = ideal.squaredNorm();
  Eigen::Matrix<double, 2, 4> lens = Eigen::Matrix<double, 2, 4>::Zero();
  switch (camera.model()) {
    case DistortionModel::kRadialTangential:
      lens << r2 * x, r2 * r2 * x, 2 * x * y, r2 + 2 * x * x, r2 * y, r2 * r2 * y, r2 + 2 * y * y, 2 * x * y;
      break;
    case DistortionModel::kEquidistant: {
      const double r = std::sqrt(r2);
      double by_angle = 0;
      Eigen::RowVector4d by_coefficients;
      EquidistantRadius(std::atan(r), camera.coefficients().head<4>(), &by_angle, &by_coefficients);
      lens = r > 1e-12 ? Eigen::Matrix<double, 2, 4>(ideal / r * by_coefficients) : lens;
      break;
    }
    case DistortionModel::kFov: {
      const double r = std::sqrt(r2);
      const double w = camera.coefficients()[0];
      const double tangent = std::tan(0.5 * w);
      const double a = 2 * tangent;
      const double rate = r * (1 + tangent * tangent) / (1 + a * a * r2) / w - std::atan(a * r) / (w * w);
      lens.col(0) = r > 1e-12 ? Vector2d(ideal * (rate / r)) : Vector2d::Zero();
      break;
    }
    case DistortionModel::kMei:  // the layout has no columns for its lens
    case DistortionModel::kDoubleSphere:
    case DistortionModel::kEucm:  // spherical
    case DistortionModel::kNone:
      break;
  }
  *jacobian = WithLens(camera, distorted, lens);
  return true;
}

bool IntrinsicsJacobian(const CameraModel& camera, const Eigen::Vector3d& ray,
                        Eigen::Matrix<double, 2, 8>* jacobian) {
  if (!camera.is_spherical()) {
    return ray.z() > 0 && IntrinsicsJacobian(camera, Vector2d(ray.hnormalized()), jacobian);
  }
  Vector2d distorted;
  Eigen::Matrix<double, 2, 4> lens;
  if (!camera.DistortRay(ray, &distorted, nullptr, &lens)) {
    return false;
  }
  *jacobian = WithLens(camera, distorted, lens);
  return true;
}

Matrix6d ExtrinsicsToCameraJacobian(const Eigen::Matrix3d& R_WB) {
  Matrix6d jacobian = Matrix6d::Identity();
  jacobian.bottomRightCorner<3, 3>() = R_WB;
  return jacobian;
}

void CalibrationRows(const CalibrationLayout& layout, const CameraModel& camera, const Eigen::Matrix3d& R_WB,
                     const CameraFromTimes& camera_from, const Eigen::Matrix<double, 2, 6>& camera_rows,
                     const NormalizedObservation& observation, Eigen::Ref<Eigen::MatrixXd> rows) {
  rows.setZero();
  if (layout.extrinsics() >= 0) {
    rows.middleCols<6>(layout.extrinsics()) = camera_rows * ExtrinsicsToCameraJacobian(R_WB);
  }
  if (layout.time_offset() >= 0 && camera_from.offset != nullptr) {
    rows.col(layout.time_offset()) = camera_rows * *camera_from.offset;
  }
  if (layout.line_delay() >= 0 && camera_from.line_delay != nullptr) {
    rows.col(layout.line_delay()) = camera_rows * *camera_from.line_delay;
  }
  if (layout.intrinsics() < 0) {
    return;
  }
  Eigen::Matrix2d pixel_from_z;
  Eigen::Matrix<double, 2, 8> of_intrinsics;
  if (PixelJacobian(camera, observation, &pixel_from_z) &&
      (observation.plane.is_tangent() ? IntrinsicsJacobian(camera, observation.Ray(), &of_intrinsics)
                                      : IntrinsicsJacobian(camera, observation.z, &of_intrinsics))) {
    rows.middleCols(layout.intrinsics(), layout.intrinsics_size()) =
        observation.sqrt_information * pixel_from_z.inverse() *
        of_intrinsics.leftCols(layout.intrinsics_size());
  }
}

}  // namespace alidade
