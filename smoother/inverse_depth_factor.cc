#include "smoother/inverse_depth_factor.h"

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

}  // namespace

InverseDepthFactor::InverseDepthFactor(const WindowFrame* base, const WindowView* view, const Pose* T_BC)
    : base_(base), view_(view), T_BC_(T_BC) {}

InverseDepthFactor::InverseDepthFactor(const WindowFrame* base, const WindowView* view,
                                       const WindowCalibration* calibration)
    : base_(base), view_(view), calibration_(calibration) {}

bool InverseDepthFactor::Evaluate(const double* const* parameters, double* residual,
                                  double* const* tangent_jacobians) const {
  const NavState base_state = UnpackNavState(parameters[0]);
  const NavState view_state = UnpackNavState(parameters[1]);
  WindowCalibration camera;
  NormalizedObservation observation = view_->observation;
  if (calibration_ != nullptr) {
    camera.layout = calibration_->layout;
    if (!calibration_->At(parameters[3], &camera.mean)) {
      return false;
    }
    observation = Seen(camera, *view_);
  }
  const auto geometry = [&](const WindowFrame& frame, const NavState& state) {
    return calibration_ == nullptr ? MakeGeometry(frame, state, *T_BC_)
                                   : MakeGeometry(frame, state, camera.mean);
  };
  const FrameGeometry base = geometry(*base_, base_state);
  const FrameGeometry view = geometry(*view_->frame, view_state);
  const Eigen::Map<const Eigen::Vector3d> landmark(parameters[2]);
  const InverseDepthModel model{landmark.head<2>(), observation.z};
  const bool differentiate = tangent_jacobians != nullptr;
  Vector2d r;
  InverseDepthModel::PoseJacobian jacobian_base;
  InverseDepthModel::PoseJacobian jacobian_view;
  Vector2d jacobian_rho;
  Eigen::Matrix2d jacobian_bearing;
  bool in_front =
      model.Evaluate(base.T_WC, view.T_WC, landmark.z(), &r, differentiate ? &jacobian_base : nullptr,
                     differentiate ? &jacobian_view : nullptr, differentiate ? &jacobian_rho : nullptr,
                     differentiate ? &jacobian_bearing : nullptr);
  if (differentiate && in_front && (base.T_WC_first || view.T_WC_first)) {
    Vector2d ignored;
    in_front = model.Evaluate(base.Linearized(), view.Linearized(), landmark.z(), &ignored, &jacobian_base,
                              &jacobian_view, &jacobian_rho, &jacobian_bearing);
  }
  if (!in_front) {
    r.setZero();
    jacobian_base.setZero();
    jacobian_view.setZero();
    jacobian_rho.setZero();
    jacobian_bearing.setZero();
  }
  const Eigen::Matrix2d& whitening = observation.sqrt_information;
  Eigen::Map<Vector2d>{residual} = in_front ? Vector2d(whitening * r) : Vector2d::Constant(kBehindSigma);
  if (!differentiate) {
    return true;
  }
  StoreNav(whitening, jacobian_base, base, tangent_jacobians[0]);
  StoreNav(whitening, jacobian_view, view, tangent_jacobians[1]);
  if (tangent_jacobians[2] != nullptr) {
    Eigen::Map<RowMatrix2x3> out(tangent_jacobians[2]);
    out.leftCols<2>() = whitening * jacobian_bearing;
    out.col(2) = whitening * jacobian_rho;
  }
  if (calibration_ != nullptr && tangent_jacobians[3] != nullptr) {
    if (in_front) {
      const Eigen::Matrix2Xd cameras = whitening * (jacobian_base * CalibrationChain(camera.layout, base) +
                                                    jacobian_view * CalibrationChain(camera.layout, view));
      StoreCalibration(camera, *calibration_, Predicted(observation, whitening * r), cameras, parameters[3],
                       tangent_jacobians[3]);
    } else {
      Eigen::Map<CalibrationRow>{tangent_jacobians[3]}.setZero();
    }
  }
  return true;
}

BaseBearingFactor::BaseBearingFactor(const WindowView* view, const WindowCalibration* calibration)
    : observation_(view->observation), view_(view), calibration_(calibration) {}

bool BaseBearingFactor::Evaluate(const double* const* parameters, double* residual,
                                 double* const* tangent_jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> landmark(parameters[0]);
  WindowCalibration camera;
  NormalizedObservation observation = observation_;
  if (calibration_ != nullptr) {
    camera.layout = calibration_->layout;
    if (!calibration_->At(parameters[1], &camera.mean)) {
      return false;
    }
    observation = Seen(camera, *view_);
  }
  Eigen::Map<Vector2d> r(residual);
  r = observation.sqrt_information * (landmark.head<2>() - observation.z);
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<RowMatrix2x3> out(tangent_jacobians[0]);
    out.leftCols<2>() = observation.sqrt_information;
    out.col(2).setZero();
  }
  if (calibration_ != nullptr && tangent_jacobians != nullptr && tangent_jacobians[1] != nullptr) {
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
