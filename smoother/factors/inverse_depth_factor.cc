#include "smoother/factors/inverse_depth_factor.h"

#include "core/predicted_observation.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using RowMatrix2x9 = Eigen::Matrix<double, 2, 9, Eigen::RowMajor>;
using RowMatrix2x3 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
using CalibrationRow = Eigen::Matrix<double, 2, CalibrationLayout::kMaxSize, Eigen::RowMajor>;

// Whitened residual of a landmark behind the camera: far beyond any gate, yet not so large that it hides the
// rest of the cost, to which the solver's tolerance is relative.
constexpr double kBehindSigma = 100;

void StoreNav(const Eigen::Matrix2d& whitening, const InverseDepthModel::PoseJacobian& camera,
              const FrameGeometry& frame, double* tangent) {
  if (tangent != nullptr) {
    Eigen::Map<RowMatrix2x9> out(tangent);
    out.leftCols<6>() = whitening * camera * frame.camera_from_body;
    out.rightCols<3>().setZero();
  }
}

/// Rows over a calibration block: those of the intrinsics, at the ray as predicted, and `cameras`, over what
/// the calibration does to the cameras' places.
void StoreCalibration(const WindowCalibration& at, const WindowCalibration& calibration,
                      const NormalizedObservation& predicted, const Eigen::Matrix2Xd& cameras,
                      const double* block, double* tangent) {
  Eigen::MatrixXd rows(2, at.size());
  CalibrationRows(at.layout, at.mean.camera, Eigen::Matrix3d::Identity(), nullptr,
                  Eigen::Matrix<double, 2, 6>::Zero(), predicted, rows);
  Eigen::Map<CalibrationRow> out(tangent);
  out.setZero();
  out.leftCols(at.size()).noalias() = (rows + cameras) * calibration.BlockJacobian(block);
}

NormalizedObservation Seen(const WindowCalibration& at, const WindowView& view) {
  return at.layout.intrinsics() < 0 ? view.observation : Renormalized(at.mean.camera, view).observation;
}

/// Whitened residual and, over the two cameras and the landmark, Jacobians without their whitening.
struct DepthRows {
  Vector2d residual;
  InverseDepthModel::PoseJacobian base, view;
  Vector2d rho;
  Eigen::Matrix2d bearing;

  /// False behind the view; Jacobians are then zero.
  bool Linearize(const FrameGeometry& base_frame, const FrameGeometry& view_frame,
                 const Eigen::Vector3d& landmark, const NormalizedObservation& observation,
                 bool differentiate) {
    const InverseDepthModel model{landmark.head<2>(), observation.z};
    Vector2d r;
    bool in_front = model.Evaluate(base_frame.T_WC, view_frame.T_WC, landmark.z(), &r,
                                   differentiate ? &base : nullptr, differentiate ? &view : nullptr,
                                   differentiate ? &rho : nullptr, differentiate ? &bearing : nullptr);
    if (differentiate && in_front && (base_frame.T_WC_first || view_frame.T_WC_first)) {
      Vector2d ignored;
      in_front = model.Evaluate(base_frame.Linearized(), view_frame.Linearized(), landmark.z(), &ignored,
                                &base, &view, &rho, &bearing);
    }
    if (!in_front) {
      *this = DepthRows{Vector2d::Zero(), InverseDepthModel::PoseJacobian::Zero(),
                        InverseDepthModel::PoseJacobian::Zero(), Vector2d::Zero(), Eigen::Matrix2d::Zero()};
      return false;
    }
    residual = observation.sqrt_information * r;
    return true;
  }
};

}  // namespace

InverseDepthFactor::InverseDepthFactor(const WindowFrame* base, const WindowView* view,
                                       const WindowCalibration* calibration)
    : base_(base), view_(view), calibration_(calibration) {}

bool InverseDepthFactor::Evaluate(const double* const* parameters, double* residual,
                                  double* const* tangent_jacobians) const {
  WindowCalibration camera{calibration_->layout, {}};
  if (!calibration_->At(calibration_->Block(parameters, 3), &camera.mean)) {
    return false;
  }
  const NormalizedObservation observation = Seen(camera, *view_);
  const FrameGeometry base = MakeGeometry(*base_, UnpackNavState(parameters[0]), camera.mean);
  const FrameGeometry view = MakeGeometry(*view_->frame, UnpackNavState(parameters[1]), camera.mean);
  const Eigen::Map<const Eigen::Vector3d> landmark(parameters[2]);
  DepthRows rows;
  const bool in_front = rows.Linearize(base, view, landmark, observation, tangent_jacobians != nullptr);
  Eigen::Map<Vector2d>{residual} = in_front ? rows.residual : Vector2d::Constant(kBehindSigma);
  if (tangent_jacobians == nullptr) {
    return true;
  }
  const Eigen::Matrix2d& whitening = observation.sqrt_information;
  StoreNav(whitening, rows.base, base, tangent_jacobians[0]);
  StoreNav(whitening, rows.view, view, tangent_jacobians[1]);
  if (tangent_jacobians[2] != nullptr) {
    Eigen::Map<RowMatrix2x3> out(tangent_jacobians[2]);
    out.leftCols<2>() = whitening * rows.bearing;
    out.col(2) = whitening * rows.rho;
  }
  if (calibration_->size() == 0 || tangent_jacobians[3] == nullptr) {
    return true;
  }
  if (!in_front) {
    Eigen::Map<CalibrationRow>{tangent_jacobians[3]}.setZero();
    return true;
  }
  const Eigen::Matrix2Xd cameras = whitening * (rows.base * CalibrationChain(camera.layout, base) +
                                                rows.view * CalibrationChain(camera.layout, view));
  StoreCalibration(camera, *calibration_, Predicted(observation, rows.residual), cameras, parameters[3],
                   tangent_jacobians[3]);
  return true;
}

BaseBearingFactor::BaseBearingFactor(const WindowView* view, const WindowCalibration* calibration)
    : view_(view), calibration_(calibration) {}

bool BaseBearingFactor::Evaluate(const double* const* parameters, double* residual,
                                 double* const* tangent_jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> landmark(parameters[0]);
  const bool calibrates = blocks().size() > 1;
  WindowCalibration camera = *calibration_;
  if (calibrates && !calibration_->At(parameters[1], &camera.mean)) {
    return false;
  }
  const NormalizedObservation observation = Seen(camera, *view_);
  Eigen::Map<Vector2d> r(residual);
  r = observation.sqrt_information * (landmark.head<2>() - observation.z);
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<RowMatrix2x3> out(tangent_jacobians[0]);
    out.leftCols<2>() = observation.sqrt_information;
    out.col(2).setZero();
  }
  if (calibrates && tangent_jacobians != nullptr && tangent_jacobians[1] != nullptr) {
    StoreCalibration(camera, *calibration_, Predicted(observation, r),
                     Eigen::Matrix2Xd::Zero(2, camera.size()), parameters[1], tangent_jacobians[1]);
  }
  return true;
}

bool DepthPriorFactor::Evaluate(const double* const* parameters, double* residual,
                                double* const* tangent_jacobians) const {
  residual[0] = prior_.sqrt_information * (parameters[0][2] - prior_.mean);
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<Eigen::RowVector3d>{tangent_jacobians[0]} << 0, 0, prior_.sqrt_information;
  }
  return true;
}

}  // namespace alidade
